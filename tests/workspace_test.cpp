// workspace_bytes() of every detector against the memory that it really holds, counted as it is allocated: device memory in the
// kernels' double, the heap for CPU detectors. A file of its own, because it counts every `new` of the program.
#include <gtest/gtest.h>
#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "datasets/loose.h"
#include "kernels/device.h"

namespace {
std::atomic<std::int64_t> heap_bytes = 0;
}

void* operator new(std::size_t size) {
  void* p = std::malloc(size ? size : 1);
  if (!p) throw std::bad_alloc();
  heap_bytes += static_cast<std::int64_t>(malloc_usable_size(p));
  return p;
}
void operator delete(void* p) noexcept {
  heap_bytes -= static_cast<std::int64_t>(malloc_usable_size(p));
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept { operator delete(p); }

namespace touchstone {
namespace {

// Large enough that a detector's arrays dwarf its other members.
const std::vector<Ball>& balls() {
  static const std::vector<Ball> made = make_loose(parse_spec("n=20000,c=3,kind=loose,phi=0.4,base=cube")).balls;
  return made;
}

TEST(Workspace, OfGpuDetectorsIsWhatTheyAllocate) {
  const PackingFacts facts = facts_of(balls());
  for (const DetectorInfo& info : gpu_detectors()) {
    Stream stream(info.place);
    const std::int64_t before = device_detail::allocated_bytes;
    const auto detector = info.make(facts, {}, stream);
    EXPECT_EQ(detector->workspace_bytes(), device_detail::allocated_bytes - before) << info.label();
    EXPECT_GT(detector->workspace_bytes(), 0) << info.label();
    if (info.bytes) {
      EXPECT_EQ(info.bytes(facts.n, facts, {}), detector->workspace_bytes()) << info.label() << ", said beforehand";
    }
  }
}

TEST(Workspace, OfCpuDetectorsIsWhatTheyHold) {
  const PackingFacts facts = facts_of(balls());
  for (const DetectorInfo& info : cpu_detectors()) {
    Stream stream(info.place);
    const std::int64_t before = heap_bytes;
    const auto detector = info.make(facts, {}, stream);
    const auto held = static_cast<double>(heap_bytes - before), told = static_cast<double>(detector->workspace_bytes());
    EXPECT_NEAR(told, held, 0.02 * held + 1024) << info.label();  // members that are no arrays, and what malloc rounds up
    EXPECT_EQ(info.bytes(facts.n, facts, {}), detector->workspace_bytes()) << info.label() << ", said beforehand";
  }
}

// Far beyond what this machine, or 32 bits, could hold: never less for more balls, never negative.
TEST(Workspace, IsSaidBeforehandToFourThousandMillionBalls) {
  const PackingFacts like = facts_of(balls());
  for (const auto rows : {cpu_detectors(), gpu_detectors()})
    for (const DetectorInfo& info : rows) {
      if (!info.bytes || info.name == "all_pairs") continue;
      const auto a_ball = static_cast<double>(info.bytes(like.n, like, {})) / like.n;
      std::int64_t before = 1;
      for (const std::int64_t n : {20'000ll, 1'000'000ll, 1'000'000'000ll, 2'147'483'647ll, 2'147'483'648ll, 4'000'000'000ll}) {
        const std::int64_t bytes = info.bytes(n, like, {});
        EXPECT_GE(bytes, before) << info.label() << " " << n;
        // In proportion, or less where a method spares memory in large packings.
        EXPECT_LT(static_cast<double>(bytes) / static_cast<double>(n), 1.01 * a_ball) << info.label() << " " << n;
        EXPECT_GT(static_cast<double>(bytes) / static_cast<double>(n), 0.5 * a_ball) << info.label() << " " << n;
        before = bytes;
      }
    }
}

}  // namespace
}  // namespace touchstone

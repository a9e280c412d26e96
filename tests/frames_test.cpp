// Frames of a settling: on the way to the very bed, the same bytes everywhere, and never trusted when damaged.
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "datasets/files.h"
#include "datasets/frames.h"
#include "datasets/settle.h"
#include "datasets/store.h"
#include "tests/run_program.h"
#include "touchstone/error.h"
#include "touchstone/hex.h"

namespace touchstone {
namespace {

// 200 balls on 4 x 4 cm: a fraction of a second of work.
const PackingSpec kBed = parse_spec("n=200,c=2,base=4x4");

PackingSpec frame_of(PackingSpec spec, std::int32_t frame) {
  spec.frame = frame;
  return spec;
}

// Mean distance of a ball from where it is in the other packing, over rmin.
double moved(const Packing& a, const Packing& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.balls.size(); ++i)
    sum += std::hypot(a.balls[i].x - b.balls[i].x, a.balls[i].y - b.balls[i].y, a.balls[i].z - b.balls[i].z);
  return sum / static_cast<double>(a.balls.size()) / kBed.rmin;
}

// Made once, by one thread; each test has a folder of its own with a copy.
class Frames : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    threads_ = omp_get_max_threads();
    omp_set_num_threads(1);  // no balls enough for two
    made_ = std::make_unique<testing::TemporaryFolder>();
    first_ = packing_hash(load_or_make(frame_of(kBed, 40), made_->path()).balls);
  }
  static void TearDownTestSuite() {
    omp_set_num_threads(threads_);
    made_.reset();
  }
  void SetUp() override { std::filesystem::copy(made_->path(), folder_.path(), std::filesystem::copy_options::recursive); }

  Packing at(std::int32_t frame) const { return load_or_make(frame_of(kBed, frame), folder_.path()); }
  std::filesystem::path file() const { return folder_.path() / cache_file_of(frame_of(kBed, 0)); }
  std::uint64_t hash(std::int32_t frame) const { return packing_hash(at(frame).balls); }

  // What is said on stderr when frame 40 is asked for again; it must be the same whatever happened between.
  std::string ask_again() const {
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(hash(40), first_);
    return ::testing::internal::GetCapturedStderr();
  }

  // The same, but stopped as soon as anything is made.
  std::string ask_and_stop() const {
    ::testing::internal::CaptureStderr();
    EXPECT_THROW(load_or_make(frame_of(kBed, 40), folder_.path(), [](double, std::string_view) { throw Interrupted(); }),
                 Interrupted);
    return ::testing::internal::GetCapturedStderr();
  }

  static int threads_;
  static std::unique_ptr<testing::TemporaryFolder> made_;
  static std::uint64_t first_;
  const testing::TemporaryFolder folder_;
};
int Frames::threads_;
std::unique_ptr<testing::TemporaryFolder> Frames::made_;
std::uint64_t Frames::first_;

TEST_F(Frames, LeadFromTheStartToTheBed) {
  const Packing bed = load_or_make(kBed, folder_.path());
  EXPECT_EQ(hash(kLastFrame), packing_hash(bed.balls)) << "the last frame is the bed as packed";
  EXPECT_EQ(at(40).name, "c2_n200_b4x4_f040");
  for (const std::int32_t frame : {0, 1, 40, 99})
    for (std::size_t i = 0; i < bed.balls.size(); ++i) ASSERT_EQ(at(frame).balls[i].r, bed.balls[i].r) << frame;
  EXPECT_GT(moved(at(0), bed), 0.5);
  EXPECT_GT(moved(at(0), bed), 2 * moved(at(40), bed)) << "it comes to rest";
}

// The frames are looked for in a settling watched by this test.
TEST_F(Frames, AreEquallySpacedInSteps) {
  std::map<std::int64_t, std::vector<Ball>> seen;
  SettledState state;
  const Packing bed = settle(kBed, state, {}, {}, [&](std::int64_t step, const auto& bodies, const auto& id) {
    std::vector<Ball>& balls = seen[step];
    balls.resize(bodies.size());
    for (std::size_t k = 0; k < bodies.size(); ++k)
      balls[id[k]] = {static_cast<float>(bodies[k].x), static_cast<float>(bodies[k].y), static_cast<float>(bodies[k].z),
                      static_cast<float>(bodies[k].r)};
  });
  EXPECT_EQ(packing_hash(bed.balls), packing_hash(load_or_make(kBed, folder_.path()).balls)) << "watching must change nothing";
  ASSERT_EQ(seen.size(), static_cast<std::size_t>(state.steps) + 1) << "step 0 and every step after it, each once";
  for (const std::int32_t frame : {0, 1, 40, 99}) {
    const auto step = static_cast<std::int64_t>(std::floor(static_cast<double>(frame * state.steps) / kLastFrame + 0.5));
    EXPECT_EQ(packing_hash(seen.at(step)), hash(frame)) << "frame " << frame << " is not step " << step;
  }
}

TEST_F(Frames, HaveTheSameBytesOnAnyMachineAndWithAnyNumberOfThreads) {
  const testing::TemporaryFolder other;
  omp_set_num_threads(3);
  EXPECT_EQ(packing_hash(load_or_make(frame_of(kBed, 40), other.path()).balls), first_);
  omp_set_num_threads(1);
  EXPECT_TRUE(read_whole(other.path() / file().filename()) == read_whole(file()));
  EXPECT_EQ(hex64(hash(0)), "d484c6eaef137a43");
  EXPECT_EQ(hex64(hash(40)), "32a6f8041a911913");
}

TEST_F(Frames, AreKept) {
  const auto written = std::filesystem::last_write_time(file());
  std::filesystem::remove(file().string() + ".lock");
  EXPECT_EQ(ask_again(), "");
  EXPECT_EQ(std::filesystem::last_write_time(file()), written);
  EXPECT_FALSE(std::filesystem::exists(file().string() + ".lock")) << "a complete cache may be read-only";
  EXPECT_EQ(list_cached(folder_.path()).size(), 1u) << "frames are no packing of the folder's list";
}

TEST_F(Frames, ADamagedFileIsSaidInOneLineAndMadeAnew) {
  const std::string good = read_whole(file());
  const std::size_t start = good.find('\n') + 1, frame_bytes = 12 * static_cast<std::size_t>(kBed.n);
  const auto with_byte = [&](std::size_t at) {
    std::string bytes = good;
    bytes[at] ^= 1;
    return bytes;
  };
  const auto with_text = [&](const std::string& from, const std::string& to) {
    std::string bytes = good;
    return bytes.replace(bytes.find(from), from.size(), to);
  };
  const std::pair<std::string, const char*> kDamages[] = {
      {with_byte(start + 40 * frame_bytes + 1234), "a frame's hash differs"},
      {good.substr(0, good.size() - 12), "wrong size"},
      {good + "x", "wrong size"},
      {good.substr(0, 20), "first line is damaged"},
      {"", "first line is damaged"},
      {with_text("\"frames\"", "\"f\xff\""), "first line is damaged"},
      {with_text("\"frame_hashes\"", "\"frame_hashes_\""), "first line is damaged"},
      {with_text("\"generator_version\":1", "\"generator_version\":0"), "another version"},
      {with_text("touchstone-frames/1", "touchstone-frames/0"), "another version"},
      {with_text("n=200", "n=201"), "of another bed"},
      {with_text("\"packing_hash\":\"", "\"packing_hash\":\"x"), "of another bed"},
  };
  for (const auto& [bytes, says] : kDamages) {
    write_atomically(file(), bytes);
    const std::string said = ask_and_stop();
    EXPECT_NE(said.find(says), std::string::npos) << said;
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
    EXPECT_TRUE(read_whole(file()) == bytes) << "stopped, so nothing was written: " << says;
  }
  EXPECT_NE(ask_again(), "");
  EXPECT_TRUE(read_whole(file()) == good) << "made anew";
  write_atomically(file(), with_byte(start + 39 * frame_bytes));
  EXPECT_EQ(ask_again(), "") << "another frame is not this one's fault";
}

TEST_F(Frames, CanBeInterruptedAndLeaveNothingHalfWritten) {
  std::filesystem::remove(file());
  EXPECT_EQ(ask_and_stop(), "");
  EXPECT_FALSE(std::filesystem::exists(file()));
}

TEST_F(Frames, AreRefusedWhereTheBedIsNotTheSettlingsOwn) {
  // A cached bed whose files agree with each other, but that no settling ends with.
  Packing bed = load_or_make(kBed, folder_.path());
  bed.balls[7].z += 1e-6f;
  const auto path = folder_.path() / cache_file_of(kBed);
  write_atomically(path, {reinterpret_cast<const char*>(bed.balls.data()), bed.balls.size() * sizeof(Ball)});
  auto meta = nlohmann::json::parse(read_whole(folder_.path() / (bed.name + ".json")));
  meta["packing_hash"] = hex64(packing_hash(bed.balls));
  write_atomically(folder_.path() / (bed.name + ".json"), meta.dump());
  ::testing::internal::CaptureStderr();
  EXPECT_THROW(at(40), std::runtime_error);
  ::testing::internal::GetCapturedStderr();
}

// What everybody's frames must be, and the bed that making them must not change.
TEST(ExpectedFrames, AreTheFramesOfTheExpectedBed) {
  const testing::TemporaryFolder folder;
  const auto expected = nlohmann::json::parse(read_whole(TOUCHSTONE_SOURCE_DIR "/results/expected.json")).at("packings");
  const PackingSpec bed = parse_spec("n=2969,c=4");
  int compared = 0;
  for (std::int32_t frame = -1; frame <= kLastFrame; ++frame) {
    const PackingSpec spec = frame_of(bed, frame);
    const auto e = expected.find(name_of(spec));
    if (e == expected.end()) continue;
    EXPECT_EQ(hex64(packing_hash(load_or_make(spec, folder.path()).balls)), e->at("packing_hash")) << name_of(spec);
    ++compared;
  }
  EXPECT_EQ(compared, 12) << "the bed and every tenth frame";
  EXPECT_EQ(expected.at("c4_n2969_f100").at("packing_hash"), expected.at("c4_n2969").at("packing_hash"));
}

}  // namespace
}  // namespace touchstone

#include "bench/memory_plan.h"

#include <fmt/format.h>

#include <fstream>
#include <string>

#include "reference_cpu/count_and_hash.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

double gb(std::int64_t bytes) { return 1e-9 * static_cast<double>(bytes); }

void require(const std::string& what, const std::string& need, std::int64_t bytes, const char* where, std::int64_t free) {
  if (free < 0 || bytes <= free) return;
  throw MemoryError(fmt::format("{} needs {}, that is {} bytes; {} bytes are free {}", what, need, bytes, free, where));
}

}  // namespace

std::string MemoryNeed::text() const {
  return fmt::format("{}{:.3f} GB (input {:.3f}, workspace {}, list {:.3f})", whole() ? "" : "at least ", gb(total()), gb(input),
                     whole() ? fmt::format("{:.3f}", gb(workspace)) : "not known beforehand", gb(output));
}

MemoryNeed memory_need(const DetectorInfo& info, std::int64_t n, const PackingFacts& like, const DetectorParams& params,
                       OutputForm form, std::int64_t capacity) {
  MemoryNeed need;
  need.input = n * static_cast<std::int64_t>(sizeof(Ball));
  if (info.bytes) need.workspace = info.bytes(n, like, params);
  if (form == OutputForm::pairs) {
    const std::int64_t pairs = capacity > 0 ? capacity : like.n == n ? default_capacity(form, like) : kDefaultPairsABall * n;
    need.output = pairs * static_cast<std::int64_t>(sizeof(Pair)) + static_cast<std::int64_t>(sizeof(std::int64_t));
  } else {
    const std::int64_t row = capacity > 0 ? capacity : default_capacity(form, like);
    need.output = (row + 1) * n * static_cast<std::int64_t>(sizeof(std::int32_t));
  }
  return need;
}

std::int64_t free_memory(Place place) {
  if (place == Place::device) {
#if !defined(TOUCHSTONE_NO_CUDA)
    // What earlier cases gave back may still lie in the pool of cudaMallocAsync.
    int device = 0;
    cudaMemPool_t pool = nullptr;
    check(cudaDeviceSynchronize());
    check(cudaGetDevice(&device));
    check(cudaDeviceGetDefaultMemPool(&pool, device));
    check(cudaMemPoolTrimTo(pool, 0));
#endif
    return static_cast<std::int64_t>(free_bytes());
  }
  std::ifstream meminfo("/proc/meminfo");
  for (std::string word; meminfo >> word;)
    if (std::int64_t kib = 0; word == "MemAvailable:" && meminfo >> kib) return 1024 * kib;
  return -1;
}

void require_fit(const std::string& what, const MemoryNeed& need, Place place, std::int64_t free) {
  require(what, need.text(), need.total(), place == Place::device ? "on the device" : "on the host", free);
}

void require_host_memory(const std::string& what, std::int64_t bytes) {
  require(what, fmt::format("{:.3f} GB", gb(bytes)), bytes, "on the host", free_memory(Place::host));
}

void require_memory_to_count(const std::string& what, const PackingFacts& facts) {
  require_host_memory(what, std::int64_t{facts.n} * static_cast<std::int64_t>(sizeof(Ball)) + count_and_hash_bytes(facts));
}

}  // namespace touchstone

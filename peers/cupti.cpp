#include <cuda_runtime.h>
#include <cupti.h>
#include <fmt/format.h>

#include <cstdlib>
#include <stdexcept>
#include <type_traits>

#include "kernels/device.h"
#include "peers/device_work.h"

namespace touchstone {
namespace {

#if CUPTI_API_VERSION >= 130000
using KernelRecord = CUpti_ActivityKernel10;
using CopyRecord = CUpti_ActivityMemcpy6;
#else
using KernelRecord = CUpti_ActivityKernel9;
using CopyRecord = CUpti_ActivityMemcpy5;
#endif
using FillRecord = CUpti_ActivityMemset4;

void require(CUptiResult result, const char* what) {
  if (result == CUPTI_SUCCESS) return;
  const char* text = nullptr;
  cuptiGetResultString(result, &text);
  throw std::runtime_error(fmt::format("CUPTI: {}: {}", what, text ? text : "unknown error"));
}

// CUPTI's calls back have no argument of ours. They come while it is flushed, perhaps on a thread of its own.
std::vector<DeviceActivity> activities;
bool lost = false;

constexpr std::size_t kBytes = std::size_t{1} << 20, kAligned = 8;

void CUPTIAPI give_buffer(std::uint8_t** buffer, std::size_t* bytes, std::size_t* most_records) {
  *buffer = static_cast<std::uint8_t*>(std::aligned_alloc(kAligned, kBytes));
  *bytes = *buffer ? kBytes : 0;
  *most_records = 0;  // as many as fit
}

template <class Record>
void keep(const CUpti_Activity* activity) {
  const auto* record = reinterpret_cast<const Record*>(activity);
  lost |= record->start == 0 || record->end < record->start;  // no times could be taken
  activities.push_back({std::is_same_v<Record, KernelRecord>, record->start, record->end});
}

void CUPTIAPI take_buffer(CUcontext context, std::uint32_t stream, std::uint8_t* buffer, std::size_t, std::size_t filled) {
  CUpti_Activity* activity = nullptr;
  CUptiResult next = CUPTI_SUCCESS;
  while ((next = cuptiActivityGetNextRecord(buffer, filled, &activity)) == CUPTI_SUCCESS) {
    if (activity->kind == CUPTI_ACTIVITY_KIND_CONCURRENT_KERNEL) keep<KernelRecord>(activity);
    if (activity->kind == CUPTI_ACTIVITY_KIND_MEMCPY) keep<CopyRecord>(activity);
    if (activity->kind == CUPTI_ACTIVITY_KIND_MEMSET) keep<FillRecord>(activity);
  }
  std::size_t dropped = 0;
  lost |= next != CUPTI_ERROR_MAX_LIMIT_REACHED;  // the end of the buffer
  lost |= cuptiActivityGetNumDroppedRecords(context, stream, &dropped) != CUPTI_SUCCESS || dropped != 0;
  std::free(buffer);
}

constexpr CUpti_ActivityKind kKinds[] = {CUPTI_ACTIVITY_KIND_CONCURRENT_KERNEL, CUPTI_ACTIVITY_KIND_MEMCPY,
                                         CUPTI_ACTIVITY_KIND_MEMSET};

DeviceWork watch(const std::function<void()>& work) {
  static const bool ready = [] {
    require(cuptiActivityRegisterCallbacks(give_buffer, take_buffer), "register");
    for (const CUpti_ActivityKind kind : kKinds) require(cuptiActivityEnable(kind), "enable");
    return true;
  }();
  (void)ready;
  const auto flush = [] {
    check(cudaDeviceSynchronize());
    require(cuptiActivityFlushAll(CUPTI_ACTIVITY_FLAG_FLUSH_FORCED), "flush");
  };
  flush();  // what came before is not this work's
  activities.clear(), lost = false;
  work();
  flush();
  if (lost) throw std::runtime_error("CUPTI: records were lost: the sum would be too small");
  if (activities.empty()) throw std::runtime_error("CUPTI reported no activity");
  return summed(activities);
}

}  // namespace

WatchDevice cupti() { return watch; }

}  // namespace touchstone

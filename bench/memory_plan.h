// How many bytes a case takes, said before anything is allocated.
#pragma once

#include <cstdint>
#include <string>

#include "kernels/detection.h"

namespace touchstone {

struct MemoryNeed {
  std::int64_t input = 0;       // balls
  std::int64_t workspace = -1;  // -1: the detector cannot say beforehand (DetectorInfo::bytes)
  std::int64_t output = 0;      // the contact list, at its first guess or, where known, its size

  bool whole() const { return workspace >= 0; }
  std::int64_t total() const { return input + (whole() ? workspace : 0) + output; }  // a lower bound unless whole()
  std::string text() const;  // "1.234 GB (input 0.160, workspace 0.434, list 0.640)"
};

// For n balls packed as those of `like`, n = like.n or any other size: all counts are 64-bit. `capacity` as in ContactStorage;
// 0: default_capacity. Throws InputError for parameters the detector refuses.
MemoryNeed memory_need(const DetectorInfo& info, std::int64_t n, const PackingFacts& like, const DetectorParams& params,
                       OutputForm form, std::int64_t capacity = 0);

// Bytes that can still be allocated; -1 where the system does not say.
std::int64_t free_memory(Place place);

// Throws MemoryError with both numbers if `free` is known and less than the need.
void require_fit(const std::string& what, const MemoryNeed& need, Place place, std::int64_t free);

// The same for anything else on the host.
void require_host_memory(const std::string& what, std::int64_t bytes);

// For balls that exist only while count_and_hash() counts their contacts.
void require_memory_to_count(const std::string& what, const PackingFacts& facts);

}  // namespace touchstone

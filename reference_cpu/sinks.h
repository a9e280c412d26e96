// Where the CPU detectors put contacts: one sink for each form of output. A sink takes add(i, j) once for each contact, in
// either order of i and j, counts truly past capacity, and writes up to it.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>

#include "touchstone/contact.h"
#include "touchstone/contact_list.h"
#include "touchstone/detector.h"

namespace touchstone {

// Collects pairs in the first-level cache and hands them on by the thousand: so threads share one counter cheaply, and
// the capacity is looked at once a chunk. Each thread has its own sink; flush() when done.
class PairSink {
 public:
  explicit PairSink(const ContactsView& out) : out_(out) {}

  void add(std::int32_t i, std::int32_t j) {
    if (held_ == kChunk) flush();
    chunk_[held_++] = {std::min(i, j), std::max(i, j)};
  }

  void flush() {
    const std::int64_t at = std::atomic_ref(*out_.count).fetch_add(held_, std::memory_order_relaxed);
    const std::int64_t room = std::clamp<std::int64_t>(out_.pair_capacity - at, 0, held_);
    if (room > 0) std::memcpy(out_.pair + at, chunk_, static_cast<std::size_t>(room) * sizeof(Pair));
    held_ = 0;
  }

 private:
  static constexpr std::int32_t kChunk = 1024;
  const ContactsView& out_;
  std::int32_t held_ = 0;
  Pair chunk_[kChunk];
};

// The paper's form: both directions, column-major rows. kShared: other threads write to the same rows.
template <bool kShared>
class BallListSink {
 public:
  explicit BallListSink(const ContactsView& out) : out_(out) {}

  void add(std::int32_t i, std::int32_t j) {
    put(i, j);
    put(j, i);
  }
  void flush() {}

 private:
  void put(std::int32_t row, std::int32_t ball) {
    std::int32_t k;
    if constexpr (kShared)
      k = std::atomic_ref(out_.length[row]).fetch_add(1, std::memory_order_relaxed);
    else
      k = out_.length[row]++;
    if (k < out_.row_capacity) out_.slot[static_cast<std::int64_t>(k) * out_.n + row] = ball;
  }
  const ContactsView& out_;
};

// Nothing is kept but the count and the hash.
struct CountAndHashSink {
  std::int64_t contacts = 0;
  std::uint64_t hash = 0;
  void add(std::int32_t i, std::int32_t j) {
    ++contacts;
    hash += contact_hash_term(std::min(i, j), std::max(i, j));
  }
  void flush() {}
};

// Zeroes the counters of `out`.
inline void reset(const ContactsView& out) {
  if (out.form == OutputForm::pairs)
    *out.count = 0;
  else
    std::fill_n(out.length, out.n, 0);
}

// What an output on the host says of itself: for report() of detectors whose own workspace cannot overflow.
DetectorReport report_of_host_output(const ContactsView& out);

}  // namespace touchstone

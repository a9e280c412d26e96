// What adapters share: the exact test on a library's candidates, the list they are written to, and the rest of a Detector.
#pragma once

#include <cooperative_groups.h>

#include "kernels/contact_writer.h"
#include "kernels/detection.h"
#include "touchstone/contact.h"
#include "touchstone/detector.h"
#include "touchstone/error.h"

namespace touchstone {

// Writes balls i and j to the list if they touch. One atomic for all threads of a warp that write at once: the least that a list
// in global memory costs, so that a peer's time is its own. A list that is full is only counted.
__device__ inline void append_if_in_contact(const ContactsView& out, const Ball& a, std::int32_t i, const Ball& b,
                                            std::int32_t j) {
  if (!in_contact(a, b)) return;
  const auto writers = cooperative_groups::coalesced_threads();
  unsigned long long at = 0;
  if (writers.thread_rank() == 0)
    at = atomicAdd(reinterpret_cast<unsigned long long*>(out.count), static_cast<unsigned long long>(writers.size()));
  at = writers.shfl(at, 0) + writers.thread_rank();
  write_pair(out, static_cast<std::int64_t>(at), ordered_pair(i, j));
}

// Libraries find candidates with their own rounding: of boxes, of squares, of roots. Asked with radii larger by this, they find
// every pair that in_contact() accepts: it is twice eight roundings (2^-24) of the largest number that takes part, where a
// handful of operations lose half of one each. `reach` bounds the sum of two radii.
TOUCHSTONE_HD inline float slack(const Ball& b, float reach) {
  return 1e-6f * (fmaxf(fmaxf(fabsf(b.x), fabsf(b.y)), fabsf(b.z)) + reach);
}

// A library's detector. Unlike ours it may allocate and synchronise in find(), as the library does: all of it lies between the
// two events of a sample.
class PeerDetector : public Detector {
 public:
  explicit PeerDetector(const PackingFacts& facts) : n_(facts.n), rmax_(facts.rmax) {}

  void detect(BallsView in, ContactsView out, Stream& stream) final {
    if (out.form != OutputForm::pairs) throw InputError("peers write `pairs` only");
    if (in.n != n_) throw std::logic_error("a peer's detector was built for another number of balls");
    fill_bytes_async(out.count, 0, sizeof *out.count, stream);
    if (in.n > 0) find(in, out, stream);
  }
  DetectorReport report(ContactsView out, Stream& stream) final { return report_output(out, stream); }
  std::int64_t workspace_bytes() const override { return 0; }  // what is allocated inside the library is not known
  DetectorParams params() const final { return {}; }

 protected:
  virtual void find(BallsView in, ContactsView out, Stream& stream) = 0;  // *out.count is zero

  std::int32_t n_;
  float rmax_;
};

}  // namespace touchstone

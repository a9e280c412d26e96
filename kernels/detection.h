// Running a detector until nothing is lost: output storage, upload, and growing what was too small.
#pragma once

#include <memory>
#include <span>

#include "kernels/device.h"
#include "touchstone/detector.h"

namespace touchstone {

// Output buffers of one form, where the detector runs.
class ContactStorage {
 public:
  // capacity: pairs for OutputForm::pairs, slots a ball for ball_lists.
  ContactStorage(Place place, OutputForm form, std::int32_t n, std::int64_t capacity, Stream& stream);
  ContactsView view() const;
  std::int64_t capacity() const { return capacity_; }
  std::int64_t bytes() const;
  ContactList download(Stream& stream) const;  // the whole set, judged and sorted; call only when the report is complete

 private:
  OutputForm form_;
  std::int32_t n_;
  std::int64_t capacity_;
  Buffer<Pair> pair_;
  Buffer<std::int64_t> count_;
  Buffer<std::int32_t> length_, slot_;
};

inline constexpr std::int64_t kDefaultPairsABall = 8;

// A first guess that physical packings fit: so many pairs a ball, or rows for the largest ball among the smallest (multiple of 16).
std::int64_t default_capacity(OutputForm form, const PackingFacts& facts);

// A detector with its input resident and its output sized so that nothing overflowed: ready to be verified, then timed.
struct Detection {
  std::unique_ptr<Detector> detector;
  Buffer<Ball> balls;
  std::unique_ptr<ContactStorage> output;
  DetectorReport report;
  int retries = 0;  // how often something was grown

  BallsView input() const { return {balls.data(), static_cast<std::int32_t>(balls.size())}; }
  std::int64_t bytes() const;  // input, workspace and output
};

// Detects on d's balls, which are resident, and grows whichever of bucket, row or list was too small (to the true count) until
// the report is complete. Keeps d's output if it has one (of `form`), else makes one for `capacity`.
void complete_detection(Detection& d, const DetectorInfo& info, const PackingFacts& facts, DetectorParams params, OutputForm form,
                        Stream& stream, std::int64_t capacity);

// Uploads, detects, and grows whichever of bucket, row or list was too small (to the true count) until the report is complete.
// capacity 0 = default_capacity. Throws InputError from the detector's make, std::runtime_error after 8 retries.
Detection detect_completely(const DetectorInfo& info, std::span<const Ball> balls, const PackingFacts& facts,
                            DetectorParams params, OutputForm form, Stream& stream, std::int64_t capacity = 0);

// DetectorReport from an output's own counters: counts past capacity show which row or list was too small. For
// detectors' report(): they add their cells.
DetectorReport report_output(ContactsView out, Stream& stream);

}  // namespace touchstone

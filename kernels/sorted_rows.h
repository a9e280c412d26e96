// Contact lists in a defined order: what a detector finds in any order, in rows by ball, each row ascending.
#pragma once

#include "kernels/device.h"
#include "kernels/primitives.h"
#include "touchstone/contact_list.h"

namespace touchstone {

// Pairs: those of lower number i are row i, rows one after another. A detector finds its contacts twice: first it adds one to
// end()[i] for each, then it writes each where end()[i] points, and moves that on.
class SortedRows {
 public:
  SortedRows(std::int32_t n, Stream& stream);
  std::int64_t* end() const { return end_.data(); }  // [n]

  // All only enqueue.
  void clear(Stream& stream);                               // before counting
  void counts_to_starts(ContactsView out, Stream& stream);  // after it: end()[i] is the first place of row i; sets *out.count
  void sort(ContactsView out, Stream& stream);              // after writing, or of the rows of ball_lists

  std::int64_t bytes() const;

 private:
  std::int32_t n_;
  Buffer<std::int64_t> end_;
  ExclusiveScan scan_;
};

}  // namespace touchstone

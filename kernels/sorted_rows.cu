#include "kernels/sorted_rows.h"

#include "kernels/cuda_dialect.h"
#include "kernels/planning.h"

namespace touchstone {
namespace {

constexpr int kThreads = 256;
constexpr std::int64_t kInsertion = 24;  // entries; longer rows are sorted by a heap

// A row of ball numbers, `stride` words apart.
struct NumberRow {
  std::int32_t* first;
  std::int64_t stride;
  __device__ std::int32_t& operator[](std::int64_t k) const { return first[k * stride]; }
};

// The entry at `root` of a heap of `size` sinks to where it belongs.
__device__ inline void sink(const NumberRow& row, std::int64_t root, std::int64_t size) {
  const std::int32_t value = row[root];
  for (std::int64_t child; (child = 2 * root + 1) < size; root = child) {
    if (child + 1 < size && row[child + 1] > row[child]) ++child;
    if (row[child] <= value) break;
    row[root] = row[child];
  }
  row[root] = value;
}

// Ascending. Rows are short, but for a giant's: no row may take the square of its length.
__device__ inline void sort_row(const NumberRow& row, std::int64_t size) {
  if (size <= kInsertion) {
    for (std::int64_t k = 1; k < size; ++k) {
      const std::int32_t value = row[k];
      std::int64_t at = k;
      for (; at > 0 && row[at - 1] > value; --at) row[at] = row[at - 1];
      row[at] = value;
    }
    return;
  }
  for (std::int64_t root = size / 2; root-- > 0;) sink(row, root, size);
  for (std::int64_t left = size - 1; left > 0; --left) {
    const std::int32_t largest = row[0];
    row[0] = row[left];
    row[left] = largest;
    sink(row, 0, left);
  }
}

// One thread: the last row's count, before the scan loses it.
__global__ void last_count_kernel(const std::int64_t* count, std::int32_t n, std::int64_t* last) {
  if (threadIdx.x == 0) *last = count[n - 1];
}

// One thread: all contacts.
__global__ void total_kernel(const std::int64_t* start, std::int32_t n, std::int64_t* last_then_total) {
  if (threadIdx.x == 0) *last_then_total += start[n - 1];
}

// One thread a ball: its row of the pair list. The first number is one for all of a row.
__global__ void sort_pairs_kernel(const std::int64_t* end, std::int32_t n, ContactsView out) {
  const std::int64_t i = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i >= n || *out.count > out.pair_capacity) return;  // cut off: it says so, and is in no order
  const std::int64_t first = i == 0 ? 0 : end[i - 1];
  sort_row({&out.pair[first].j, 2}, end[i] - first);
}

// One thread a ball: its row.
__global__ void sort_slots_kernel(std::int32_t n, ContactsView out) {
  const std::int64_t i = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i >= n || out.length[i] > out.row_capacity) return;
  sort_row({out.slot + i, n}, out.length[i]);
}

}  // namespace

SortedRows::SortedRows(std::int32_t n, Stream& stream) : n_(n), end_(n, Place::device, stream), scan_(n, stream) {}

void SortedRows::clear(Stream& stream) { fill_async(end_, 0, stream); }

void SortedRows::counts_to_starts(ContactsView out, Stream& stream) {
  launch(stream, {1, 32}, last_count_kernel, end_.data(), n_, out.count);
  scan_.scan(end_.data(), stream);
  launch(stream, {1, 32}, total_kernel, end_.data(), n_, out.count);
}

void SortedRows::sort(ContactsView out, Stream& stream) {
  const LaunchShape shape{blocks_for(n_, kThreads), kThreads};
  if (out.form == OutputForm::pairs)
    launch(stream, shape, sort_pairs_kernel, end_.data(), n_, out);
  else
    launch(stream, shape, sort_slots_kernel, n_, out);
}

std::int64_t SortedRows::bytes() const { return static_cast<std::int64_t>(end_.bytes()) + scan_.bytes(); }

}  // namespace touchstone

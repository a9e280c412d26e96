#include "kernels/sorted_rows.h"

#include "kernels/cuda_dialect.h"
#include "kernels/planning.h"

namespace touchstone {
namespace {

constexpr int kThreads = 256;
constexpr std::int64_t kInsertion = 24;  // entries; longer rows are sorted by all threads of a block

// A row of ball numbers, `stride` words apart.
struct NumberRow {
  std::int32_t* first;
  std::int64_t stride, size;
  __device__ std::int32_t& operator[](std::int64_t k) const { return first[k * stride]; }
};

// One thread. Ascending, as below.
__device__ inline void sort_short_row(const NumberRow& row) {
  for (std::int64_t k = 1; k < row.size; ++k) {
    const std::int32_t value = row[k];
    std::int64_t at = k;
    for (; at > 0 && row[at - 1] > value; --at) row[at] = row[at - 1];
    row[at] = value;
  }
}

// All threads of the block together: bitonic (Batcher 1968), each merge beginning with the second half mirrored. So the lesser
// always goes first, and entries past the end, as if they were larger than all, would never move: any size will do.
__device__ inline void sort_long_row(const NumberRow& row) {
  for (int merge = 0; std::int64_t{1} << merge < row.size; ++merge)
    for (int bits = merge; bits >= 0; --bits) {
      const std::int64_t step = std::int64_t{1} << bits;
      for (std::int64_t k = threadIdx.x;; k += blockDim.x) {
        const std::int64_t within = k & (step - 1), begin = (k - within) * 2;
        const std::int64_t a = begin + within, b = bits == merge ? begin + 2 * step - 1 - within : a + step;
        if (a >= row.size) break;
        if (b >= row.size) continue;
        const std::int32_t lesser = min(row[a], row[b]), other = max(row[a], row[b]);
        row[a] = lesser, row[b] = other;
      }
      __syncthreads();
    }
}

// One thread a row: row_of(i) for each of `rows`. No row is waited for alone: a giant's has thousands of entries.
template <class RowOf>
__device__ inline void sort_rows(std::int32_t rows, RowOf&& row_of) {
  __shared__ int long_rows;
  __shared__ int long_row[kThreads];
  if (threadIdx.x == 0) long_rows = 0;
  __syncthreads();
  const std::int64_t first = static_cast<std::int64_t>(blockIdx.x) * blockDim.x;
  if (first + threadIdx.x < rows) {
    const NumberRow row = row_of(first + threadIdx.x);
    if (row.size <= kInsertion)
      sort_short_row(row);
    else
      long_row[atomicAdd(&long_rows, 1)] = static_cast<int>(threadIdx.x);
  }
  __syncthreads();
  for (int k = 0; k < long_rows; ++k) sort_long_row(row_of(first + long_row[k]));
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
  if (*out.count > out.pair_capacity) return;  // cut off: it says so, and is in no order
  sort_rows(n, [&](std::int64_t i) {
    const std::int64_t first = i == 0 ? 0 : end[i - 1];
    return NumberRow{&out.pair[first].j, 2, end[i] - first};
  });
}

// One thread a ball: its row, unless it was cut off.
__global__ void sort_slots_kernel(std::int32_t n, ContactsView out) {
  sort_rows(n, [&](std::int64_t i) { return NumberRow{out.slot + i, n, out.length[i] > out.row_capacity ? 0 : out.length[i]}; });
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

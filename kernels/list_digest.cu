#include "kernels/list_digest.h"

#include "kernels/cuda_dialect.h"

namespace touchstone {
namespace {

constexpr int kThreads = 256;
constexpr std::int64_t kBlocks =
    kDeviceIsDouble ? 4 : 1056;  // enough to fill the largest GPU of today; threads stride over the list

// Each thread sums every so-manieth entry, each block its threads; the host sums the blocks.
__global__ void digest_kernel(ContactsView list, Numbering number, ListDigest* of_block) {
  ListDigest* const shared = dynamic_shared<ListDigest>();
  const std::int64_t entries = ListDigest::entries(list), step = static_cast<std::int64_t>(gridDim.x) * blockDim.x;
  ListDigest mine;
  for (std::int64_t at = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x; at < entries; at += step)
    mine.add_entry(list, at, number);
  shared[threadIdx.x] = mine;
  __syncthreads();
  for (int half = static_cast<int>(blockDim.x) / 2; half > 0; half /= 2) {
    if (static_cast<int>(threadIdx.x) < half) shared[threadIdx.x].add(shared[threadIdx.x + half]);
    __syncthreads();
  }
  if (threadIdx.x == 0) of_block[blockIdx.x] = shared[0];
}

}  // namespace

ListDigest digest_on_device(const ContactsView& list, const Numbering& number, Stream& stream) {
  ListDigest total;
  if (list.n == 0) return total;
  Buffer<ListDigest> of_block(kBlocks, Place::device, stream);
  launch(stream, {kBlocks, kThreads, kThreads * sizeof(ListDigest)}, digest_kernel, list, number, of_block.data());
  for (const ListDigest& d : download(of_block.data(), of_block.size(), stream)) total.add(d);
  return total;
}

}  // namespace touchstone

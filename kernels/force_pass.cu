#include "kernels/force_pass.h"

#include "kernels/cuda_dialect.h"
#include "kernels/planning.h"
#include "reference_cpu/force_pass.h"

namespace touchstone {
namespace {

constexpr int kThreads = 256;
constexpr std::int64_t kPairBlocks = 1056;  // enough to fill the largest GPU of today; each thread strides over the list

// Threads stride over the pairs; each adds to both balls.
__global__ void force_by_pair_kernel(BallsView in, ContactsView list, Force* force) {
  const std::int64_t count = min(*list.count, list.pair_capacity), step = static_cast<std::int64_t>(gridDim.x) * blockDim.x;
  for (std::int64_t p = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x; p < count; p += step) {
    const Pair pair = list.pair[p];
    const Force f = spring_force(in.data[pair.i], in.data[pair.j]);
    atomicAdd(&force[pair.i].x, f.x), atomicAdd(&force[pair.i].y, f.y), atomicAdd(&force[pair.i].z, f.z);
    atomicAdd(&force[pair.j].x, -f.x), atomicAdd(&force[pair.j].y, -f.y), atomicAdd(&force[pair.j].z, -f.z);
  }
}

// One thread a ball sums over its row (paper 3.1, kernel 1).
__global__ void force_by_ball_kernel(BallsView in, ContactsView list, Force* force) {
  const std::int64_t i = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i >= in.n) return;
  force[i] = force_on_ball(in, list, static_cast<std::int32_t>(i));
}

}  // namespace

void add_forces(BallsView in, const ContactsView& list, Force* force, Stream& stream) {
  if (in.n == 0) return;
  stream.mark("force");
  if (list.form == OutputForm::pairs) {
    fill_bytes_async(force, 0, sizeof(Force) * in.n, stream);
    launch(stream, {kPairBlocks, kThreads}, force_by_pair_kernel, in, list, force);
  } else {
    launch(stream, {blocks_for(in.n, kThreads), kThreads}, force_by_ball_kernel, in, list, force);
  }
}

}  // namespace touchstone

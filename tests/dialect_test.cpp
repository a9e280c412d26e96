// The kernels' double (kernels/cuda_dialect.h) judged by toy kernels whose answers are known. What sanitizers must report is in
// dialect_faults.cpp.
#include "kernels/cuda_dialect.h"

#include <gtest/gtest.h>

#include <numeric>
#include <set>
#include <string>
#include <vector>

namespace touchstone {
namespace {

template <class T>
Buffer<T> zeros(std::size_t size, Stream& stream) {
  Buffer<T> buffer(size, Place::device, stream);
  fill_async(buffer, 0, stream);
  return buffer;
}

template <class T>
std::vector<T> values(const Buffer<T>& buffer, Stream& stream) {
  return download(buffer.data(), buffer.size(), stream);
}

// What launch() throws, "" if nothing.
template <class... Args>
std::string error_of(Args&&... args) {
  try {
    launch(std::forward<Args>(args)...);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

struct DialectTest : testing::Test {
  Stream stream;
  ~DialectTest() override { set_block_order_seed(0); }
};

// One thread a place: who am I?
__global__ void number_kernel(int* out) {
  out[blockIdx.x * blockDim.x + threadIdx.x] = static_cast<int>(blockIdx.x * 10000 + gridDim.x * 1000 + threadIdx.x);
}

TEST_F(DialectTest, EachThreadRunsOnce) {
  for (int threads : {32, 64, 96, 1024}) {
    Buffer<int> out = zeros<int>(5 * threads, stream);
    launch(stream, {5, threads}, number_kernel, out.data());
    const std::vector<int> found = values(out, stream);
    for (int k = 0; k < 5 * threads; ++k) ASSERT_EQ(found[k], k / threads * 10000 + 5000 + k % threads);
  }
}

// A block sums its part in shared memory, halving the stride between barriers: the textbook reduction.
__global__ void sum_kernel(const int* in, std::int64_t* total) {
  __shared__ int part[128];
  const unsigned t = threadIdx.x;
  part[t] = in[blockIdx.x * blockDim.x + t];
  for (unsigned stride = blockDim.x / 2; stride > 0; stride /= 2) {
    __syncthreads();
    if (t < stride) part[t] += part[t + stride];
  }
  if (t == 0) atomic_add(total, std::int64_t{part[0]});
}

TEST_F(DialectTest, BarriersOrderSharedMemory) {
  std::vector<int> numbers(128 * 50);
  std::iota(numbers.begin(), numbers.end(), 1);
  Buffer<int> in(numbers.size(), Place::device, stream);
  copy_async(in, std::span<const int>(numbers), stream);
  for (int repeat = 0; repeat < 10; ++repeat) {
    Buffer<std::int64_t> total = zeros<std::int64_t>(1, stream);
    launch(stream, {50, 128}, sum_kernel, in.data(), total.data());
    ASSERT_EQ(values(total, stream)[0], 6400 * 6401 / 2);
  }
}

// Lane l of each warp: the collectives, one after another.
__global__ void collectives_kernel(int* out) {
  const int t = static_cast<int>(threadIdx.x), lane = t % 32;
  int* mine = out + t * 10;
  mine[0] = __shfl_sync(kFullWarp, t, 5);
  mine[1] = __shfl_sync(kFullWarp, t, lane + 33);
  mine[2] = __shfl_up_sync(kFullWarp, t, 3u);
  mine[3] = __shfl_down_sync(kFullWarp, t, 3u);
  mine[4] = __shfl_xor_sync(kFullWarp, t, 16);
  mine[5] = static_cast<int>(__ballot_sync(kFullWarp, lane % 3 == 0));
  mine[6] = __any_sync(kFullWarp, t == 40);
  mine[7] = __all_sync(kFullWarp, t >= 32);
  mine[8] = static_cast<int>(__shfl_sync(kFullWarp, 0.5f * static_cast<float>(t), 7) * 2);
  mine[9] = static_cast<int>(__shfl_sync(kFullWarp, static_cast<std::int64_t>(t) << 40, 9) >> 40);
}

TEST_F(DialectTest, WarpCollectives) {
  Buffer<int> out = zeros<int>(96 * 10, stream);
  launch(stream, {1, 96}, collectives_kernel, out.data());
  const std::vector<int> found = values(out, stream);
  for (int t = 0; t < 96; ++t) {
    const int lane = t % 32, first = t - lane;
    const int expected[10] = {first + 5,
                              first + (lane + 1) % 32,
                              lane < 3 ? t : t - 3,
                              lane > 28 ? t : t + 3,
                              first + (lane ^ 16),
                              0x49249249,
                              first == 32,
                              first >= 32,
                              first + 7,
                              first + 9};
    for (int k = 0; k < 10; ++k) ASSERT_EQ(found[t * 10 + k], expected[k]) << "thread " << t << ", word " << k;
  }
}

// Warp w scans its numbers w + 1 times over: within a warp all lanes run equally often, but no warp may wait for another.
__global__ void scan_kernel(int* out) {
  int sum = 1;
  for (unsigned repeat = 0; repeat <= threadIdx.x / 32; ++repeat)
    for (unsigned delta = 1; delta < 32; delta *= 2) {
      const int below = __shfl_up_sync(kFullWarp, sum, delta);
      if (threadIdx.x % 32 >= delta) sum += below;
    }
  out[threadIdx.x] = sum;
}

TEST_F(DialectTest, WarpsGoTheirOwnWays) {
  Buffer<int> out = zeros<int>(128, stream);
  launch(stream, {1, 128}, scan_kernel, out.data());
  const std::vector<int> found = values(out, stream);
  for (int warp = 0; warp < 4; ++warp) {
    std::vector<int> expected(32, 1);
    for (int repeat = 0; repeat <= warp; ++repeat) std::partial_sum(expected.begin(), expected.end(), expected.begin());
    EXPECT_EQ(std::vector<int>(found.begin() + 32 * warp, found.begin() + 32 * (warp + 1)), expected) << "warp " << warp;
  }
}

// `seen` and `left` count what atomicAdd and atomicExch gave back.
__global__ void atomics_kernel(int* word, unsigned* wide, unsigned long long* wider, float* real, int* seen, int* left) {
  const int t = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  atomicAdd(&seen[atomicAdd(&word[0], 1)], 1);
  atomicMax(&word[1], t);
  atomicMin(&word[2], -t);
  if (atomicCAS(&word[3], 0, t + 1) == 0) {
    atomicAdd(&word[5], 1);
    word[6] = t + 1;  // one thread alone comes here
  }
  atomicAdd(&left[atomicExch(&word[4], t + 1)], 1);
  if (t == 0) {
    word[7] = atomicMax(&word[9], 5) * 10 + atomicMax(&word[9], 3);
    word[8] = atomicMin(&word[10], -5) * 10 + atomicMin(&word[10], -3);
  }
  __syncthreads();
  for (int k = 0; k < 5000; ++k) atomicAdd(&word[11], 1);  // often enough for threads to come between load and store
  atomicAdd(wide, 0x80000000u + 1u);
  atomicAdd(wider, 1ull << 40);
  atomicAdd(real, 0.25f);
}

TEST_F(DialectTest, Atomics) {
  constexpr int kThreads = 4 * 64;
  auto word = zeros<int>(12, stream), seen = zeros<int>(kThreads, stream), left = zeros<int>(kThreads + 1, stream);
  auto wide = zeros<unsigned>(1, stream);
  auto wider = zeros<unsigned long long>(1, stream);
  auto real = zeros<float>(1, stream);
  launch(stream, {4, 64}, atomics_kernel, word.data(), wide.data(), wider.data(), real.data(), seen.data(), left.data());
  const std::vector<int> found = values(word, stream);
  EXPECT_EQ(found[0], kThreads);
  EXPECT_EQ(found[1], kThreads - 1);
  EXPECT_EQ(found[2], 1 - kThreads);
  EXPECT_EQ(found[5], 1) << "atomicCAS: one thread finds the 0";
  EXPECT_EQ(found[3], found[6]) << "atomicCAS: and no other changes the word";
  EXPECT_EQ(found[7], 0 * 10 + 5) << "atomicMax gives the old value";
  EXPECT_EQ(found[8], 0 * 10 - 5) << "atomicMin gives the old value";
  EXPECT_EQ(found[11], 5000 * kThreads);
  EXPECT_EQ(values(wide, stream)[0], unsigned{kThreads});
  EXPECT_EQ(values(wider, stream)[0], static_cast<unsigned long long>(kThreads) << 40);
  EXPECT_EQ(values(real, stream)[0], 0.25f * kThreads);
  for (int count : values(seen, stream)) ASSERT_EQ(count, 1);  // each old value was given out once
  std::vector<int> exchanged = values(left, stream);
  ++exchanged.at(found[4]);  // the last value stayed
  for (int count : exchanged) ASSERT_EQ(count, 1);
}

__global__ void bits_kernel(int* out) {
  if (threadIdx.x) return;
  out[0] = __popc(0xF0F0u);
  out[1] = __popcll(0xF0F0ull << 30);
  out[2] = __ffs(0);
  out[3] = __ffs(8);
  out[4] = __clz(1);
  out[5] = __clz(0);
  out[6] = min(3, 4) * 10 + max(3, 4);
}

TEST_F(DialectTest, Bits) {
  Buffer<int> out = zeros<int>(7, stream);
  launch(stream, {1, 32}, bits_kernel, out.data());
  EXPECT_EQ(values(out, stream), (std::vector<int>{8, 8, 0, 4, 31, 32, 34}));
}

// Each thread counts the poison it finds in its share of the block's shared memory, then overwrites it.
__global__ void poison_kernel(int bytes, int* poisoned) {
  unsigned char* shared = dynamic_shared<unsigned char>();
  for (int k = static_cast<int>(threadIdx.x); k < bytes; k += static_cast<int>(blockDim.x)) {
    atomicAdd(poisoned, shared[k] == 0xCD);
    shared[k] = 0;
  }
}

TEST_F(DialectTest, SharedMemoryIsPoisonedForEachBlock) {
  Buffer<int> poisoned = zeros<int>(1, stream);
  launch(stream, {7, 32, 1000}, poison_kernel, 1000, poisoned.data());
  EXPECT_EQ(values(poisoned, stream)[0], 7000);
}

__global__ void order_kernel(int* next, unsigned* order) {
  if (threadIdx.x == 0) order[atomicAdd(next, 1)] = blockIdx.x;
}

TEST_F(DialectTest, BlocksRunInSeededOrder) {
  const auto order_of = [&] {
    Buffer<int> next = zeros<int>(1, stream);
    Buffer<unsigned> order = zeros<unsigned>(40, stream);
    launch(stream, {40, 32}, order_kernel, next.data(), order.data());
    return values(order, stream);
  };
  std::vector<unsigned> ascending(40);
  std::iota(ascending.begin(), ascending.end(), 0u);
  EXPECT_EQ(order_of(), ascending);
  std::set<std::vector<unsigned>> seen{ascending};
  for (std::uint64_t seed : {1, 2, 3}) {
    set_block_order_seed(seed);
    const std::vector<unsigned> first = order_of(), second = order_of();
    EXPECT_TRUE(seen.insert(first).second) << "seed " << seed << " gave an order seen before";
    EXPECT_NE(first, second) << "a second launch must get an order of its own";
    set_block_order_seed(seed);
    EXPECT_EQ(order_of(), first) << "the same seed must give the same order";
    std::vector<unsigned> sorted = first;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, ascending);
  }
}

// All threads of all blocks add, meet, and then each must see the sum of all.
__global__ void meet_kernel(int* count, int* agreed) {
  atomicAdd(count, 1);
  grid_sync();
  atomicAdd(agreed, *count == static_cast<int>(gridDim.x * blockDim.x));
}

TEST_F(DialectTest, BlocksMeetInGridSync) {
  Buffer<int> count = zeros<int>(1, stream), agreed = zeros<int>(1, stream);
  launch_together(stream, {6, 64}, meet_kernel, count.data(), agreed.data());
  EXPECT_EQ(values(agreed, stream)[0], 6 * 64);
  EXPECT_NE(error_of(stream, LaunchShape{6, 64}, meet_kernel, count.data(), agreed.data()), "")
      << "blocks one by one cannot meet";
}

// ---- defects that must be errors, not hangs ----

__global__ void early_exit_kernel(int leaver) {
  if (static_cast<int>(threadIdx.x) == leaver) return;
  __syncthreads();
}
__global__ void lane_exit_kernel() {
  if (threadIdx.x == 3) return;
  __ballot_sync(kFullWarp, true);
}
__global__ void astray_kernel() {
  if (threadIdx.x < 32)
    __syncthreads();
  else
    __syncthreads();
}
__global__ void mixed_kernel() {
  if (threadIdx.x % 32 < 16)
    __syncwarp();
  else
    __ballot_sync(kFullWarp, true);
}
// clang-format off
__global__ void mixed_in_a_line_kernel() { if (threadIdx.x % 32 < 16) __any_sync(kFullWarp, true); else __all_sync(kFullWarp, true); }
// clang-format on
__global__ void half_warp_kernel() { __ballot_sync(0xFFFFu, true); }
__global__ void throwing_kernel(int thrower) {
  if (static_cast<int>(threadIdx.x) == thrower) throw std::runtime_error("thrown on purpose");
  __syncthreads();
}
__global__ void idle_kernel() {}

TEST_F(DialectTest, DefectsAreErrorsNotHangs) {
  const LaunchShape shape{3, 64};
  for (int thread : {0, 31, 63}) {
    const std::string error = error_of(stream, shape, early_exit_kernel, thread);
    EXPECT_NE(error.find("63 at __syncthreads()"), std::string::npos) << error;
    EXPECT_NE(error.find("1 at the end of the kernel"), std::string::npos) << error;
    EXPECT_EQ(error_of(stream, shape, throwing_kernel, thread), "thrown on purpose");
  }
  EXPECT_NE(error_of(stream, shape, lane_exit_kernel).find("31 at __ballot_sync()"), std::string::npos);
  EXPECT_NE(error_of(stream, shape, astray_kernel).find("meet at different places"), std::string::npos);
  EXPECT_NE(error_of(stream, shape, mixed_kernel).find("meet at different places"), std::string::npos);
  EXPECT_NE(error_of(stream, shape, mixed_in_a_line_kernel).find("meet at different places"), std::string::npos);
  EXPECT_NE(error_of(stream, shape, half_warp_kernel).find("whole warps only"), std::string::npos);
  EXPECT_EQ(error_of(stream, shape, idle_kernel), "") << "the next launch is as good as new";
}

TEST_F(DialectTest, ShapesNoGpuWouldTakeAreRefused) {
  for (int threads : {0, 31, 48, 1056, -32})
    EXPECT_NE(error_of(stream, LaunchShape{1, threads}, idle_kernel), "") << threads << " threads";
  EXPECT_NE(error_of(stream, LaunchShape{0, 32}, idle_kernel), "");
  EXPECT_NE(error_of(stream, LaunchShape{std::int64_t{1} << 31, 32}, idle_kernel), "");
  EXPECT_NE(error_of(stream, LaunchShape{1, 32, 227 * 1024 + 1}, idle_kernel), "");
  EXPECT_EQ(error_of(stream, LaunchShape{1, 32, 227 * 1024}, idle_kernel), "");
  EXPECT_THROW(__syncthreads(), std::logic_error) << "outside a kernel";
}

}  // namespace
}  // namespace touchstone

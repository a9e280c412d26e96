// Occupancy arithmetic against the paper's Table 3, NVIDIA's worked examples, and NVIDIA's own calculator where it is installed.
#include "bench/occupancy.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/run_program.h"
#include "touchstone/error.h"

#if __has_include(<cuda_occupancy.h>)
#include <cuda_occupancy.h>
#endif

namespace touchstone::testing {
namespace {

// Table 3 as printed is the GTX580's (compute 2.0); on the GTX285 (1.3) the same kernels would reach 0.75 and 0.50.
TEST(Occupancy, Table3IsTheGtx580s) {
  const auto file = nlohmann::json::parse(file_text(std::string(TOUCHSTONE_SOURCE_DIR) + "/results/paper/table3.json"));
  const nlohmann::json rows = file["context"]["touchstone"]["table"]["rows"];
  ASSERT_EQ(rows.size(), 2u);
  const double on_gtx285[] = {0.75, 0.50};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto number = [&](int column) { return std::stod(rows[k][column].get<std::string>()); };
    const KernelNeeds needs{static_cast<int>(number(1)), static_cast<int>(number(3)), static_cast<int>(number(2))};
    EXPECT_NEAR(occupancy(multiprocessor("2.0"), needs).share, number(4), 0.0005) << rows[k];
    EXPECT_DOUBLE_EQ(occupancy(multiprocessor("1.3"), needs).share, on_gtx285[k]) << rows[k];
  }
}

struct Known {
  const char* capability;
  KernelNeeds needs;
  int blocks;
  const char* limited_by;
};

// Worked by hand from the rules in occupancy.cpp; the first two of 9.0 are the example of NVIDIA's Best Practices Guide (given
// there for 7.0, which gives registers alike): 128 threads of 37 registers, 12 blocks, 75 %; 320 threads, 4 blocks, 63 %.
TEST(Occupancy, KnownValues) {
  const Known known[] = {
      {"9.0", {128, 37, 0}, 12, "registers"},
      {"9.0", {320, 37, 0}, 4, "registers"},
      {"9.0", {1024, 64, 0}, 1, "registers"},  // 2,048 registers a warp, 32 warps: the file to the last one
      {"9.0", {1024, 65, 0}, 0, "registers"},
      {"9.0", {32, 16, 0}, 32, "blocks"},
      {"9.0", {32, 16, 12 * 1024}, 17, "shared memory"},  // 13 KB a block with the system's own, of 228
      {"9.0", {128, 32, 227 * 1024}, 1, "shared memory"},
      {"9.0", {128, 32, 227 * 1024 + 1}, 0, "shared memory"},
      {"2.0", {192, 20, 0}, 8, "warps"},  // 20 registers and 192 threads: the whole multiprocessor
      {"2.0", {192, 21, 0}, 7, "registers"},
      {"2.0", {608, 25, 0}, 2, "warps"},      // 832 registers a warp: 38 warps, two blocks of 19
      {"2.0", {128, 63, 0}, 4, "registers"},  // 16 warps of 48: the third that 63 registers leave
      {"2.0", {128, 64, 0}, 0, "registers"},
      {"2.0", {256, 16, 12288}, 4, "shared memory"},
      {"2.0", {256, 16, 12289}, 3, "shared memory"},
      {"1.3", {256, 16, 0}, 4, "warps"},
      {"1.3", {256, 17, 0}, 3, "registers"},
      {"1.3", {96, 16, 0}, 8, "blocks"},  // 3 warps count as 4: 2,048 registers, not 1,536
      {"1.3", {96, 17, 0}, 6, "registers"},
      {"1.3", {64, 8, 2048}, 8, "blocks"},
      {"1.3", {64, 8, 2049}, 6, "shared memory"},
      {"1.3", {1024, 8, 0}, 0, "warps"},
  };
  for (const Known& k : known) {
    const Occupancy o = occupancy(multiprocessor(k.capability), k.needs);
    const std::string what = std::string(k.capability) + ": " + std::to_string(k.needs.threads) + " threads, " +
                             std::to_string(k.needs.registers) + " registers, " + std::to_string(k.needs.shared_bytes) + " B";
    EXPECT_EQ(o.blocks, k.blocks) << what;
    EXPECT_EQ(o.limited_by, k.limited_by) << what;
    EXPECT_DOUBLE_EQ(o.share, 1.0 * k.blocks * ((k.needs.threads + 31) / 32) / multiprocessor(k.capability).warps) << what;
  }
}

TEST(Occupancy, RefusesWhatIsNoKernel) {
  EXPECT_THROW(occupancy(multiprocessor("2.0"), {0, 16, 0}), InputError);
  EXPECT_THROW(occupancy(multiprocessor("2.0"), {128, -1, 0}), InputError);
  EXPECT_THROW(occupancy(multiprocessor("2.0"), {128, 16, -1}), InputError);
  try {
    multiprocessor("3.0");
    FAIL() << "3.0 is not in the table";
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "compute capability '3.0': occupancy arithmetic knows 1.3, 2.0, 9.0");
  }
}

// NVIDIA's own arithmetic, which today's toolkit brings for 5.0 and later, over all that our kernels could ask.
TEST(Occupancy, AgreesWithNvidiasCalculator) {
#if __has_include(<cuda_occupancy.h>)
  const MultiprocessorLimits& m = multiprocessor("9.0");
  cudaOccDeviceProp device;
  device.computeMajor = 9;
  device.maxThreadsPerBlock = m.threads_a_block;
  device.maxThreadsPerMultiprocessor = 32 * m.warps;
  device.regsPerBlock = device.regsPerMultiprocessor = m.registers;
  device.warpSize = 32;
  device.sharedMemPerBlock = 48 * 1024;
  device.sharedMemPerMultiprocessor = m.shared_bytes;
  device.sharedMemPerBlockOptin = m.shared_bytes_a_block;
  device.reservedSharedMemPerBlock = m.reserved_shared_bytes;
  device.numSms = 132;
  cudaOccDeviceState state;
  state.carveoutConfig = SHAREDMEM_CARVEOUT_MAX_SHARED;
  int compared = 0;
  for (int threads = 32; threads <= 1024; threads += 32)
    for (int registers = 1; registers <= 255; registers += 2)
      for (const int shared : {0, 1, 528, 4096, 12288, 49152, 100000, 227 * 1024}) {
        cudaOccFuncAttributes kernel;
        kernel.maxThreadsPerBlock = 1024;
        kernel.numRegs = registers;
        kernel.shmemLimitConfig = FUNC_SHMEM_LIMIT_OPTIN;
        kernel.maxDynamicSharedSizeBytes = m.shared_bytes_a_block;
        cudaOccResult result;
        ASSERT_EQ(cudaOccMaxActiveBlocksPerMultiprocessor(&result, &device, &kernel, &state, threads, shared), CUDA_OCC_SUCCESS);
        ASSERT_EQ(occupancy(m, {threads, registers, shared}).blocks, result.activeBlocksPerMultiprocessor)
            << threads << " threads, " << registers << " registers, " << shared << " B";
        ++compared;
      }
  EXPECT_EQ(compared, 32 * 128 * 8);
#else
  GTEST_SKIP() << "no CUDA toolkit: its cuda_occupancy.h is what this compares with";
#endif
}

}  // namespace
}  // namespace touchstone::testing

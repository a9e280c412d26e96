// Each build of the kernels must be what its name says: the emulated library plain C++ whose kernels run here and now, the
// device library nvcc's. Built twice, like detectors_test.
#include <gtest/gtest.h>

#include <string>

#include "kernels/built_for.h"
#include "kernels/device.h"

namespace touchstone {
namespace {

TEST(EmulationBuild, KernelsAreBuiltForWhatThisProgramSays) {
  EXPECT_EQ(std::string(kernels_built_for()), TOUCHSTONE_EXPECTED_BUILD);
  EXPECT_EQ(kDeviceIsDouble, std::string(TOUCHSTONE_EXPECTED_BUILD) == "cpu");
}

TEST(EmulationBuild, DetectorsAreListed) { EXPECT_GE(gpu_detectors().size(), 5u); }

}  // namespace
}  // namespace touchstone

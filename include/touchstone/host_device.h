// Words that let one source serve host and device, and float operations that no compiler flag can change.
#pragma once

#include <cmath>

#if defined(__CUDACC__)
#define TOUCHSTONE_HD __host__ __device__
#else
#define TOUCHSTONE_HD
#endif

namespace touchstone {

// Each operation is rounded once to nearest. On the device the intrinsics forbid contraction to FMA whatever
// the flags; on the host the build passes -ffp-contract=off (checked by tests/contact_test.cpp).
#if defined(__CUDA_ARCH__)
__device__ inline float mul(float a, float b) { return __fmul_rn(a, b); }
__device__ inline float add(float a, float b) { return __fadd_rn(a, b); }
__device__ inline float sub(float a, float b) { return __fsub_rn(a, b); }
__device__ inline float clamp(float v, float low, float high) { return fminf(fmaxf(v, low), high); }
#else
TOUCHSTONE_HD inline float mul(float a, float b) { return a * b; }
TOUCHSTONE_HD inline float add(float a, float b) { return a + b; }
TOUCHSTONE_HD inline float sub(float a, float b) { return a - b; }
// The same value as on the device (NaN gives low). Host compilers call libm for fminf and fmaxf, ten times slower.
TOUCHSTONE_HD inline float clamp(float v, float low, float high) { return v > low ? (v < high ? v : high) : low; }
#endif

}  // namespace touchstone

#include "kernels/built_for.h"

#include "kernels/cuda_dialect.h"

namespace touchstone {

#if defined(__CUDACC__)
const char* kernels_built_for() { return "gpu"; }
#else
const char* kernels_built_for() { return "cpu"; }
#endif

}  // namespace touchstone

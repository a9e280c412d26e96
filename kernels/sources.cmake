# The kernels, listed once: nvcc compiles them for the GPU (kernels/), the C++ compiler for the double (kernels/emulated/).
set(TOUCHSTONE_KERNEL_SOURCES
  built_for.cu)

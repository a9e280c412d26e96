# Sets TOUCHSTONE_HAVE_CUDA, and enables the language with flags that keep contact sets equal to the CPU's.
set(TOUCHSTONE_HAVE_CUDA FALSE)
if(TOUCHSTONE_SANITIZE OR TOUCHSTONE_CUDA STREQUAL "OFF")
  return()
endif()

include(CheckLanguage)
check_language(CUDA)
if(NOT CMAKE_CUDA_COMPILER)
  if(TOUCHSTONE_CUDA STREQUAL "ON")
    message(FATAL_ERROR "TOUCHSTONE_CUDA=ON, but no nvcc was found: put the CUDA toolkit's bin folder (12.0 or later) on PATH, or set CUDACXX")
  endif()
  message(STATUS "No nvcc found: the CUDA kernels are built for the tests only, and CPU detectors alone are measured")
  return()
endif()

# native is an error where there is no GPU: ask the driver first.
if(NOT CMAKE_CUDA_ARCHITECTURES)
  execute_process(COMMAND nvidia-smi --query-gpu=compute_cap --format=csv,noheader
                  OUTPUT_VARIABLE touchstone_gpus ERROR_QUIET RESULT_VARIABLE touchstone_no_gpu)
  if(touchstone_no_gpu STREQUAL "0" AND touchstone_gpus MATCHES "[0-9]")
    set(CMAKE_CUDA_ARCHITECTURES native)
  elseif(DEFINED ENV{CI})
    set(CMAKE_CUDA_ARCHITECTURES 90)
  else()
    set(CMAKE_CUDA_ARCHITECTURES 75-real 80-real 86-real 90-real 100-real 120)
  endif()
  set(CMAKE_CUDA_ARCHITECTURES ${CMAKE_CUDA_ARCHITECTURES} CACHE STRING "GPU architectures" FORCE)
endif()

enable_language(CUDA)
find_package(CUDAToolkit REQUIRED)
set(TOUCHSTONE_HAVE_CUDA TRUE)

# CMake 3.25 does not know that nvcc speaks C++20: it drops the standard, or stops where it is required (CUDA inherits
# that from CXX). So it is not required here, and the flag is passed by hand.
set(CMAKE_CUDA_STANDARD_REQUIRED OFF)
add_compile_options($<$<COMPILE_LANGUAGE:CUDA>:-std=c++20> $<$<COMPILE_LANGUAGE:CUDA>:--fmad=false>
                    $<$<COMPILE_LANGUAGE:CUDA>:-prec-div=true> $<$<COMPILE_LANGUAGE:CUDA>:-prec-sqrt=true>
                    "$<$<COMPILE_LANGUAGE:CUDA>:-Xcompiler=-ffp-contract=off,-Wall>")

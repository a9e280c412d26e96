# Sets TOUCHSTONE_HAVE_CUDA (else TOUCHSTONE_WHY_NO_CUDA, for people), and enables the language with flags that keep contact sets
# equal to the CPU's.
set(TOUCHSTONE_HAVE_CUDA FALSE)
set(TOUCHSTONE_WHY_NO_CUDA "")
if(TOUCHSTONE_SANITIZE)
  set(TOUCHSTONE_WHY_NO_CUDA "it is built with a sanitizer")
  return()
elseif(TOUCHSTONE_CUDA STREQUAL "OFF")
  set(TOUCHSTONE_WHY_NO_CUDA "it was configured with TOUCHSTONE_CUDA=OFF, as preset cpu does; preset gpu builds them")
  return()
endif()

include(CheckLanguage)
check_language(CUDA)
if(NOT CMAKE_CUDA_COMPILER)
  if(TOUCHSTONE_CUDA STREQUAL "ON")
    message(FATAL_ERROR "TOUCHSTONE_CUDA=ON, but no nvcc was found: put the CUDA toolkit's bin folder (12.0 or later) on PATH, or set CUDACXX")
  endif()
  set(TOUCHSTONE_WHY_NO_CUDA "no nvcc (CUDA toolkit 12 or later) was found when it was configured")
  message(STATUS "No nvcc found: the CUDA kernels are built for the tests only, and CPU detectors alone are measured")
  return()
endif()

if(NOT CMAKE_CUDA_ARCHITECTURES)
  include(TouchstoneArchitectures)
  execute_process(COMMAND ${CMAKE_CUDA_COMPILER} --list-gpu-code OUTPUT_VARIABLE touchstone_codes OUTPUT_STRIP_TRAILING_WHITESPACE
                  ERROR_QUIET)
  # This machine's cards, else the usual ones. (`native` is an error where there is no card, or one that nvcc does not know.)
  execute_process(COMMAND nvidia-smi --query-gpu=compute_cap --format=csv,noheader OUTPUT_VARIABLE touchstone_cards
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE touchstone_no_card)
  if(touchstone_no_card STREQUAL "0" AND touchstone_cards MATCHES "^[0-9.\n]+$")
    string(REPLACE "." "" touchstone_wanted "${touchstone_cards}")
    string(REPLACE "\n" ";" touchstone_wanted "${touchstone_wanted}")
  elseif(DEFINED ENV{CI})
    set(touchstone_wanted 90)
  else()
    set(touchstone_wanted 75 80 86 90 100 120)
  endif()
  touchstone_architectures(touchstone_chosen "${touchstone_wanted}" "${touchstone_codes}")
  if(NOT touchstone_chosen)
    set(TOUCHSTONE_WHY_NO_CUDA "${CMAKE_CUDA_COMPILER} builds for none of this machine's cards (sm_${touchstone_wanted})")
    if(TOUCHSTONE_CUDA STREQUAL "ON")
      message(FATAL_ERROR "TOUCHSTONE_CUDA=ON, but ${TOUCHSTONE_WHY_NO_CUDA}: use another CUDA toolkit, or OFF")
    endif()
    message(STATUS "No GPU kernels: ${TOUCHSTONE_WHY_NO_CUDA}")
    return()
  endif()
  set(CMAKE_CUDA_ARCHITECTURES ${touchstone_chosen} CACHE STRING "GPU architectures" FORCE)
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

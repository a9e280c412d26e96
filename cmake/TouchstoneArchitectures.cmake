# Which GPUs to build for. Toolkits differ: 12.8 brought compute capability 10.0 and 12.0, 13.0 dropped all below 7.5. So the
# compiler is asked.

# OUT: those of WANTED (two or three digits: 90 for compute capability 9.0) that nvcc offers in CODES (the output of
# `nvcc --list-gpu-code`: "sm_75\nsm_80…"), in WANTED's order and without repetition; as CMAKE_CUDA_ARCHITECTURES takes them, with
# machine code alone for all but the last, whose PTX serves later cards too. All of WANTED if CODES is empty.
function(touchstone_architectures out wanted codes)
  set(chosen "")
  foreach(architecture IN LISTS wanted)
    if(codes STREQUAL "" OR "\n${codes}\n" MATCHES "\nsm_${architecture}\n")
      list(APPEND chosen ${architecture})
    endif()
  endforeach()
  list(REMOVE_DUPLICATES chosen)
  list(TRANSFORM chosen APPEND "-real")
  string(REGEX REPLACE "-real$" "" chosen "${chosen}")
  set(${out} "${chosen}" PARENT_SCOPE)
endfunction()

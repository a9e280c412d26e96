# TOUCHSTONE_PEERS=ON where it cannot be had stops the configuration with one sentence that says what to do.
# cmake -DSOURCE=… -DFOLDER=… -DCUDA=ON|OFF -P peers_configure_test.cmake; CUDA=ON: nvcc is there, but no peer is
file(REMOVE_RECURSE ${FOLDER})
execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${FOLDER} -DTOUCHSTONE_PEERS=ON -DTOUCHSTONE_CUDA=${CUDA} -DBUILD_TESTING=OFF
                        -DCMAKE_CUDA_ARCHITECTURES=90 -DCMAKE_DISABLE_FIND_PACKAGE_ArborX=ON -DCMAKE_DISABLE_FIND_PACKAGE_cuNSearch=ON
                RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE err)
file(REMOVE_RECURSE ${FOLDER})
string(REGEX REPLACE "[ \n]+" " " said "${out} ${err}")  # CMake breaks lines

function(expect text)
  string(FIND "${said}" "${text}" at)
  if(at EQUAL -1)
    message(SEND_ERROR "not said: ${text}\nbut: ${said}")
  endif()
endfunction()

if(code EQUAL 0)
  message(SEND_ERROR "it was configured without any peer")
endif()
if(CUDA)
  expect("-- Peer ArborX: not found (set ArborX_ROOT or CMAKE_PREFIX_PATH to where ArborX 2 or later is installed)")
  expect("-- Peer cuNSearch: not found (set cuNSearch_ROOT or CMAKE_PREFIX_PATH to where it is installed)")
  expect("TOUCHSTONE_PEERS=ON, but no peer was found: install ArborX 2 with a CUDA-enabled Kokkos, or cuNSearch (docs/peers.md), and name the folder in CMAKE_PREFIX_PATH; or configure with TOUCHSTONE_PEERS=OFF")
else()
  expect("TOUCHSTONE_PEERS=ON compares GPU detectors, but this build has no CUDA: it was configured with TOUCHSTONE_CUDA=OFF")
endif()

# One interface target carries what every target of ours is compiled with; what is not for the build alone is exported.
add_library(touchstone_options INTERFACE)
target_include_directories(touchstone_options INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>)
target_compile_features(touchstone_options INTERFACE cxx_std_20)

# in_contact() must round every operation: a contraction to FMA changes the contact set (design.md, "Contact"). It is an inline
# function, so programs that use an installed Touchstone need the flag too.
target_compile_options(touchstone_options INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-ffp-contract=off>
  $<INSTALL_INTERFACE:$<$<COMPILE_LANG_AND_ID:CUDA,NVIDIA>:-Xcompiler=-ffp-contract=off>>
  $<BUILD_INTERFACE:$<$<COMPILE_LANGUAGE:CXX>:-Wall$<SEMICOLON>-Wextra$<SEMICOLON>-Wshadow>>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # "a" + std::string: false alarm in the library's own inlined code (GCC bug 105651, mended in 13).
  target_compile_options(touchstone_options INTERFACE $<BUILD_INTERFACE:$<$<COMPILE_LANGUAGE:CXX>:-Wno-restrict>>)
endif()

if(TOUCHSTONE_SANITIZE STREQUAL "address")
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fsanitize=address,undefined> $<$<COMPILE_LANGUAGE:CXX>:-fno-sanitize-recover=all>
                      $<$<COMPILE_LANGUAGE:CXX>:-O1> $<$<COMPILE_LANGUAGE:CXX>:-g1>)
  add_link_options(-fsanitize=address,undefined)
elseif(TOUCHSTONE_SANITIZE STREQUAL "thread")
  # -O1, not -O0: at -O0 g++ 12 missed a race (design.md).
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fsanitize=thread> $<$<COMPILE_LANGUAGE:CXX>:-O1> $<$<COMPILE_LANGUAGE:CXX>:-g1>)
  add_link_options(-fsanitize=thread)
elseif(TOUCHSTONE_SANITIZE)
  message(FATAL_ERROR "TOUCHSTONE_SANITIZE=${TOUCHSTONE_SANITIZE}: use address or thread")
elseif(TOUCHSTONE_MARCH)
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-march=${TOUCHSTONE_MARCH}>)
endif()

if(TOUCHSTONE_STATIC)
  add_link_options(-static-libstdc++ -static-libgcc)
  set(CMAKE_FIND_LIBRARY_SUFFIXES .a .so)
endif()

# Finds an installed cuNSearch, which brings no CMake package: cuNSearch::cuNSearch, cuNSearch_LIBRARY, and cuNSearch_PRECISION
# ("single" or "double": its headers do not say which the library was built with, and the wrong one does not link).
find_path(cuNSearch_INCLUDE_DIR cuNSearch.h)
find_library(cuNSearch_LIBRARY NAMES cuNSearch)
set(cuNSearch_WHY_NOT "")

if(cuNSearch_INCLUDE_DIR AND cuNSearch_LIBRARY)
  include(CheckCXXSourceCompiles)
  set(CMAKE_REQUIRED_INCLUDES ${cuNSearch_INCLUDE_DIR})
  set(CMAKE_REQUIRED_LIBRARIES ${cuNSearch_LIBRARY} CUDA::cudart_static)
  set(CMAKE_REQUIRED_QUIET TRUE)
  set(source "#include <cuNSearch.h>
              int main() { cuNSearch::NeighborhoodSearch search(1); return static_cast<int>(search.n_point_sets()); }")
  check_cxx_source_compiles("${source}" cuNSearch_LINKS_SINGLE)
  if(cuNSearch_LINKS_SINGLE)
    set(cuNSearch_PRECISION single)
  else()
    set(CMAKE_REQUIRED_DEFINITIONS -DCUNSEARCH_USE_DOUBLE_PRECISION)
    check_cxx_source_compiles("${source}" cuNSearch_LINKS_DOUBLE)
    if(cuNSearch_LINKS_DOUBLE)
      set(cuNSearch_PRECISION double)
    else()
      set(cuNSearch_WHY_NOT "; ${cuNSearch_LIBRARY} is there, but a program does not link to it")
    endif()
  endif()
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(cuNSearch REQUIRED_VARS cuNSearch_LIBRARY cuNSearch_INCLUDE_DIR cuNSearch_PRECISION)

if(cuNSearch_FOUND AND NOT TARGET cuNSearch::cuNSearch)
  add_library(cuNSearch::cuNSearch UNKNOWN IMPORTED)
  set_target_properties(cuNSearch::cuNSearch PROPERTIES
    IMPORTED_LOCATION ${cuNSearch_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${cuNSearch_INCLUDE_DIR}
    INTERFACE_LINK_LIBRARIES CUDA::cudart_static)
  if(cuNSearch_PRECISION STREQUAL "double")
    set_property(TARGET cuNSearch::cuNSearch PROPERTY INTERFACE_COMPILE_DEFINITIONS CUNSEARCH_USE_DOUBLE_PRECISION)
  endif()
endif()

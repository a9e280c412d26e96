# `cmake --install BUILD --prefix DIR --component touchstone`, then elsewhere
#   find_package(touchstone COMPONENTS reference|kernels)
# touchstone::reference holds the CPU detectors, packings and detect_completely(); touchstone::kernels (built with nvcc) the
# same and the GPU detectors. A program links one of the two: each has its own Stream (kernels/device.h).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

if(TOUCHSTONE_HAVE_CUDA)
  set(host_seam touchstone_host)  # detect_completely() for programs without CUDA
  add_library(touchstone_host STATIC kernels/detection.cpp)
  target_link_libraries(touchstone_host PUBLIC touchstone_options touchstone_reference)
  target_compile_definitions(touchstone_host PUBLIC TOUCHSTONE_NO_CUDA)
  set_target_properties(touchstone_device PROPERTIES EXPORT_NAME kernels)
else()
  set(host_seam touchstone_device)
endif()
set_target_properties(${host_seam} PROPERTIES EXPORT_NAME reference)
set_target_properties(touchstone_reference PROPERTIES EXPORT_NAME cpu_detectors)
set_target_properties(touchstone_datasets PROPERTIES EXPORT_NAME datasets)
set_target_properties(touchstone_options PROPERTIES EXPORT_NAME options)

# Linking both is an error of CMake's at configure time, not of the linker's, or worse.
foreach(seam IN ITEMS ${host_seam} touchstone_device)
  set_target_properties(${seam} PROPERTIES INTERFACE_touchstone_seam ${seam} COMPATIBLE_INTERFACE_STRING touchstone_seam)
endforeach()

# Headers keep the paths they have in this tree, below a folder of their own.
set(headers ${CMAKE_INSTALL_INCLUDEDIR}/touchstone-${PROJECT_VERSION_MAJOR})
target_include_directories(touchstone_options INTERFACE $<INSTALL_INTERFACE:${headers}>)
install(DIRECTORY include/touchstone DESTINATION ${headers} COMPONENT touchstone)
install(FILES kernels/detection.h kernels/device.h DESTINATION ${headers}/kernels COMPONENT touchstone)
install(FILES reference_cpu/all_pairs.h reference_cpu/count_and_hash.h DESTINATION ${headers}/reference_cpu COMPONENT touchstone)
install(FILES datasets/files.h datasets/formats.h datasets/loose.h datasets/simulation_box.h
        datasets/source_tree.h datasets/spec.h datasets/store.h
        DESTINATION ${headers}/datasets COMPONENT touchstone)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/touchstone)
install(TARGETS touchstone_options touchstone_datasets touchstone_reference ${host_seam} EXPORT touchstone-reference
        ARCHIVE COMPONENT touchstone)
install(EXPORT touchstone-reference NAMESPACE touchstone:: DESTINATION ${package} COMPONENT touchstone)
if(TOUCHSTONE_HAVE_CUDA)
  install(TARGETS touchstone_device EXPORT touchstone-kernels ARCHIVE COMPONENT touchstone)
  install(EXPORT touchstone-kernels NAMESPACE touchstone:: DESTINATION ${package} COMPONENT touchstone)
endif()
configure_package_config_file(cmake/touchstone-config.cmake.in touchstone-config.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(touchstone-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/touchstone-config.cmake ${PROJECT_BINARY_DIR}/touchstone-config-version.cmake
        DESTINATION ${package} COMPONENT touchstone)

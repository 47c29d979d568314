# What `cmake --install` lays down: program, libraries for both instruction sets, headers, inputs
# and the package that find_package(mpmsolve) finds. Nothing knows where it lies: it may be moved.
include(CMakePackageConfigHelpers)

set(MPM_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/mpmsolve)
set(MPM_FAST_DIR glibc-hwcaps/x86-64-v3)  # beside the plain libraries; the loader looks there first
set(MPM_LIBRARIES mpm_physics mpm_partition mpm_solver)

# Libraries outside the project, such as a PETSc of one's own, are found where they were.
function(mpm_install_rpath target)
  set_target_properties(${target} PROPERTIES
    INSTALL_RPATH "${ARGN}" INSTALL_RPATH_USE_LINK_PATH ON)
endfunction()

file(RELATIVE_PATH from_program_to_libraries
  ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
mpm_install_rpath(mpmsolve $ORIGIN/${from_program_to_libraries})
install(TARGETS mpmsolve DESTINATION ${CMAKE_INSTALL_BINDIR})

foreach(library ${MPM_LIBRARIES})
  string(REPLACE mpm_ "" name ${library})
  set_target_properties(${library} PROPERTIES EXPORT_NAME ${name})
  mpm_install_rpath(${library} $ORIGIN)
  install(TARGETS ${library} EXPORT mpmsolve DESTINATION ${CMAKE_INSTALL_LIBDIR})
  if(has_fast_variant)
    mpm_install_rpath(${library}_v3 $ORIGIN $ORIGIN/../..)
    install(TARGETS ${library}_v3 DESTINATION ${CMAKE_INSTALL_LIBDIR}/${MPM_FAST_DIR})
  endif()
endforeach()

install(DIRECTORY include/mpm DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY input DESTINATION ${CMAKE_INSTALL_DATADIR}/mpmsolve)

configure_package_config_file(cmake/mpmsolveConfig.cmake.in ${CMAKE_BINARY_DIR}/mpmsolveConfig.cmake
  INSTALL_DESTINATION ${MPM_PACKAGE_DIR})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/mpmsolveConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)  # before 1.0 a minor version may change the interface
install(FILES
  ${CMAKE_BINARY_DIR}/mpmsolveConfig.cmake ${CMAKE_BINARY_DIR}/mpmsolveConfigVersion.cmake
  DESTINATION ${MPM_PACKAGE_DIR})
install(EXPORT mpmsolve NAMESPACE mpmsolve:: FILE mpmsolveTargets.cmake
  DESTINATION ${MPM_PACKAGE_DIR})

# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# What `cmake --install` lays down for programs that use the libraries: one static library per module
# with its headers, and the package `sgs` for find_package(). Included after the last module.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

get_property(modules GLOBAL PROPERTY SGS_MODULES)
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/sgs")

# sgs::sgs is what docs/library.md describes; further modules (sgs::mesh, sgs::viewer, ...) are linked
# by their names.
add_library(sgs_library INTERFACE)
target_link_libraries(sgs_library INTERFACE sgs_run)
add_library(sgs::sgs ALIAS sgs_library)
set_target_properties(sgs_library PROPERTIES EXPORT_NAME sgs)
set_target_properties(sgs_options PROPERTIES EXPORT_NAME options)

list(TRANSFORM modules PREPEND "sgs_" OUTPUT_VARIABLE module_targets)
install(TARGETS ${module_targets} sgs_library sgs_options EXPORT sgs-targets
        ARCHIVE INCLUDES DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(EXPORT sgs-targets NAMESPACE sgs:: DESTINATION "${package_dir}")

# Headers of sources (kernels, the server's connections) stay at home.
foreach(module IN LISTS modules)
  install(DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}/${module}"
          DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/sgs"
          FILES_MATCHING PATTERN "*.h" PATTERN "*-inl.h" EXCLUDE PATTERN "viewer/net" EXCLUDE
          PATTERN "test_*.h" EXCLUDE)
endforeach()

configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/sgs-config.cmake.in"
                              "${CMAKE_CURRENT_BINARY_DIR}/sgs-config.cmake"
                              INSTALL_DESTINATION "${package_dir}")
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/sgs-config-version.cmake"
                                 COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/sgs-config.cmake"
              "${CMAKE_CURRENT_BINARY_DIR}/sgs-config-version.cmake"
              "${PROJECT_SOURCE_DIR}/cmake/SgsThirdParty.cmake"
        DESTINATION "${package_dir}")

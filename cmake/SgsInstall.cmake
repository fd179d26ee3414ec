# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# What `cmake --install` lays down. By component:
#   sgs       the program
#   libsgs0   the shared library, for programs that run
#   libsgs-dev  its headers, sgs.pc and the package `sgs` for find_package(), for programs that are built
#   modules   one static library per module with its headers, for programs that change the inside
# Included after the last module.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/sgs")

# libsgs.
install(TARGETS sgs_shared EXPORT sgs-targets
        LIBRARY COMPONENT libsgs0 NAMELINK_COMPONENT libsgs-dev
        INCLUDES DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(EXPORT sgs-targets NAMESPACE sgs:: DESTINATION "${package_dir}" COMPONENT libsgs-dev)
install(DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}/api"
        DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/sgs" COMPONENT libsgs-dev
        FILES_MATCHING PATTERN "*.h" PATTERN "internal" EXCLUDE)

configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/sgs-config.cmake.in"
                              "${CMAKE_CURRENT_BINARY_DIR}/sgs-config.cmake"
                              INSTALL_DESTINATION "${package_dir}")
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/sgs-config-version.cmake"
                                 COMPATIBILITY SameMinorVersion)
# The folder is found from where the file lies: a prefix may be moved.
file(RELATIVE_PATH up "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
configure_file("${PROJECT_SOURCE_DIR}/cmake/sgs.pc.in" "${CMAKE_CURRENT_BINARY_DIR}/sgs.pc" @ONLY)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/sgs-config.cmake"
              "${CMAKE_CURRENT_BINARY_DIR}/sgs-config-version.cmake"
        DESTINATION "${package_dir}" COMPONENT libsgs-dev)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/sgs.pc"
        DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT libsgs-dev)

# The modules. sgs::modules is what a run needs; further ones (sgs::mesh, sgs::viewer, ...) are linked
# by their names.
get_property(modules GLOBAL PROPERTY SGS_MODULES)
list(REMOVE_ITEM modules api)
add_library(sgs_modules INTERFACE)
target_link_libraries(sgs_modules INTERFACE sgs_run)
set_target_properties(sgs_modules PROPERTIES EXPORT_NAME modules)
set_target_properties(sgs_options PROPERTIES EXPORT_NAME options)

list(TRANSFORM modules PREPEND "sgs_" OUTPUT_VARIABLE module_targets)
install(TARGETS ${module_targets} sgs_modules sgs_options EXPORT sgs-modules
        ARCHIVE COMPONENT modules INCLUDES DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(EXPORT sgs-modules NAMESPACE sgs:: DESTINATION "${package_dir}" COMPONENT modules)
install(FILES "${PROJECT_SOURCE_DIR}/cmake/SgsThirdParty.cmake"
        DESTINATION "${package_dir}" COMPONENT modules)

# Headers of sources (kernels, the server's connections) stay at home.
foreach(module IN LISTS modules)
  install(DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}/${module}"
          DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/sgs" COMPONENT modules
          FILES_MATCHING PATTERN "*.h" PATTERN "*-inl.h" EXCLUDE PATTERN "viewer/net" EXCLUDE
          PATTERN "test_*.h" EXCLUDE)
endforeach()

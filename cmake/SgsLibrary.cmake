# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# libsgs: the one shared library that programs link (docs/library.md). It consists of the objects of
# the module `api` and, out of the static libraries of the other modules, what these need: nothing is
# compiled twice. What it does not show is bound inside, so calls are as direct as in a program.
set(script "${PROJECT_SOURCE_DIR}/cmake/libsgs.map")
add_library(sgs_shared SHARED $<TARGET_OBJECTS:sgs_api>)
target_link_libraries(sgs_shared PRIVATE sgs_report sgs_run sgs_eval sgs_slam)
target_include_directories(sgs_shared INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>)
target_link_options(sgs_shared PRIVATE "-Wl,--version-script,${script}" -Wl,--as-needed)
if(NOT SGS_SANITIZE)
  target_link_options(sgs_shared PRIVATE -Wl,--no-undefined)
endif()
# The number in libsgs.so.0 rises when a program that was built with an older one could break.
set_target_properties(sgs_shared PROPERTIES
  OUTPUT_NAME sgs EXPORT_NAME sgs VERSION ${PROJECT_VERSION} SOVERSION 0
  LINK_DEPENDS "${script}" LINKER_LANGUAGE CXX)
add_library(sgs::sgs ALIAS sgs_shared)

# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# Cyclone DDS is optional: where it and its compiler of types are found, SGS_WITH_DDS is on. Only two
# programs link it (apps/ros2), no library.
find_package(CycloneDDS 0.10 QUIET)
find_program(SGS_IDLC idlc)
mark_as_advanced(SGS_IDLC)
set(SGS_WITH_DDS OFF)
if(CycloneDDS_FOUND AND SGS_IDLC)
  set(SGS_WITH_DDS ON)
  enable_language(C)  # of what the compiler makes
else()
  message(STATUS "Without ROS 2: cyclonedds-dev and cyclonedds-tools are not installed")
endif()

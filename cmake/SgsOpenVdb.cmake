# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# OpenVDB is optional: where it is found, SGS_WITH_OPENVDB is on and the target sgs_openvdb exists.
# (Debian ships OpenVDB's own find modules, but they fail without packages that we do not need.)
find_path(SGS_OPENVDB_INCLUDE openvdb/openvdb.h)
find_library(SGS_OPENVDB_LIBRARY openvdb)
find_library(SGS_TBB_LIBRARY tbb)
find_library(SGS_IMATH_LIBRARY NAMES Imath Imath-3_1 Half)
mark_as_advanced(SGS_OPENVDB_INCLUDE SGS_OPENVDB_LIBRARY SGS_TBB_LIBRARY SGS_IMATH_LIBRARY)

set(SGS_WITH_OPENVDB OFF)
if(SGS_OPENVDB_INCLUDE AND SGS_OPENVDB_LIBRARY AND SGS_TBB_LIBRARY AND SGS_IMATH_LIBRARY)
  set(SGS_WITH_OPENVDB ON)
  add_library(sgs_openvdb INTERFACE)
  target_include_directories(sgs_openvdb SYSTEM INTERFACE "${SGS_OPENVDB_INCLUDE}")
  target_link_libraries(sgs_openvdb INTERFACE ${SGS_OPENVDB_LIBRARY} ${SGS_TBB_LIBRARY}
                                              ${SGS_IMATH_LIBRARY})
endif()

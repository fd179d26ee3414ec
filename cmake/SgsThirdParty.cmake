# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# The third-party packages of the libraries. The build includes this file, and so does the installed
# package (sgs-config.cmake), because static libraries hand their dependencies on to the program.
# Their targets are imported: the compiler takes their headers as SYSTEM, our warnings are errors and
# theirs are silent.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(tl-expected REQUIRED)
find_package(OpenCV 4 REQUIRED COMPONENTS core imgproc features2d calib3d videoio)
find_package(nlohmann_json REQUIRED)
find_package(nanoflann REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(hwy REQUIRED)
find_package(ZLIB REQUIRED)
find_package(PNG REQUIRED)
find_package(JPEG REQUIRED)
find_package(BZip2 REQUIRED)
find_package(SQLite3 REQUIRED)
find_package(yaml-cpp REQUIRED)

if(NOT TARGET sgs_opencv)
  add_library(sgs_opencv INTERFACE IMPORTED)
  target_include_directories(sgs_opencv INTERFACE ${OpenCV_INCLUDE_DIRS})
  target_link_libraries(sgs_opencv INTERFACE opencv_core opencv_imgproc opencv_features2d
                                             opencv_calib3d)
endif()

# Chunks of recordings: bz2, lz4 and zstd; the latter two come without CMake packages in Debian 12.
find_path(SGS_LZ4_INCLUDE lz4frame.h REQUIRED)
find_library(SGS_LZ4_LIBRARY lz4 REQUIRED)
find_path(SGS_ZSTD_INCLUDE zstd.h REQUIRED)
find_library(SGS_ZSTD_LIBRARY zstd REQUIRED)
mark_as_advanced(SGS_LZ4_INCLUDE SGS_LZ4_LIBRARY SGS_ZSTD_INCLUDE SGS_ZSTD_LIBRARY)
if(NOT TARGET sgs_unpackers)
  add_library(sgs_zstd INTERFACE IMPORTED)  # for splats, too
  target_include_directories(sgs_zstd INTERFACE "${SGS_ZSTD_INCLUDE}")
  target_link_libraries(sgs_zstd INTERFACE ${SGS_ZSTD_LIBRARY})
  add_library(sgs_unpackers INTERFACE IMPORTED)
  target_include_directories(sgs_unpackers INTERFACE "${SGS_LZ4_INCLUDE}")
  target_link_libraries(sgs_unpackers INTERFACE BZip2::BZip2 ${SGS_LZ4_LIBRARY} sgs_zstd)
endif()

# Inflates PNGs; without a CMake package in Debian 12, too.
find_path(SGS_DEFLATE_INCLUDE libdeflate.h REQUIRED)
find_library(SGS_DEFLATE_LIBRARY deflate REQUIRED)
mark_as_advanced(SGS_DEFLATE_INCLUDE SGS_DEFLATE_LIBRARY)
if(NOT TARGET sgs_deflate)
  add_library(sgs_deflate INTERFACE IMPORTED)
  target_include_directories(sgs_deflate INTERFACE "${SGS_DEFLATE_INCLUDE}")
  target_link_libraries(sgs_deflate INTERFACE ${SGS_DEFLATE_LIBRARY})
endif()

# OctoMap is optional: where it is found, SGS_WITH_OCTOMAP is on and the target sgs_octomap exists.
find_path(SGS_OCTOMAP_INCLUDE octomap/octomap.h)
find_library(SGS_OCTOMAP_LIBRARY octomap)
find_library(SGS_OCTOMATH_LIBRARY octomath)
mark_as_advanced(SGS_OCTOMAP_INCLUDE SGS_OCTOMAP_LIBRARY SGS_OCTOMATH_LIBRARY)
set(SGS_WITH_OCTOMAP OFF)
if(SGS_OCTOMAP_INCLUDE AND SGS_OCTOMAP_LIBRARY AND SGS_OCTOMATH_LIBRARY)
  set(SGS_WITH_OCTOMAP ON)
  if(NOT TARGET sgs_octomap)
    add_library(sgs_octomap INTERFACE IMPORTED)
    target_include_directories(sgs_octomap INTERFACE "${SGS_OCTOMAP_INCLUDE}")
    target_link_libraries(sgs_octomap INTERFACE ${SGS_OCTOMAP_LIBRARY} ${SGS_OCTOMATH_LIBRARY})
  endif()
endif()

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
  if(NOT TARGET sgs_openvdb)
    add_library(sgs_openvdb INTERFACE IMPORTED)
    target_include_directories(sgs_openvdb INTERFACE "${SGS_OPENVDB_INCLUDE}")
    target_link_libraries(sgs_openvdb INTERFACE ${SGS_OPENVDB_LIBRARY} ${SGS_TBB_LIBRARY}
                                                ${SGS_IMATH_LIBRARY})
  endif()
endif()

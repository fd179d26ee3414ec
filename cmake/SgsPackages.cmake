# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# The Debian packages: `cpack` in the build folder, or scripts/build_packages.sh. One for each component
# of SgsInstall.cmake but the modules; what each depends on, dpkg-shlibdeps finds out.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # packages are made of what is built
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME sgs)
set(CPACK_PACKAGE_CONTACT "The Spectral GS-SLAM authors <maintainers@users.noreply.h-seed-0502a242.example>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL sgs sgs-video sgs-cameras sgs-ros1 libsgs0 libsgs-dev)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
# Where the build has left libsgs: dpkg-shlibdeps looks for what the Python module links.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${PROJECT_BINARY_DIR}/src/sgs")

set(CPACK_DEBIAN_SGS_PACKAGE_NAME sgs)
set(CPACK_DEBIAN_SGS_PACKAGE_SECTION science)
set(CPACK_COMPONENT_SGS_DESCRIPTION
    "RGB-D SLAM on CPUs: the program sgs\n Tracks an RGB-D camera and builds a photorealistic 3D Gaussian map.")
# Apart, because the encoders bring over a hundred libraries. Reading .mkv files brings as many: their
# library, of the version of the headers, is opened at run time.
file(STRINGS "${SGS_AVFORMAT_INCLUDE}/libavformat/version_major.h" avformat
     REGEX "define LIBAVFORMAT_VERSION_MAJOR")
string(REGEX MATCH "[0-9]+" avformat "${avformat}")
set(CPACK_DEBIAN_SGS_PACKAGE_RECOMMENDS "sgs-video, sgs-cameras, libavformat${avformat}")
set(CPACK_DEBIAN_LIBSGS0_PACKAGE_RECOMMENDS "libavformat${avformat}")
set(CPACK_DEBIAN_SGS-VIDEO_PACKAGE_NAME sgs-video)
set(CPACK_DEBIAN_SGS-VIDEO_PACKAGE_SECTION science)
set(CPACK_DEBIAN_SGS-VIDEO_PACKAGE_DEPENDS "sgs (= ${PROJECT_VERSION})")
set(CPACK_COMPONENT_SGS-VIDEO_DESCRIPTION
    "RGB-D SLAM on CPUs: videos\n What `sgs render --video` starts.")
# Without any SDK: they are opened at run time.
set(CPACK_DEBIAN_SGS-CAMERAS_PACKAGE_NAME sgs-cameras)
set(CPACK_DEBIAN_SGS-CAMERAS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_SGS-CAMERAS_PACKAGE_DEPENDS "sgs (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_SGS-CAMERAS_PACKAGE_SUGGESTS "python3-numpy")  # of the scripts in share/sgs/cameras
set(CPACK_COMPONENT_SGS-CAMERAS_DESCRIPTION
    "RGB-D SLAM on CPUs: cameras\n What `sgs run camera:` starts, and who may open cameras (udev rules).")
# Scripts, for whoever has ROS 1.
set(CPACK_DEBIAN_SGS-ROS1_PACKAGE_NAME sgs-ros1)
set(CPACK_DEBIAN_SGS-ROS1_PACKAGE_SECTION science)
set(CPACK_DEBIAN_SGS-ROS1_PACKAGE_DEPENDS
    "sgs (= ${PROJECT_VERSION}), python3, python3-numpy, python3-rospy, python3-geometry-msgs, python3-nav-msgs, python3-sensor-msgs, python3-tf2-msgs")
set(CPACK_COMPONENT_SGS-ROS1_DESCRIPTION
    "RGB-D SLAM on CPUs: ROS 1\n What `sgs run camera:ros1` and `--ros1` start.")
set(CPACK_DEBIAN_LIBSGS0_PACKAGE_NAME libsgs0)
set(CPACK_DEBIAN_LIBSGS0_PACKAGE_SECTION libs)
set(CPACK_COMPONENT_LIBSGS0_DESCRIPTION
    "RGB-D SLAM on CPUs: the shared library\n For programs that feed frames and read poses and maps.")
set(CPACK_DEBIAN_LIBSGS-DEV_PACKAGE_NAME libsgs-dev)
set(CPACK_DEBIAN_LIBSGS-DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBSGS-DEV_PACKAGE_DEPENDS "libsgs0 (= ${PROJECT_VERSION})")
set(CPACK_COMPONENT_LIBSGS-DEV_DESCRIPTION
    "RGB-D SLAM on CPUs: headers\n For building programs with libsgs by CMake or pkg-config.")
if(SGS_WITH_OPENVDB)
  # Apart, because OpenVDB weighs more than everything else.
  list(APPEND CPACK_COMPONENTS_ALL sgs-mesh)
  string(APPEND CPACK_DEBIAN_SGS_PACKAGE_RECOMMENDS ", sgs-mesh")
  set(CPACK_DEBIAN_SGS-MESH_PACKAGE_NAME sgs-mesh)
  set(CPACK_DEBIAN_SGS-MESH_PACKAGE_SECTION science)
  set(CPACK_DEBIAN_SGS-MESH_PACKAGE_DEPENDS "sgs (= ${PROJECT_VERSION})")
  set(CPACK_COMPONENT_SGS-MESH_DESCRIPTION
      "RGB-D SLAM on CPUs: meshes\n What `sgs export RUN mesh` and `esdf` start.")
endif()
if(SGS_WITH_DDS)
  # Apart, because it brings DDS, which few need.
  list(APPEND CPACK_COMPONENTS_ALL sgs-ros2)
  set(CPACK_DEBIAN_SGS-ROS2_PACKAGE_NAME sgs-ros2)
  set(CPACK_DEBIAN_SGS-ROS2_PACKAGE_SECTION science)
  set(CPACK_DEBIAN_SGS-ROS2_PACKAGE_DEPENDS "sgs (= ${PROJECT_VERSION})")
  set(CPACK_COMPONENT_SGS-ROS2_DESCRIPTION
      "RGB-D SLAM on CPUs: ROS 2\n What `sgs run camera:ros2` and `--ros2` start; needs no ROS.")
endif()
if(SGS_BUILD_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python3-sgs)
  set(CPACK_DEBIAN_PYTHON3-SGS_PACKAGE_NAME python3-sgs)
  set(CPACK_DEBIAN_PYTHON3-SGS_PACKAGE_SECTION python)
  # The module is made for one minor version of Python.
  math(EXPR next "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON3-SGS_PACKAGE_DEPENDS
      "libsgs0 (= ${PROJECT_VERSION}), python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${next}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON3-SGS_PACKAGE_CONTROL_EXTRA "${PROJECT_SOURCE_DIR}/packaging/postinst;${PROJECT_SOURCE_DIR}/packaging/prerm")
  set(CPACK_COMPONENT_PYTHON3-SGS_DESCRIPTION
      "RGB-D SLAM on CPUs: Python package\n Feed numpy frames, read poses and maps.")
endif()
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION share/doc/${component} RENAME copyright
          COMPONENT ${component})
endforeach()
include(CPack)

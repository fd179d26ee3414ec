# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0

# With SGS_UNITE, compiles a target's sources a few at a time: most of the time goes into headers
# (Eigen, OpenCV, CLI11, Boost), which each source would read again. Sources compiled once per
# instruction set include themselves and stay alone.
function(sgs_unite target)
  if(NOT SGS_UNITE)
    return()
  endif()
  foreach(source ${ARGN})
    file(STRINGS "${source}" dispatched REGEX "hwy/foreach_target.h" LIMIT_COUNT 1)
    if(dispatched)
      set_source_files_properties("${source}" PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    endif()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${SGS_UNITE})
endfunction()

# sgs_add_module(NAME [HARDENED] [DEPS sgs modules...] [LIBS third-party...] [PRIVATE_LIBS third-party...])
#
# One module = one static library `sgs_NAME` made of every *.cc below the module's folder, and one
# test executable `sgs_NAME_test` made of every *_test.cc. DEPS is the module's row of the layer
# table in docs/architecture.md; scripts/check_layers.py holds the #includes to it. HARDENED: it meets
# what others have made (SgsToolchain.cmake).
function(sgs_add_module name)
  cmake_parse_arguments(ARG "HARDENED" "" "DEPS;LIBS;PRIVATE_LIBS" ${ARGN})
  set(dir "${CMAKE_CURRENT_SOURCE_DIR}/${name}")
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${dir}/*.cc")
  set(tests ${sources})
  list(FILTER tests INCLUDE REGEX "_test\\.cc$")
  list(FILTER sources EXCLUDE REGEX "_test\\.cc$")
  list(TRANSFORM ARG_DEPS PREPEND "sgs_")

  if(sources)
    add_library(sgs_${name} STATIC ${sources})
    sgs_unite(sgs_${name} ${sources})
    target_include_directories(sgs_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>)
    target_link_libraries(sgs_${name} PUBLIC ${ARG_DEPS} ${ARG_LIBS} sgs_options
                          PRIVATE $<BUILD_INTERFACE:sgs_warnings> ${ARG_PRIVATE_LIBS})
    if(ARG_HARDENED)
      target_link_libraries(sgs_${name} PRIVATE $<BUILD_INTERFACE:sgs_hardened>)
    endif()
  else()
    add_library(sgs_${name} INTERFACE)
    target_include_directories(sgs_${name} INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>)
    target_link_libraries(sgs_${name} INTERFACE ${ARG_DEPS} ${ARG_LIBS} sgs_options)
  endif()
  add_library(sgs::${name} ALIAS sgs_${name})
  set_target_properties(sgs_${name} PROPERTIES EXPORT_NAME ${name})
  set_property(GLOBAL APPEND PROPERTY SGS_MODULES ${name})

  if(SGS_BUILD_TESTS AND tests)
    add_executable(sgs_${name}_test ${tests})
    sgs_unite(sgs_${name}_test ${tests})
    target_compile_options(sgs_${name}_test PRIVATE -O1)  # they run once: what counts is their build
    target_link_libraries(sgs_${name}_test PRIVATE sgs_${name} sgs_warnings ${ARG_PRIVATE_LIBS}
                                                   GTest::gmock GTest::gtest_main)
    target_compile_definitions(sgs_${name}_test PRIVATE SGS_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    gtest_discover_tests(sgs_${name}_test TEST_PREFIX "${name}." DISCOVERY_TIMEOUT 60
                         PROPERTIES TIMEOUT ${SGS_TEST_TIMEOUT_S})
  endif()
endfunction()

# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# Language level, warnings, sanitizers and third-party packages: what every target shares.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

find_program(SGS_CCACHE ccache)
if(SGS_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${SGS_CCACHE}")
endif()

include(SgsThirdParty)
find_package(CLI11 REQUIRED)  # of programs only

add_library(sgs_warnings INTERFACE)
target_compile_options(sgs_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                                              -Wold-style-cast -Wcast-qual -Woverloaded-virtual
                                              # clang, for fuzzing only, warns of other things
                                              $<$<CXX_COMPILER_ID:GNU>:-Werror>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # GCC 12 reports impossible overlaps inside std::string (GCC bug 105651).
  target_compile_options(sgs_warnings INTERFACE -Wno-restrict)
endif()
if(SGS_SANITIZE)
  # What sanitizers add to std::regex looks uninitialized to GCC (GCC bug 105562).
  target_compile_options(sgs_warnings INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
endif()

add_library(sgs_options INTERFACE)
# One build serves every x86-64: no -march=native. Contraction off keeps results equal across
# compilers that would fuse differently; the dispatched kernels ask for FMA explicitly.
target_compile_options(sgs_options INTERFACE -ffp-contract=off -fno-math-errno)
target_compile_features(sgs_options INTERFACE cxx_std_20)
# What compiler and linker can do about the faults that nobody has found yet; a test looks for it in the
# program (tests/house/hardening_test.py). The compiler's part goes to what meets files, sockets and
# command lines (sgs_hardened); the kernels see numbers only and stay as fast as they are.
include(CheckPIESupported)
check_pie_supported()
add_library(sgs_hardened INTERFACE)
if(NOT SGS_SANITIZE)
  target_compile_options(
    sgs_hardened INTERFACE -fstack-protector-strong
                           "$<$<CONFIG:Release,RelWithDebInfo>:-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=2>")
  target_link_options(sgs_options INTERFACE
                      "$<BUILD_INTERFACE:-Wl,-z,relro,-z,now,-z,noexecstack>")
endif()
if(SGS_SANITIZE)
  target_compile_options(sgs_options INTERFACE -fsanitize=${SGS_SANITIZE} -fno-omit-frame-pointer
                                               -fno-sanitize-recover=all)
  target_link_options(sgs_options INTERFACE -fsanitize=${SGS_SANITIZE})
endif()

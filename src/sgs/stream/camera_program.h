// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/stream/address.h"

// Cameras are read by programs of their own, one for each family (`sgs-camera-realsense`): what an
// SDK does to its process cannot hurt a run, and anybody can write one (docs/cameras.md).
namespace sgs::stream {

/// A program that reads cameras of a family.
struct CameraProgram {
  std::string family;
  std::filesystem::path path;
};

/// Those in $SGS_CAMERA_PROGRAMS, beside this program, and where packages keep them; of a family
/// the first one. By name.
std::vector<CameraProgram> find_camera_programs();

/// A camera that is plugged in.
struct CameraDevice {
  std::string name, serial, firmware, connection;
};

/// What a program says of its family.
struct CameraFamily {
  CameraProgram program;
  std::string library;  ///< file and version of the SDK's library; empty: not found
  std::vector<CameraDevice> devices;
  std::optional<Error> problem;  ///< why there is no library, or no camera
};

/// Asks a program; one that does not answer within ten seconds, or not in JSON, has a problem.
CameraFamily ask_camera_program(const CameraProgram& program);

/// The program and the serial number for an address that may leave out both. Errors: no program, no
/// camera (with each family's reason), several of them.
struct ChosenCamera {
  CameraProgram program;
  std::string serial;  ///< empty: as the address leaves it to the program
};
Result<ChosenCamera> choose_camera(const Address::Camera& camera);

}  // namespace sgs::stream

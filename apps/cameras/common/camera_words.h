// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sgs/capture/camera_driver.h"
#include "sgs/core/error.h"

// What every family says in the same words.
namespace sgs::cameras {

/// Devices of the USB that are cameras of a family.
struct UsbWords {
  std::string vendor;   ///< "8086"
  std::string product;  ///< a word of the product's name; empty: all of the vendor's
};

/// How a family is spoken of.
struct CameraWords {
  std::string family;  ///< "realsense"
  std::string name;    ///< "RealSense camera"
  std::string mode;    ///< another one to ask for: "size=848x480,fps=15"
  std::string slow;    ///< one for USB 2
  std::vector<UsbWords> usb;
  std::string plug_in;  ///< what to do where none is found
};

/// Of cameras that need USB 3.
inline constexpr const char* kPlugIntoUsb3 =
    "plug it into a port of USB 3 (blue, or marked SS), with the cable that came with it";

/// What people can do about a message of a library: a camera in use, one that may not be opened, a
/// mode that it does not have, one that is gone.
Error explained(const std::string& message, const CameraWords& words);

/// Nothing is listed: because nothing is there, or because it may not be opened?
Error nothing_found(const CameraWords& words);

/// Where in the list the camera is that is asked for; the first one where none is.
Result<std::size_t> index_of_camera(const std::vector<std::string>& serials,
                                    const std::string& serial, const CameraWords& words);

/// USB 2 is too slow for the usual mode: an error, or a note where somebody chose the mode. `usb`
/// is the version, "2.1".
Status check_usb(const std::string& usb, const capture::CameraMode& mode, const CameraWords& words,
                 std::vector<std::string>& notes);

}  // namespace sgs::cameras

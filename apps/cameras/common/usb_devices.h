// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace sgs::cameras {

/// A device of the USB as the kernel lists it, whether or not it may be opened.
struct UsbDevice {
  std::string node;  ///< "/dev/bus/usb/002/003"
  bool may_be_opened = false;
};

/// Those of a vendor ("8086") whose product name has this word. Empty where the kernel lists none.
std::vector<UsbDevice> usb_devices(const std::string& vendor, const std::string& word);

}  // namespace sgs::cameras

// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "usb_devices.h"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace sgs::cameras {
namespace {

namespace fs = std::filesystem;

std::string first_line(const fs::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

int number_in(const fs::path& path) {
  std::ifstream file(path);
  int number = 0;
  file >> number;
  return number;
}

}  // namespace

std::vector<UsbDevice> usb_devices(const std::string& vendor, const std::string& word) {
  std::vector<UsbDevice> devices;
  std::error_code error;
  for (auto entry = fs::directory_iterator("/sys/bus/usb/devices", error);
       !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const fs::path& folder = entry->path();
    const std::string name = first_line(folder / "product");
    const bool camera = name.find(word) != std::string::npos;
    if (first_line(folder / "idVendor") != vendor || !camera) continue;
    const std::string node = fmt::format("/dev/bus/usb/{:03}/{:03}", number_in(folder / "busnum"),
                                         number_in(folder / "devnum"));
    devices.push_back({node, ::access(node.c_str(), R_OK | W_OK) == 0});
  }
  return devices;
}

}  // namespace sgs::cameras

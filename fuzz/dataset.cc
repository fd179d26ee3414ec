// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The lists of a recording. Lines `%%N` begin file number N of kFiles; two images are there.
#include <array>

#include "read_sequence.h"
#include "sgs/io/image_io.h"
#include "sgs/io/temporary_folder.h"

namespace {

using namespace sgs;
namespace fs = std::filesystem;

constexpr std::array<const char*, 8> kFiles = {"rgb.txt",         "depth.txt",  "associations.txt",
                                               "groundtruth.txt", "camera.txt", "cam_params.json",
                                               "sgs.toml",        "traj.txt"};

const fs::path& recording() {
  static const io::TemporaryFolder folder;
  static const bool made = [] {
    const ColorImage color(16, 12, {9, 9, 9});
    const DepthImage depth(16, 12, 1.0f);
    for (const char* name : {"1.0.png", "2.0.png"}) {
      if (!io::save_color(folder / "rgb" / name, color)) return false;
      if (!io::save_depth(folder / "depth" / name, depth, 5000)) return false;
    }
    return true;
  }();
  fuzz::require(made, "the recording can be made");
  return folder.path();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  const fs::path& folder = recording();
  for (const char* name : kFiles) fs::remove(folder / name);
  while (rest.starts_with("%%") && rest.size() > 4) {
    const auto number = static_cast<std::size_t>(static_cast<std::uint8_t>(rest[2]));
    rest.remove_prefix(4);
    const auto end = std::min(rest.find("\n%%"), rest.size() - 1) + 1;
    const fs::path file = folder / kFiles[number % kFiles.size()];
    fuzz::write_plainly(file, rest.substr(0, end));
    rest.remove_prefix(std::min(end, rest.size()));
  }
  fuzz::read_sequence(folder);
  return 0;
}

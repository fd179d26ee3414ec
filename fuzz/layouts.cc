// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What the folders of other programs say of their images, and files of poses. The first byte
// chooses the layout; lines `%%N` begin its file number N. Two frames of images are there.
#include <array>
#include <vector>

#include "read_sequence.h"
#include "sgs/io/image_io.h"
#include "sgs/io/temporary_folder.h"

namespace {

using namespace sgs;
namespace fs = std::filesystem;

struct FuzzedLayout {
  const char* name;
  std::array<const char*, 2> color, depth;
  std::vector<const char*> files;
  const char* poses = "recorded";
};

const std::vector<FuzzedLayout>& layouts() {
  static const std::vector<FuzzedLayout> all = {
      {"transforms", {"a.png", "b.png"}, {"c.png", "d.png"}, {"transforms.json"}},
      {"polycam",
       {"keyframes/images/1000.png", "keyframes/images/2000.png"},
       {"keyframes/depth/1000.png", "keyframes/depth/2000.png"},
       {"keyframes/cameras/1000.json", "keyframes/cameras/2000.json"}},
      {"open3d",
       {"color/1.png", "color/2.png"},
       {"depth/1.png", "depth/2.png"},
       {"camera_intrinsic.json", "trajectory.log"}},
      {"scannet",
       {"color/0.png", "color/1.png"},
       {"depth/0.png", "depth/1.png"},
       {"pose/0.txt", "pose/1.txt", "intrinsic/intrinsic_color.txt",
        "intrinsic/intrinsic_depth.txt"}},
      {"seven_scenes",
       {"frame-000000.color.png", "frame-000001.color.png"},
       {"frame-000000.depth.png", "frame-000001.depth.png"},
       {"frame-000000.pose.txt", "frame-000001.pose.txt"}},
      {"arkit",
       {"lowres_wide/1_1.000.png", "lowres_wide/1_2.000.png"},
       {"lowres_depth/1_1.000.png", "lowres_depth/1_2.000.png"},
       {"lowres_wide_intrinsics/1_1.000.pincam", "lowres_wide.traj"}},
      {"sun3d",
       {"image/1-000000000001.png", "image/2-000000033000.png"},
       {"depth/1-000000000001.png", "depth/2-000000033000.png"},
       {"intrinsics.txt", "extrinsics/1.txt"}},
      {"icl",
       {"rgb/0.png", "rgb/1.png"},
       {"depth/0.png", "depth/1.png"},
       {"associations.txt", "room.gt.freiburg"}},
      {"tum_poses",
       {"rgb/1.png", "rgb/2.png"},
       {"depth/1.png", "depth/2.png"},
       {"poses.txt", "associations.txt", "camera.txt"},
       "poses.txt"},
      {"colmap_poses",
       {"rgb/1.png", "rgb/2.png"},
       {"depth/1.png", "depth/2.png"},
       {"images.txt", "associations.txt", "camera.txt"},
       "images.txt"},
  };
  return all;
}

fs::path recording(const FuzzedLayout& layout) {
  static const io::TemporaryFolder folder;
  const fs::path path = folder / layout.name;
  if (fs::exists(path)) return path;
  const ColorImage color(16, 12, {9, 9, 9});
  const DepthImage depth(16, 12, 1.0f);
  for (int i = 0; i < 2; ++i) {
    fuzz::require(io::save_color(path / layout.color[i], color).has_value(), "colour is there");
    fuzz::require(io::save_depth(path / layout.depth[i], depth, 1000).has_value(),
                  "depth is there");
  }
  return path;
}

void write_files(const fs::path& folder, const FuzzedLayout& layout, std::string_view rest) {
  for (const char* name : layout.files) fs::remove(folder / name);
  while (rest.starts_with("%%") && rest.size() > 4) {
    const auto number = static_cast<std::size_t>(static_cast<std::uint8_t>(rest[2]));
    rest.remove_prefix(4);
    const auto end = std::min(rest.find("\n%%"), rest.size() - 1) + 1;
    const fs::path file = folder / layout.files[number % layout.files.size()];
    fuzz::write_plainly(file, rest.substr(0, end));
    rest.remove_prefix(std::min(end, rest.size()));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::Choice choice(data, size);
  const FuzzedLayout& layout = layouts()[choice.number % layouts().size()];
  const fs::path folder = recording(layout);
  write_files(folder, layout, choice.rest);
  const bool own = layout.poses == std::string("recorded");
  fuzz::read_sequence(folder, "");
  fuzz::read_sequence(folder, own ? layout.poses : (folder / layout.poses).string());
  return 0;
}

// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <span>

#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/pairing.h"
#include "sgs/dataset/rigid.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/text.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

/// The poses of all colour images, 3x4 row by row, one below the other.
Result<std::vector<std::optional<SE3>>> sun3d_poses(const fs::path& path) {
  constexpr std::size_t kNumbers = 12;
  SGS_ASSIGN_OR_RETURN(const std::string content, io::read_text(path));
  const auto numbers = io::parse_doubles(content);
  if (!numbers || numbers->empty() || numbers->size() % kNumbers != 0) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: not a list of 3x4 poses", path.string()),
                "remove the file to go without ground truth");
  }
  std::vector<std::optional<SE3>> poses;
  for (std::size_t i = 0; i < numbers->size(); i += kNumbers) {
    poses.push_back(rigid_from_rows(std::span(*numbers).subspan(i, kNumbers)));
  }
  return poses;
}

/// Of several versions the newest, which is the last by name.
fs::path sun3d_truth(const fs::path& folder) {
  const auto files = files_matching(folder / "extrinsics", "*.txt");
  return files.empty() ? fs::path() : files.back();
}

}  // namespace

bool looks_like_sun3d(const fs::path& folder) {
  return fs::is_directory(entry_of(folder, "image")) &&
         fs::is_directory(entry_of(folder, "depth")) &&
         fs::exists(entry_of(folder, "intrinsics.txt"));
}

// SUN3D (Xiao et al., ICCV 2013): image/FRAME-MICROSECONDS.jpg, depth/FRAME-MICROSECONDS.png in
// millimetres with turned bits, intrinsics.txt, extrinsics/*.txt with one pose per picture.
Result<FrameList> list_sun3d(const fs::path& folder) {
  constexpr double kMaxDifference_s = 0.02;
  FrameList out;
  out.layout = "sun3d";
  out.name = folder_name(folder);
  out.folder = folder;
  const auto color = files_with_microseconds(image_files(entry_of(folder, "image")));
  const auto depth = files_with_microseconds(image_files(entry_of(folder, "depth")));
  if (!color || !depth) {
    return fail(
        ErrorCode::kInvalidFormat,
        fmt::format("{}: SUN3D layout, but not all images are named FRAME-MICROSECONDS",
                    folder.string()),
        "for example image/0000001-000000000000.jpg; or describe the folder in an sgs.toml");
  }
  pair_by_time(*color, *depth, kMaxDifference_s, out);
  SGS_RETURN_IF_ERROR(require_frames(out, "image/*.jpg with depth/*.png near in time"));
  out.depth_coding = DepthCoding::kTurnedBits;
  const fs::path intrinsics = entry_of(folder, "intrinsics.txt");
  SGS_ASSIGN_OR_RETURN(const PinholeCamera camera, load_intrinsic_matrix(intrinsics));
  out.calibration = {{camera, {}, 1000}, intrinsics.string()};
  const fs::path truth = sun3d_truth(folder);
  if (truth.empty()) return out;
  const auto read = sun3d_poses(truth);
  if (!read) {
    truth_or_warning(tl::unexpected(read.error()), out);
    return out;
  }
  const auto& poses = *read;
  std::map<fs::path, std::size_t> rows;
  for (std::size_t i = 0; i < color->files.size(); ++i) rows.emplace(color->files[i], i);
  SGS_RETURN_IF_ERROR(add_frame_poses(out, [&](std::size_t i) -> Result<std::optional<SE3>> {
    const std::size_t row = rows.at(out.frames[i].color);
    return row < poses.size() ? poses[row] : std::optional<SE3>{};
  }));
  return out;
}

}  // namespace sgs::dataset

// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/colmap.h"

#include "sgs/io/atomic_file.h"

namespace sgs::io {

Status save_colmap_model(const std::filesystem::path& folder, const PinholeCamera& camera,
                         std::span<const ColmapImage> images,
                         std::span<const ColoredPoint> points) {
  constexpr double kHalfPixel = 0.5;
  std::string text = fmt::format(
      "# Camera list: CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[fx fy cx cy]\n1 PINHOLE {} {} {:.9g} "
      "{:.9g} {:.9g} {:.9g}\n",
      camera.width, camera.height, camera.fx, camera.fy, camera.cx + kHalfPixel,
      camera.cy + kHalfPixel);
  SGS_RETURN_IF_ERROR(write_file(folder / "cameras.txt", text));

  text =
      "# Two lines per image: IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME; then its\n"
      "# points (none).\n";
  int id = 0;
  for (const ColmapImage& image : images) {
    if (image.name.find_first_of(" \t\n") != std::string::npos) {
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("COLMAP image names cannot hold spaces: '{}'", image.name));
    }
    const SE3 T_camera_world = image.T_world_camera.inverse();
    const Eigen::Quaterniond q = T_camera_world.quaternion();
    const Eigen::Vector3d& t = T_camera_world.t;
    text += fmt::format("{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} 1 {}\n\n", ++id, q.w(),
                        q.x(), q.y(), q.z(), t.x(), t.y(), t.z(), image.name);
  }
  SGS_RETURN_IF_ERROR(write_file(folder / "images.txt", text));

  text = "# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] (none)\n";
  id = 0;
  for (const ColoredPoint& p : points) {
    text += fmt::format("{} {:.6f} {:.6f} {:.6f} {} {} {} 0\n", ++id, p.position.x(),
                        p.position.y(), p.position.z(), p.color.r, p.color.g, p.color.b);
  }
  return write_file(folder / "points3D.txt", text);
}

}  // namespace sgs::io

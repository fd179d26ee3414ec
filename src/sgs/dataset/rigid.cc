// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/rigid.h"

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "sgs/io/atomic_file.h"
#include "sgs/io/text.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t kLargestMatrixFile_bytes = 1 << 16;

/// All numbers of a small file; NaN and infinity are among them.
Result<std::vector<double>> load_numbers(const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(const std::string content, io::read_text(path, kLargestMatrixFile_bytes));
  std::vector<double> numbers;
  for (const io::TextLine& line : io::content_lines(content)) {
    for (const auto field : io::split_fields(line.text, ",")) {
      const auto value = io::parse_double(field);
      if (!value) {
        return fail(ErrorCode::kInvalidFormat,
                    fmt::format("{}:{}: '{}' is not a number", path.string(), line.number,
                                field.substr(0, 40)),
                    "correct the file, or take it away");
      }
      numbers.push_back(*value);
    }
  }
  return numbers;
}

}  // namespace

std::optional<SE3> rigid_from_rows(std::span<const double> m) {
  if (m.size() != 12 && m.size() != 16) return std::nullopt;
  SE3 T;
  T.R << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
  T.t << m[3], m[7], m[11];
  constexpr double kRotationTolerance = 1e-2;
  const bool rotation = T.all_finite() && (T.R * T.R.transpose()).isIdentity(kRotationTolerance) &&
                        T.R.determinant() > 0;
  if (!rotation) return std::nullopt;
  return T.normalized();
}

SE3 from_opengl_camera(const SE3& T_world_opengl) {
  const Eigen::DiagonalMatrix<double, 3> axes(1, -1, -1);
  return {T_world_opengl.R * axes, T_world_opengl.t};
}

SE3 from_left_handed(const SE3& T) {
  const Eigen::DiagonalMatrix<double, 3> mirror(1, -1, 1);
  return {mirror * T.R * mirror, mirror * T.t};
}

Result<std::optional<SE3>> load_pose_matrix(const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(const auto numbers, load_numbers(path));
  return rigid_from_rows(numbers);
}

Result<PinholeCamera> load_intrinsic_matrix(const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(const auto m, load_numbers(path));
  const std::size_t columns = m.size() == 16 ? 4 : 3;
  if (m.size() != 9 && m.size() != 16) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: {} numbers where an intrinsic matrix has 9 or 16", path.string(),
                            m.size()),
                "rows 'fx 0 cx', '0 fy cy', '0 0 1'");
  }
  const PinholeCamera camera{0, 0, m[0], m[columns + 1], m[2], m[columns + 2]};
  if (!(camera.fx > 0 && camera.fy > 0) || !std::isfinite(camera.fx + camera.fy + camera.cx) ||
      !std::isfinite(camera.cy)) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: no usable focal lengths or centre", path.string()),
                "give --camera fx,fy,cx,cy");
  }
  return camera;
}

}  // namespace sgs::dataset

// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/drawings.h"

#include "sgs/io/atomic_file.h"

namespace sgs::report {

std::vector<Drawing> all_drawings(Runs runs) {
  std::vector<Drawing> drawings;
  const auto append = [&](std::vector<Drawing> more) {
    for (Drawing& drawing : more) drawings.push_back(std::move(drawing));
  };
  append(trajectory_drawings(runs));
  append(error_drawings(runs));
  if (runs.size() != 1) return drawings;
  append(degeneracy_drawings(runs[0]));
  append(timing_drawings(runs[0]));
  append(map_drawings(runs[0]));
  append(calibration_drawings(runs[0]));
  append(value_drawings(runs[0]));
  return drawings;
}

Result<std::vector<std::filesystem::path>> save_drawings(const std::filesystem::path& folder,
                                                         const std::vector<Drawing>& drawings) {
  std::vector<std::filesystem::path> files;
  for (const Drawing& drawing : drawings) {
    files.push_back(folder / (drawing.name + ".svg"));
    SGS_RETURN_IF_ERROR(io::write_file(files.back(), standalone_svg(drawing)));
  }
  return files;
}

}  // namespace sgs::report

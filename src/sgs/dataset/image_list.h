// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/dataset/time_unit.h"

namespace sgs::dataset {

/// One row of rgb.txt or depth.txt.
struct ListedImage {
  double timestamp_s = 0;
  std::filesystem::path path;
  std::string origin;  ///< "rgb.txt:12"
};

/// A list of images in order of their times.
struct ImageList {
  std::vector<ListedImage> images;
  TimeUnit unit;               ///< that the list is written in
  std::size_t rows = 0;        ///< before repeated times were dropped
  double first = 0, last = 0;  ///< times as they are written
  /// Where the clock was set back while the list was written: seconds that each stretch after it
  /// was moved by, to follow the one before.
  std::vector<double> moved_s;
};

/// Reads rows "time file": separated by blanks, tabs, commas or semicolons, with decimal commas,
/// blanks in names, letters of another case, and in UTF-16, as lists are found. Times in another
/// unit are brought to seconds. Rows that go back by a second or more into times that were there
/// before, and rise again, are of a clock that was set back; a list of the same recording is moved
/// by the same (`moved_s`). Errors: a row that is none; nearly all rows at one time.
Result<ImageList> read_image_list(const std::filesystem::path& list,
                                  std::vector<std::string>& warnings,
                                  const std::vector<double>& moved_s = {});

}  // namespace sgs::dataset

// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/imu.h"

#include <algorithm>
#include <cmath>

#include "sgs/dataset/bags/bag_topics.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/text.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

constexpr const char* kAccelerometerFile = "accelerometer.txt";

/// A Kinect's accelerometer measures x to the left, y up and z forward; the camera's axes are x
/// right, y down, z forward.
Eigen::Matrix3d kinect_axes() { return Eigen::Vector3d(-1, -1, 1).asDiagonal(); }

/// A sample of a line; empty where that is none.
std::optional<ImuSample> sample_of(std::string_view line) {
  const auto fields = io::split_fields(line, ",");
  if (fields.size() < 4) return std::nullopt;
  double values[4];
  for (std::size_t i = 0; i < 4; ++i) {
    const auto value = io::parse_double(fields[i]);
    if (!value || !std::isfinite(*value)) return std::nullopt;
    values[i] = *value;
  }
  return ImuSample{values[0], {values[1], values[2], values[3]}, {}};
}

void sort_by_time(std::vector<ImuSample>& samples) {
  std::stable_sort(samples.begin(), samples.end(), [](const ImuSample& a, const ImuSample& b) {
    return a.timestamp_s < b.timestamp_s;
  });
}

/// The colour camera's frame in a bag's tf, as the run found it.
Result<ImuRecording> read_imu_of_bag(const SequenceInfo& info) {
  std::vector<fs::path> files = {info.folder};
  files.insert(files.end(), info.more_files.begin(), info.more_files.end());
  SGS_ASSIGN_OR_RETURN(const auto bag, bag::open_bags(files));
  SGS_ASSIGN_OR_RETURN(const auto topics, choose_topics(*bag, "color=" + info.color_topic +
                                                                  ",depth=" + info.depth_topic));
  ImuRecording imu = read_bag_imu(*bag, topics.color.frame_id);
  if (!imu.source.empty()) imu.source = info.folder.string() + ": " + imu.source;
  return imu;
}

}  // namespace

fs::path accelerometer_file(const fs::path& folder) {
  if (folder.empty()) return {};  // of the generator, or a stream
  std::error_code error;
  const fs::path file = folder / kAccelerometerFile;
  return fs::is_regular_file(file, error) ? file : fs::path();
}

ImuRecording read_accelerometer_text(std::string_view text, const std::string& source) {
  ImuRecording imu{source, {}, kinect_axes(), {}};
  std::size_t unreadable = 0;
  int first_line = 0;
  for (const io::TextLine& line : io::content_lines(text)) {
    if (const auto sample = sample_of(line.text)) {
      imu.samples.push_back(*sample);
    } else if (unreadable++ == 0) {
      first_line = line.number;
    }
  }
  if (unreadable > 0) {
    imu.warnings.push_back(
        fmt::format("{}:{}: not 'timestamp ax ay az'; {} such lines are left out", source,
                    first_line, unreadable));
  }
  if (imu.samples.empty()) {
    imu.warnings.push_back(fmt::format(
        "{}: no line says 'timestamp ax ay az': without an accelerometer the floor says what is up",
        source));
  }
  sort_by_time(imu.samples);
  return imu;
}

ImuRecording read_imu(const SequenceInfo& info) {
  if (!info.color_topic.empty()) {
    auto imu = read_imu_of_bag(info);
    if (imu) {
      sort_by_time(imu->samples);
      return std::move(*imu);
    }
    ImuRecording none;
    none.warnings.push_back(imu.error().text());
    return none;
  }
  const fs::path file = accelerometer_file(info.folder);
  if (file.empty()) return {};
  const auto text = io::read_file(file);
  if (text) return read_accelerometer_text(*text, file.string());
  ImuRecording none;
  none.warnings.push_back(text.error().text());
  return none;
}

}  // namespace sgs::dataset

// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/input/inertial.h"

#include <fmt/format.h>

#include <utility>

#include "sgs/io/atomic_file.h"

namespace sgs::run {
namespace {

constexpr const char* kAccelerometerFile = "accelerometer.txt";

/// Another source, and the samples beside its frames.
class InertialSource final : public dataset::FrameSource {
 public:
  InertialSource(std::unique_ptr<FrameSource> source, std::function<dataset::ImuRecording()> imu)
      : source_(std::move(source)), imu_(std::move(imu)) {}
  std::string name() const override { return source_->name(); }
  PinholeCamera camera() const override { return source_->camera(); }
  std::optional<std::int64_t> size() const override { return source_->size(); }
  const Trajectory& ground_truth() const override { return source_->ground_truth(); }
  dataset::FrameRead next(RgbdFrame& frame, Error& error) override {
    return source_->next(frame, error);
  }
  bool live() const override { return source_->live(); }
  void stop() override { source_->stop(); }
  dataset::ImuRecording imu() const { return imu_(); }

 private:
  std::unique_ptr<FrameSource> source_;
  std::function<dataset::ImuRecording()> imu_;
};

const InertialSource* inertial(const Input& input) {
  return dynamic_cast<const InertialSource*>(input.source.get());
}

/// From the axes of a Kinect, which the file is in, to those of a camera.
Eigen::Matrix3d kinect_axes() { return Eigen::Vector3d(-1, -1, 1).asDiagonal(); }

}  // namespace

dataset::ImuRecording read_imu(const Input& input) {
  const InertialSource* source = inertial(input);
  return source != nullptr ? source->imu() : dataset::read_imu(input.info);
}

Status keep_imu(const Input& input, const std::filesystem::path& folder) {
  const InertialSource* source = inertial(input);
  if (source == nullptr) return {};
  const dataset::ImuRecording imu = source->imu();
  if (!imu.R_camera_imu || imu.samples.empty()) return {};
  const Eigen::Matrix3d R_kinect_imu = kinect_axes().transpose() * *imu.R_camera_imu;
  std::string text = "# timestamp ax ay az\n";
  for (const ImuSample& sample : imu.samples) {
    const Eigen::Vector3d a = R_kinect_imu * sample.acceleration;
    text += fmt::format("{:.6f} {:.6f} {:.6f} {:.6f}\n", sample.timestamp_s, a.x(), a.y(), a.z());
  }
  return io::write_file(folder / kAccelerometerFile, text);
}

std::unique_ptr<dataset::FrameSource> with_imu(std::unique_ptr<dataset::FrameSource> source,
                                               std::function<dataset::ImuRecording()> imu) {
  return std::make_unique<InertialSource>(std::move(source), std::move(imu));
}

}  // namespace sgs::run

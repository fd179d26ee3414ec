// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/calibrated_source.h"

#include <cmath>

namespace sgs::dataset {
namespace {

class CalibratedSource final : public FrameSource {
 public:
  CalibratedSource(std::unique_ptr<FrameSource> source, DepthCalibration calibration)
      : source_(std::move(source)), calibration_(std::move(calibration)) {}

  std::string name() const override { return source_->name(); }
  PinholeCamera camera() const override { return source_->camera(); }
  std::optional<std::int64_t> size() const override { return source_->size(); }
  const Trajectory& ground_truth() const override { return source_->ground_truth(); }
  FrameRead next(RgbdFrame& frame, Error& error) override {
    const FrameRead status = source_->next(frame, error);
    if (status != FrameRead::kOk) return status;
    frame.depth = calibration_.apply(frame.depth);
    frame.depth_delay_s += calibration_.delay_s;  // beside what its stamp says
    return status;
  }
  bool live() const override { return source_->live(); }
  void stop() override { source_->stop(); }

 private:
  std::unique_ptr<FrameSource> source_;
  DepthCalibration calibration_;
};

/// Nearly the same intrinsics: a file may hold rounded ones.
bool same_camera(const PinholeCamera& a, const PinholeCamera& b) {
  const auto near = [](double x, double y) { return std::abs(x - y) < 0.5; };
  return a.width == b.width && a.height == b.height && near(a.fx, b.fx) && near(a.fy, b.fy) &&
         near(a.cx, b.cx) && near(a.cy, b.cy);
}

std::string in_words(const PinholeCamera& c) {
  return fmt::format("{} x {} pixels, f {:.1f} {:.1f}, c {:.1f} {:.1f}", c.width, c.height, c.fx,
                     c.fy, c.cx, c.cy);
}

}  // namespace

Result<std::unique_ptr<FrameSource>> calibrated(std::unique_ptr<FrameSource> source,
                                                DepthCalibration calibration,
                                                std::string_view name) {
  if (!same_camera(calibration.camera, source->camera())) {
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{} is of another camera ({}) than {} ({})", name, in_words(calibration.camera),
                    source->name(), in_words(source->camera())),
        "calibrate this one: `sgs calibrate INPUT -o FILE`");
  }
  return std::make_unique<CalibratedSource>(std::move(source), std::move(calibration));
}

}  // namespace sgs::dataset

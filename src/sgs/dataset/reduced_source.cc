// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/reduced_source.h"

#include "sgs/camera/resample.h"

namespace sgs::dataset {
namespace {

class ReducedSource final : public FrameSource {
 public:
  ReducedSource(std::unique_ptr<FrameSource> source, const PinholeCamera& camera)
      : source_(std::move(source)), camera_(camera) {}

  std::string name() const override { return source_->name(); }
  PinholeCamera camera() const override { return camera_; }
  std::optional<std::int64_t> size() const override { return source_->size(); }
  const Trajectory& ground_truth() const override { return source_->ground_truth(); }
  FrameRead next(RgbdFrame& frame, Error& error) override {
    const FrameRead status = source_->next(frame, error);
    if (status == FrameRead::kOk) {
      frame.color = resample_color(frame.color, frame.camera, camera_);
      frame.depth = resample_depth(frame.depth, frame.camera, camera_);
    }
    frame.camera = camera_;
    return status;
  }
  bool live() const override { return source_->live(); }
  void stop() override { source_->stop(); }

 private:
  std::unique_ptr<FrameSource> source_;
  PinholeCamera camera_;
};

}  // namespace

std::unique_ptr<FrameSource> reduced(std::unique_ptr<FrameSource> source, int max_width) {
  const PinholeCamera camera = limited_to_width(source->camera(), max_width);
  if (camera == source->camera()) return source;
  return std::make_unique<ReducedSource>(std::move(source), camera);
}

}  // namespace sgs::dataset

// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/api/session.h"

#include <cmath>
#include <limits>
#include <mutex>

#include "sgs/api/internal/access.h"
#include "sgs/api/internal/convert.h"
#include "sgs/api/internal/frame_copy.h"
#include "sgs/api/internal/frame_pool.h"
#include "sgs/api/internal/guard.h"
#include "sgs/api/internal/to_frame_result.h"
#include "sgs/camera/undistort.h"
#include "sgs/dataset/frame_fit.h"
#include "sgs/runfolder/run.h"
#include "sgs/slam/session.h"

namespace sgs::api {
namespace {

/// What stands for a recording in the folder of a run that was fed by a program.
class FedFrames : public dataset::FrameSource {
 public:
  explicit FedFrames(const PinholeCamera& camera) : camera_(camera) {}
  std::string name() const override { return "fed"; }
  PinholeCamera camera() const override { return camera_; }
  std::optional<std::int64_t> size() const override { return 0; }
  const sgs::Trajectory& ground_truth() const override { return none_; }
  dataset::FrameRead next(RgbdFrame&, sgs::Error&) override { return dataset::FrameRead::kEnd; }

 private:
  PinholeCamera camera_;
  sgs::Trajectory none_;
};

slam::SessionOptions session_options(const SessionOptions& options) {
  internal::check_threads(options.threads);
  return {options.threads, options.live,
          internal::value_or_raise(internal::from_api(options.T_world_first))};
}

}  // namespace

struct Session::Impl {
  Impl(const Camera& camera, const Config& given, const SessionOptions& options)
      : lens(internal::value_or_raise(internal::from_api(camera))),
        config(given),
        slam(internal::value_or_raise(slam::Session::create(config.modules().session, lens.camera,
                                                            session_options(options)))) {
    if (!lens.distortion.is_zero()) undistorter.emplace(lens.camera, lens.distortion);
  }

  // The steps of feed().
  void check_can_take(double timestamp_s) const;
  void check_unit(const DepthImage& depth, double scale);
  std::shared_ptr<const RgbdFrame> copied(const ColorView& color, const DepthView& depth,
                                          double timestamp_s);
  FrameResult feed(const std::shared_ptr<const RgbdFrame>& frame);

  LensCamera lens;
  std::optional<Undistorter> undistorter;
  Config config;
  std::unique_ptr<slam::Session> slam;
  internal::FramePool pool;
  internal::DepthCopier depth_copier;
  std::int64_t next_index = 0;
  double last_time_s = -std::numeric_limits<double>::infinity();
  bool unit_checked = false;
  bool is_finished = false;
  std::mutex calling;         // feed() and finish(): one caller
  mutable std::mutex states;  // what they change, against those who read
  mutable std::mutex maps;    // final_map: map() does not wait for the others
  map::SnapshotPtr final_map;
};

void Session::Impl::check_can_take(double timestamp_s) const {
  if (is_finished) {
    throw Error(ErrorCode::kInvalidArgument, "the session is finished",
                "make a new one to feed more frames");
  }
  if (!std::isfinite(timestamp_s) || timestamp_s <= last_time_s) {
    throw Error(ErrorCode::kInvalidArgument,
                fmt::format("time {} s is not later than that of the last frame, {} s", timestamp_s,
                            last_time_s),
                "times are finite seconds and rise from frame to frame");
  }
}

// Once: a unit does not change. An image without any depth tells nothing.
void Session::Impl::check_unit(const DepthImage& depth, double scale) {
  if (unit_checked) return;
  const Status status = dataset::check_depth_unit(depth, scale, "the depth scale given");
  if (!status) {
    throw Error(ErrorCode::kInvalidFormat, status.error().message,
                "give the scale of the unit: 1000 for millimetres, 5000 for TUM, 1 for metres");
  }
  for (std::size_t i = 0; i < depth.size() && !unit_checked; ++i)
    unit_checked = depth.data()[i] > 0;
}

std::shared_ptr<const RgbdFrame> Session::Impl::copied(const ColorView& color,
                                                       const DepthView& depth, double timestamp_s) {
  auto frame = pool.take();
  frame->index = next_index;
  frame->timestamp_s = timestamp_s;
  frame->camera = lens.camera;
  internal::copy_color(color, frame->color);
  depth_copier.copy(depth, frame->depth);
  check_unit(frame->depth, depth.scale);
  if (undistorter) {
    frame->color = undistorter->color(frame->color);
    frame->seen = undistorter->seen();
    frame->depth = undistorter->depth(frame->depth);
  }
  return frame;
}

FrameResult Session::Impl::feed(const std::shared_ptr<const RgbdFrame>& frame) {
  const std::lock_guard lock(states);
  const slam::FrameRecord& record = slam->feed(frame);
  next_index = frame->index + 1;
  last_time_s = frame->timestamp_s;
  return internal::to_frame_result(record, record.T_online_camera);
}

Session::Session(const Camera& camera, const Config& config, const SessionOptions& options)
    : impl_(internal::guarded([&] { return std::make_unique<Impl>(camera, config, options); })) {}
Session::Session(Session&&) noexcept = default;
Session& Session::operator=(Session&&) noexcept = default;
Session::~Session() = default;

FrameResult Session::feed(const ColorView& color, const DepthView& depth, double timestamp_s) {
  return internal::guarded([&] {
    const internal::OneCaller caller(impl_->calling, "session");
    impl_->check_can_take(timestamp_s);
    internal::check_or_raise(internal::check_views(color, depth, impl_->lens.camera));
    return impl_->feed(impl_->copied(color, depth, timestamp_s));
  });
}

FrameResult Session::feed(const Frame& frame) {
  return internal::guarded([&] {
    const internal::OneCaller caller(impl_->calling, "session");
    impl_->check_can_take(frame.timestamp_s());
    const auto images = internal::FrameAccess::get(frame);
    if (images->camera != impl_->lens.camera || impl_->undistorter) {
      throw Error(ErrorCode::kInvalidArgument,
                  "the frame was taken with another camera than the session's",
                  "make the session with the camera of the recording");
    }
    if (images->index < impl_->next_index) {
      throw Error(
          ErrorCode::kInvalidArgument,
          fmt::format("frame {} comes after frame {}", images->index, impl_->next_index - 1),
          "feed the frames of one recording in their order");
    }
    return impl_->feed(images);
  });
}

void Session::finish() {
  internal::guarded([&] {
    const internal::OneCaller caller(impl_->calling, "session");
    if (impl_->is_finished) return;
    const std::lock_guard lock(impl_->states);
    impl_->is_finished = true;
    impl_->slam->finish();
    const std::lock_guard map_lock(impl_->maps);
    impl_->final_map = impl_->slam->final_snapshot();
  });
}

bool Session::finished() const {
  const std::lock_guard lock(impl_->states);
  return impl_->is_finished;
}

Camera Session::camera() const { return internal::to_api(impl_->lens.camera); }

std::vector<FrameResult> Session::frames() const {
  return internal::guarded([&] {
    const std::lock_guard lock(impl_->states);
    std::vector<FrameResult> results;
    const auto& path = impl_->slam->revision().path;
    for (const auto& record : impl_->slam->records().all()) {
      results.push_back(
          internal::to_frame_result(record, record.bad ? SE3{} : path.at(record.index)));
    }
    return results;
  });
}

Trajectory Session::trajectory() const {
  return internal::guarded([&] {
    const std::lock_guard lock(impl_->states);
    if (impl_->is_finished) return internal::to_api(impl_->slam->trajectory());
    Trajectory so_far;
    const auto& path = impl_->slam->revision().path;
    for (std::size_t k = 0; k < path.size(); ++k) {
      so_far.times.push_back(path[k].timestamp_s);
      so_far.poses.push_back(internal::to_api(path[k].T_odom_camera));
    }
    return so_far;
  });
}

Trajectory Session::online_trajectory() const {
  return internal::guarded([&] {
    const std::lock_guard lock(impl_->states);
    return internal::to_api(impl_->slam->online_trajectory());
  });
}

std::optional<Map> Session::map() const {
  return internal::guarded([&]() -> std::optional<Map> {
    const std::lock_guard lock(impl_->maps);
    auto snapshot = impl_->final_map ? impl_->final_map : impl_->slam->snapshot();
    if (!snapshot) return std::nullopt;
    return internal::MapAccess::make(std::move(snapshot));
  });
}

void Session::save(const std::string& folder, const Recording* recording) const {
  internal::guarded([&] {
    const std::lock_guard lock(impl_->states);
    if (!impl_->is_finished) {
      throw Error(ErrorCode::kInvalidArgument, "the session is not finished",
                  "call finish() before save()");
    }
    run::Input fed;
    fed.source = std::make_unique<FedFrames>(impl_->lens.camera);
    fed.info.name = "fed";
    const run::Run run =
        recording == nullptr
            ? run::run_of(*impl_->slam, fed, {})
            : run::run_of(*impl_->slam, internal::RecordingAccess::input(*recording),
                          internal::RecordingAccess::spec(*recording));
    internal::check_or_raise(run::save_run(run, folder));
  });
}

}  // namespace sgs::api

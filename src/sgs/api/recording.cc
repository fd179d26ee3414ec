// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/api/recording.h"

#include <mutex>

#include "sgs/api/internal/access.h"
#include "sgs/api/internal/convert.h"
#include "sgs/api/internal/guard.h"
#include "sgs/core/log.h"
#include "sgs/dataset/feed_item.h"

namespace sgs::api {
namespace {

constexpr int kRenderingThreads = 2;  // of synthetic frames

}  // namespace

struct Frame::Impl {
  std::shared_ptr<const RgbdFrame> frame;
};

Frame::Frame(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
Frame::Frame(const Frame&) = default;
Frame& Frame::operator=(const Frame&) = default;
Frame::~Frame() = default;

std::int64_t Frame::index() const { return impl_->frame->index; }
double Frame::timestamp_s() const { return impl_->frame->timestamp_s; }
Camera Frame::camera() const { return internal::to_api(impl_->frame->camera); }
int Frame::width() const { return impl_->frame->color.width(); }
int Frame::height() const { return impl_->frame->color.height(); }
const std::uint8_t* Frame::color() const {
  static_assert(sizeof(Rgb8) == 3);
  return &impl_->frame->color.data()->r;
}
const float* Frame::depth() const { return impl_->frame->depth.data(); }
std::optional<Pose> Frame::truth() const {
  const auto& truth = impl_->frame->truth_T_world_camera;
  return truth ? std::optional(internal::to_api(*truth)) : std::nullopt;
}

struct Recording::Impl {
  run::InputSpec spec;
  run::Input input;
  std::mutex reading;
  mutable std::mutex noting;
  std::vector<BadFrame> bad;
};

Recording::Recording(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Recording::Recording(Recording&&) noexcept = default;
Recording& Recording::operator=(Recording&&) noexcept = default;
Recording::~Recording() = default;

Recording Recording::open(const std::string& input, const Settings& options) {
  return internal::guarded([&] {
    auto impl = std::make_unique<Impl>();
    impl->spec = internal::input_spec(input, options);
    impl->input = internal::value_or_raise(run::open_input(impl->spec, kRenderingThreads));
    for (const std::string& warning : impl->input.info.warnings) log().warn("{}", warning);
    return Recording(std::move(impl));
  });
}

std::optional<Frame> Recording::next() {
  return internal::guarded([&]() -> std::optional<Frame> {
    const internal::OneCaller caller(impl_->reading, "recording");
    while (auto item = dataset::read_item(*impl_->input.source)) {
      if (item->frame) return internal::FrameAccess::make(std::move(item->frame));
      if (item->event) {
        log().warn("input: {}", item->bad_reason);
        continue;
      }
      log().warn("frame {} skipped: {}", item->index, item->bad_reason);
      const std::lock_guard lock(impl_->noting);
      impl_->bad.push_back({item->index, item->timestamp_s, item->bad_reason});
    }
    return std::nullopt;
  });
}

void Recording::stop() { impl_->input.source->stop(); }

std::vector<BadFrame> Recording::bad_frames() const {
  const std::lock_guard lock(impl_->noting);
  return impl_->bad;
}

std::string Recording::name() const { return impl_->input.info.name; }
std::string Recording::layout() const { return impl_->input.info.layout; }
std::string Recording::calibration_source() const { return impl_->input.info.calibration_source; }
Camera Recording::camera() const { return internal::to_api(impl_->input.source->camera()); }
std::optional<std::int64_t> Recording::size() const { return impl_->input.source->size(); }
Trajectory Recording::ground_truth() const {
  return internal::to_api(impl_->input.source->ground_truth());
}
std::vector<std::string> Recording::warnings() const { return impl_->input.info.warnings; }

namespace internal {

Frame FrameAccess::make(std::shared_ptr<const RgbdFrame> frame) {
  return Frame(std::make_shared<const Frame::Impl>(Frame::Impl{std::move(frame)}));
}
std::shared_ptr<const RgbdFrame> FrameAccess::get(const Frame& frame) { return frame.impl_->frame; }

const run::Input& RecordingAccess::input(const Recording& recording) {
  return recording.impl_->input;
}
const run::InputSpec& RecordingAccess::spec(const Recording& recording) {
  return recording.impl_->spec;
}

run::InputSpec input_spec(const std::string& input, const Settings& options) {
  run::InputSpec spec;
  spec.input = input;
  ParameterList list;
  spec.declare(list);
  for (const auto& [name, value] : options) {
    const std::string key = "input." + name;
    const Status status = list.set(key, value);
    if (status) continue;
    const bool known = list.find(key) != nullptr;
    if (known) raise(status.error());
    throw Error(ErrorCode::kUnknownKey, status.error().message, status.error().remedy);
  }
  return spec;
}

}  // namespace internal
}  // namespace sgs::api

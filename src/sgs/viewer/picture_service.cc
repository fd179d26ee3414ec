// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/viewer/picture_service.h"

#include <algorithm>
#include <cmath>

#include "sgs/camera/movers.h"
#include "sgs/core/log.h"
#include "sgs/core/low_priority.h"
#include "sgs/core/stopwatch.h"
#include "sgs/io/image_io.h"
#include "sgs/render/rasterizer.h"
#include "sgs/render/view_color.h"
#include "sgs/viewer/panes.h"

namespace sgs::viewer {
namespace {

constexpr double kViewInterval_s = 1.0 / 15;
constexpr double kPaneInterval_s = 0.25;
constexpr int kPaneWidth_px = 400;  // at most
constexpr int kPaneQuality = 75, kViewQuality = 85;
constexpr PaneSet kRendered = bit(Pane::kRender) | bit(Pane::kError);

PinholeCamera shrunk(const PinholeCamera& c, int stride) {
  const double s = 1.0 / stride;
  return {c.width / stride, c.height / stride,      c.fx * s,
          c.fy * s,         (c.cx + 0.5) * s - 0.5, (c.cy + 0.5) * s - 0.5};
}

PinholeCamera view_camera(const ViewRequest& request) {
  const double focal = 0.5 * request.height / std::tan(0.5 * request.fov_y_rad);
  return {request.width,
          request.height,
          focal,
          focal,
          0.5 * request.width - 0.5,
          0.5 * request.height - 0.5};
}

}  // namespace

/// The thread's own: rasterizer and its buffers.
struct PictureService::Worker {
  Worker(const PinholeCamera& c, const Deliver& d) : camera(c), deliver(d) {}

  void send(Pane pane, std::uint64_t client, std::uint32_t sequence, const ColorImage& image,
            int quality) const {
    const auto jpeg = io::encode_jpeg(image, quality);
    if (!jpeg) {
      log().warn("viewer: {}", jpeg.error().text());
      return;
    }
    deliver({pane, client,
             std::make_shared<const std::string>(picture_message(pane, sequence, *jpeg))});
  }

  ColorImage render(const map::Snapshot& map, const PinholeCamera& view, const SE3& T) {
    rasterizer->render(colors.seen(map.gaussians, map.harmonics, T.t), view, T, rendering);
    return color_picture(rendering.color);
  }

  /// Around what moves; the error pane compares the picture without it.
  static ColorImage with_outline(ColorImage color, const slam::FrameRecord& record,
                                 const RgbdFrame& frame, int stride) {
    const auto still = still_from_blocks(record.movers, frame.color.width(), frame.color.height());
    if (still) outline(color, shrink(*still, stride));
    return color;
  }

  void make_panes(const FrameUpdate& update, PaneSet panes) {
    const auto sequence = static_cast<std::uint32_t>(update.record.index);
    const auto show = [&](Pane pane, const ColorImage& image) {
      if ((panes & bit(pane)) != 0) send(pane, 0, sequence, image, kPaneQuality);
    };
    const int stride = std::max(1, (camera.width + kPaneWidth_px - 1) / kPaneWidth_px);
    ColorImage color;
    PixelMask seen;  // empty: all
    if (const RgbdFrame* frame = update.frame.get()) {
      color = shrink(frame->color, stride);
      if (frame->seen) seen = shrink(*frame->seen, stride);
      veil(color, seen);
      show(Pane::kColor, with_outline(color, update.record, *frame, stride));
      if ((panes & bit(Pane::kDepth)) != 0) {
        show(Pane::kDepth, depth_picture(shrink(frame->depth, stride)));
      }
    }
    if ((panes & kRendered) == 0 || !update.map) return;
    ColorImage rendered = render(*update.map, shrunk(camera, stride), update.T_world_camera);
    veil(rendered, seen);
    show(Pane::kRender, rendered);
    if (!color.empty()) show(Pane::kError, error_picture(color, rendered));
  }

  void make_view(const map::Snapshot& map, std::uint64_t client, const ViewRequest& request) {
    const ColorImage image = render(map, view_camera(request), request.T_world_camera);
    send(Pane::kView, client, request.sequence, image, kViewQuality);
  }

  PinholeCamera camera;  ///< of the run
  const Deliver& deliver;
  std::unique_ptr<render::Rasterizer> rasterizer = render::make_cpu_rasterizer(nullptr);
  render::ViewColors colors = render::ViewColors(nullptr);
  render::Rendering rendering;
};

PictureService::PictureService(const PinholeCamera& camera, Deliver deliver)
    : camera_(camera), deliver_(std::move(deliver)), thread_([this] { loop(); }) {}

PictureService::~PictureService() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void PictureService::set_panes(PaneSet panes) {
  {
    const std::scoped_lock lock(mutex_);
    panes_done_ &= panes & panes_;  // a pane that was closed is made anew when it opens again
    panes_ = panes;
  }
  changed_.notify_all();
}

void PictureService::offer(FrameUpdatePtr update) {
  {
    const std::scoped_lock lock(mutex_);
    std::swap(update_, update);
    panes_done_ = 0;
    if (panes_ == 0 && views_.empty()) return;
  }
  changed_.notify_all();
}

void PictureService::request_view(std::uint64_t client, const ViewRequest& request) {
  {
    const std::scoped_lock lock(mutex_);
    views_[client] = request;
  }
  changed_.notify_all();
}

void PictureService::forget(std::uint64_t client) {
  const std::scoped_lock lock(mutex_);
  views_.erase(client);
}

void PictureService::guarded(const std::function<void()>& make) {
  try {
    make();
  } catch (const std::exception& error) {
    // A picture is missing then; the run that is watched goes on.
    if (!failed_) log().warn("a picture for the viewer could not be made: {}", error.what());
    failed_ = true;
  }
}

void PictureService::loop() {
  lower_thread_priority(10);
  std::unique_ptr<Worker> worker;
  guarded([&] { worker = std::make_unique<Worker>(camera_, deliver_); });
  if (!worker) return;
  double next_view_s = 0, next_panes_s = 0;
  std::unique_lock lock(mutex_);
  while (!stop_) {
    const double now_s = wall_time_s();
    const bool has_view = !views_.empty() && update_ && update_->map;
    const bool has_panes = update_ && (panes_ & ~panes_done_) != 0;
    const bool view_due = has_view && now_s >= next_view_s;
    if (!view_due && !(has_panes && now_s >= next_panes_s)) {
      double due_s = now_s + 1;
      if (has_view) due_s = std::min(due_s, next_view_s);
      if (has_panes) due_s = std::min(due_s, next_panes_s);
      changed_.wait_for(lock, std::chrono::duration<double>(std::max(1e-3, due_s - now_s)));
      continue;
    }
    const FrameUpdatePtr update = update_;
    if (view_due) {
      auto it = views_.upper_bound(last_client_);
      if (it == views_.end()) it = views_.begin();
      const auto client = it->first;
      const auto request = it->second;
      views_.erase(it);
      last_client_ = client;
      lock.unlock();
      guarded([&] { worker->make_view(*update->map, client, request); });
    } else {
      const PaneSet wanted = panes_ & ~panes_done_;
      panes_done_ |= wanted;
      lock.unlock();
      guarded([&] { worker->make_panes(*update, wanted); });
    }
    const double end_s = wall_time_s(), rest_s = end_s - now_s;  // rests as long as it worked
    (view_due ? next_view_s : next_panes_s) =
        std::max(now_s + (view_due ? kViewInterval_s : kPaneInterval_s), end_s + rest_s);
    lock.lock();
  }
}

}  // namespace sgs::viewer

// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/run_evaluator.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "sgs/camera/seen_area.h"
#include "sgs/eval/image_metrics.h"
#include "sgs/render/view_color.h"

namespace sgs::eval {
namespace {

/// Frames rendered one after the other and then compared side by side. Fixed, so that nothing
/// depends on the number of threads.
constexpr std::size_t kGroupSize = 4;

/// One frame between rendering and comparison.
struct Job {
  RgbdFrame frame;
  render::Rendering rendering;
  bool regular = false;  ///< counts for rules gsicp and full
  bool heldout = false;
  bool with_lpips = false;
  bool with_picture = false;
  std::optional<std::array<float, 3>> gain;
};

struct JobResult {
  FrameScores scores;
  std::optional<double> ssim_gsicp, lpips_gsicp, lpips_full, psnr_exposed_db;
  std::optional<DepthError> depth;
  std::optional<FramePictures> pictures;
};

struct Mean {
  double sum = 0;
  std::int64_t count = 0;
  void add(const std::optional<double>& value) {
    if (!value) return;
    sum += *value;
    ++count;
  }
  std::optional<double> value() const {
    return count > 0 ? std::optional(sum / static_cast<double>(count)) : std::nullopt;
  }
};

struct RuleMeans {
  Mean psnr, ssim, lpips;
  RuleScores scores() const {
    return {psnr.value(), ssim.value(), lpips.value(), psnr.count, lpips.count};
  }
};

ColorImage to_8bit(const ColorFloatImage& image) {
  ColorImage result(image.width(), image.height());
  for (std::size_t i = 0; i < image.size(); ++i) {
    const render::Rgbf& p = image.data()[i];
    result.data()[i] = {to_byte(p.r), to_byte(p.g), to_byte(p.b)};
  }
  return result;
}

ColorImage resized(const ColorImage& image, int width) {
  if (width >= image.width()) return image;
  const int height = std::max(1, image.height() * width / image.width());
  ColorImage copy = image, result(width, height);
  const cv::Mat source(image.height(), image.width(), CV_8UC3, copy.data());
  cv::Mat target(height, width, CV_8UC3, result.data());
  cv::resize(source, target, target.size(), 0, 0, cv::INTER_AREA);
  return result;
}

/// Mean absolute colour error on a scale from black over purple and orange to yellow (0.25).
ColorImage error_map(const ColorFloatImage& truth, const ColorFloatImage& image) {
  constexpr float kFullScale = 0.25f;
  ColorImage result(truth.width(), truth.height());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const render::Rgbf &a = truth.data()[i], &b = image.data()[i];
    const float error = (std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b)) / 3;
    const float s = std::min(1.0f, error / kFullScale);
    result.data()[i] = {to_byte(2 * s), to_byte(2 * s - 0.8f), to_byte(s < 0.5f ? s : 1 - s)};
  }
  return result;
}

JobResult compare(const Job& job, const Lpips* lpips, const RunEvaluatorConfig& config) {
  JobResult result;
  result.scores.index = job.frame.index;
  const ColorFloatImage truth = to_float(job.frame.color);
  const ColorFloatImage image = clamped(job.rendering.color);
  const PixelMask* seen = job.frame.seen.get();
  result.scores.psnr_full_db = psnr_db(truth, image, seen);
  result.scores.ssim_full = ssim(truth, image, seen);
  if (job.heldout && job.gain) {
    result.psnr_exposed_db =
        psnr_db(truth, clamped(brightened(job.rendering.color, *job.gain)), seen);
  }
  result.depth =
      depth_error(job.frame.depth, job.rendering, static_cast<float>(config.depth_min_alpha));
  if (result.depth) result.scores.depth_l1_m = result.depth->l1_m;
  if (lpips != nullptr && job.with_lpips) {
    result.lpips_full = lpips->distance(zero_unseen(truth, seen), zero_unseen(image, seen));
  }
  if (job.regular) {
    const ColorFloatImage masked_truth = zero_without_depth(truth, job.frame.depth);
    const ColorFloatImage masked_image = zero_without_depth(image, job.frame.depth);
    result.scores.psnr_gsicp_db = psnr_db(masked_truth, masked_image);
    result.ssim_gsicp = ssim(masked_truth, masked_image);
    if (lpips != nullptr && job.with_lpips) {
      result.lpips_gsicp = lpips->distance(masked_truth, masked_image);
    }
  }
  if (job.with_picture) {
    const auto shown = [&](const ColorImage& picture) {
      return resized(seen != nullptr ? cropped(picture, largest_seen_area(*seen)) : picture,
                     config.picture_width_px);
    };
    result.pictures = FramePictures{job.frame.index,
                                    job.heldout,
                                    *result.scores.psnr_full_db,
                                    shown(job.frame.color),
                                    shown(to_8bit(image)),
                                    shown(error_map(truth, image)),
                                    {}};
  }
  return result;
}

Metrics scores_of(const RunEvaluation& r) {
  Metrics scores;
  scores.psnr_db = r.gsicp.psnr_db;
  scores.ssim = r.gsicp.ssim;
  scores.lpips = r.gsicp.lpips;
  scores.psnr_db_full = r.full.psnr_db;
  scores.ssim_full = r.full.ssim;
  scores.lpips_full = r.full.lpips;
  scores.psnr_db_train = r.train.psnr_db;
  scores.ssim_train = r.train.ssim;
  scores.lpips_train = r.train.lpips;
  scores.psnr_db_heldout = r.heldout.psnr_db;
  scores.psnr_db_exposed = r.psnr_exposed_db;
  scores.ssim_heldout = r.heldout.ssim;
  scores.lpips_heldout = r.heldout.lpips;
  scores.depth_l1_m = r.depth_l1_m;
  scores.pictures = kMeasuredPictures;
  return scores;
}

/// Sums over all frames, in frame order.
class Totals {
 public:
  void add(const Job& job, JobResult result, RunEvaluation& out) {
    if (job.regular) {
      gsicp_.psnr.add(result.scores.psnr_gsicp_db);
      gsicp_.ssim.add(result.ssim_gsicp);
      gsicp_.lpips.add(result.lpips_gsicp);
      full_.psnr.add(result.scores.psnr_full_db);
      full_.ssim.add(result.scores.ssim_full);
      if (job.with_lpips) full_.lpips.add(result.lpips_full);
      if (result.depth) {
        depth_.add(result.depth->l1_m);
        coverage_.add(result.depth->coverage);
      }
    }
    if (job.regular && !job.heldout) {
      train_.psnr.add(result.scores.psnr_full_db);
      train_.ssim.add(result.scores.ssim_full);
      train_.lpips.add(result.lpips_full);
    }
    if (job.heldout) {
      heldout_.psnr.add(result.scores.psnr_full_db);
      heldout_.ssim.add(result.scores.ssim_full);
      heldout_.lpips.add(result.lpips_full);
      exposed_.add(result.psnr_exposed_db);
    }
    out.frames.push_back(result.scores);
    if (result.pictures) out.pictures.push_back(std::move(*result.pictures));
  }

  void store(RunEvaluation& out) const {
    out.gsicp = gsicp_.scores();
    out.full = full_.scores();
    out.train = train_.scores();
    out.heldout = heldout_.scores();
    out.psnr_exposed_db = exposed_.value();
    out.depth_l1_m = depth_.value();
    out.depth_coverage = coverage_.value();
    out.scores = scores_of(out);
  }

 private:
  RuleMeans gsicp_, full_, train_, heldout_;
  Mean depth_, coverage_, exposed_;
};

/// Decides which frames keep their pictures: `pictures` of them, each in the middle of its share.
bool keeps_picture(std::int64_t frame, std::size_t kept, std::int64_t expected, int pictures) {
  if (static_cast<int>(kept) >= pictures) return false;
  if (expected <= 0) return frame % 100 == 50;
  return frame >= (2 * static_cast<std::int64_t>(kept) + 1) * expected / (2 * pictures);
}

std::string protocol_line(const RunInput& input, const RunEvaluatorConfig& config,
                          const RunEvaluation& out) {
  std::string lpips = "LPIPS not measured (no weights)";
  if (input.lpips != nullptr) {
    lpips = fmt::format("LPIPS-Alex v0.1 on {} of them and on every held-out frame",
                        out.full.lpips_frames);
  }
  return fmt::format(
      "Rendering at the estimated poses, every {} frame(s): {} frames under rules gsicp (pixels "
      "without depth zeroed in both, averaged over all) and full, {} held out (every {} frame(s)); "
      "SSIM over the interior; {}; depth L1 where measured and alpha >= {:g} ({}){}",
      config.stride, out.full.frames, out.heldout.frames, config.heldout_interval, lpips,
      config.depth_min_alpha,
      out.depth_coverage ? fmt::format("{:.1f} % of the measured pixels", 100 * *out.depth_coverage)
                         : "none",
      out.cancelled ? "; cancelled early" : "");
}

}  // namespace

RunEvaluation evaluate_run(const RunInput& input, const RunEvaluatorConfig& config) {
  SGS_CHECK(input.next_frame && input.pose_of && input.rasterizer != nullptr,
            "evaluation needs frames, poses and a rasterizer");
  SGS_CHECK(config.stride >= 1 && config.lpips_stride >= 1, "strides start at 1");
  RunEvaluation out;
  Totals totals;
  std::vector<Job> jobs(kGroupSize);
  std::int64_t regular_frames = 0;
  std::size_t pictures_planned = 0;
  render::ViewColors colors(input.pool);
  bool more = true;
  while (more) {
    if (input.cancelled && input.cancelled()) {
      out.cancelled = true;
      break;
    }
    std::size_t used = 0;
    while (used < kGroupSize) {
      Job& job = jobs[used];
      if (!input.next_frame(job.frame)) {
        more = false;
        break;
      }
      const std::int64_t number = out.frames_seen++;
      job.regular = number % config.stride == 0;
      job.heldout = is_heldout(job.frame.index, config.heldout_interval);
      if (!job.regular && !job.heldout) continue;
      const std::optional<SE3> pose = input.pose_of(job.frame);
      if (!pose || !pose->all_finite()) {
        ++out.frames_without_pose;
        continue;
      }
      job.with_lpips = job.heldout || (job.regular && regular_frames % config.lpips_stride == 0);
      if (job.regular) ++regular_frames;
      job.with_picture =
          keeps_picture(number, pictures_planned, input.frames_expected, config.pictures);
      if (job.with_picture) ++pictures_planned;
      if (input.gain_of) job.gain = input.gain_of(job.frame);
      const auto seen = input.harmonics == nullptr
                            ? input.gaussians
                            : colors.seen(input.gaussians, *input.harmonics, pose->t);
      input.rasterizer->render(seen, job.frame.camera, *pose, job.rendering);
      ++used;
    }
    std::vector<JobResult> results(used);
    const auto body = [&](int chunk, int) {
      const auto i = static_cast<std::size_t>(chunk);
      results[i] = compare(jobs[i], input.lpips, config);
    };
    if (input.pool != nullptr) {
      input.pool->run(static_cast<int>(used), body);
    } else {
      for (std::size_t i = 0; i < used; ++i) body(static_cast<int>(i), 0);
    }
    for (std::size_t i = 0; i < used; ++i) totals.add(jobs[i], std::move(results[i]), out);
    if (input.progress) input.progress(out.frames_seen);
  }
  totals.store(out);
  out.protocol = protocol_line(input, config, out);
  return out;
}

}  // namespace sgs::eval

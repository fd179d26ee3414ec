// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/movers/moving_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>

#include "sgs/tracker/movers/depth_segments.h"
#include "sgs/tracker/movers/surface_check.h"

namespace sgs::tracker {
namespace {

double env(const char* name, double value) {
  const char* text = std::getenv(name);
  return text ? std::atof(text) : value;
}

}  // namespace

void MovingParts::look_at(const RgbdFrame& frame) {
  view_ = CoarseDepth(frame);
}

MovingParts::Judgement MovingParts::judge(const SE3& T_local_camera, const LocalPast& past,
                                          const registration::FrameMotion& motion) {
  view_.motion = motion;
  static const double kAges[] = {env("A1", 0.1), env("A2", 0.3), env("A3", 0.6)};
  static const double kHalf = env("HALF", 0.3), kSteep = env("STEEP", 12), kLambda = env("LAM", 1),
                      kMu = env("MU", 8), kLeast = env("LEAST", 0.02), kFew = env("FEW", 0.06), kTwo = env("TWO", 1);
  Judgement out;
  std::vector<const CoarseDepth*> against;
  for (const double age : kAges) {
    const CoarseDepth* best = nullptr;
    for (const CoarseDepth& v : views_) {
      if (!best || std::abs(view_.timestamp_s - v.timestamp_s - age) <
                       std::abs(view_.timestamp_s - best->timestamp_s - age)) {
        best = &v;
      }
    }
    if (best && std::find(against.begin(), against.end(), best) == against.end()) {
      against.push_back(best);
    }
  }
  if (against.empty()) return out;
  std::vector<float> off;
  std::size_t raw = 0, known = 0;
  int columns = 0;
  for (const CoarseDepth* v : against) {
    const SurfaceCheck check =
        check_surface(view_, *v, past.at(v->frame).inverse() * T_local_camera);
    columns = check.columns;
    if (off.empty()) off.assign(check.off.size(), SurfaceCheck::kUnknown);
    for (std::size_t i = 0; i < off.size(); ++i) off[i] = std::max(off[i], check.off[i]);
    out.support += check.support;
  }
  for (const float o : off) {
    known += o >= 0 ? 1 : 0;
    raw += o > 0.5f ? 1 : 0;
  }
  static const bool debug = std::getenv("MOVDBG") != nullptr;
  const bool quiet = static_cast<double>(raw) < kFew * static_cast<double>(known) && !moved_;
  if (debug) {
    std::fprintf(stderr, "sigma 0 judge %ld raw %.3f support %.0f", long(view_.frame),
                 double(raw) / double(std::max<std::size_t>(1, known)), out.support);
  }
  if (quiet) {
    if (debug) std::fprintf(stderr, "\n");
    return out;
  }
  std::vector<float> depth(off.size());
  const int rows = static_cast<int>(off.size()) / columns;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      depth[static_cast<std::size_t>(y * columns + x)] =
          view_.depth(x * SurfaceCheck::kCell + 1, y * SurfaceCheck::kCell + 1);
    }
  }
  const DepthSegments segments = segment_depth(depth, columns);
  const auto n = static_cast<std::size_t>(segments.count);
  std::vector<double> evidence(n, 0), weight(n, 0), before(n, 0), cells(n, 0);
  for (std::size_t i = 0; i < off.size(); ++i) {
    if (segments.of[i] < 0) continue;
    const auto s = static_cast<std::size_t>(segments.of[i]);
    cells[s] += 1;
    before[s] += still_.empty() ? 1.0 : still_[i];
    if (off[i] < 0) continue;
    evidence[s] += off[i];
    weight[s] += 1;
  }
  std::vector<double> still(n, 1), target(n, 1);
  for (std::size_t s = 0; s < n; ++s) {
    if (weight[s] > 0) {
      target[s] = 1 / (1 + std::exp(kSteep * (evidence[s] / weight[s] - kHalf)));
    }
    if (cells[s] > 0) before[s] /= cells[s];
    still[s] = target[s];
  }
  const double mu = still_.empty() ? 0 : kMu;
  for (int round = 0; round < 20; ++round) {
    std::vector<double> sum(n), total(n);
    for (std::size_t s = 0; s < n; ++s) {
      sum[s] = weight[s] * target[s] + mu * before[s] + 1e-3;
      total[s] = weight[s] + mu + 1e-3;
    }
    for (const auto& b : segments.borders) {
      const auto s = static_cast<std::size_t>(b.a), t = static_cast<std::size_t>(b.b);
      const double w = kLambda * static_cast<double>(b.length);
      sum[s] += w * still[t];
      total[s] += w;
      sum[t] += w * still[s];
      total[t] += w;
    }
    for (std::size_t s = 0; s < n; ++s) still[s] = sum[s] / total[s];
  }
  out.still.assign(off.size(), 1.0f);
  std::vector<std::uint8_t> moves(off.size(), 0);
  std::size_t measured = 0;
  for (std::size_t i = 0; i < off.size(); ++i) {
    if (segments.of[i] < 0) continue;
    ++measured;
    out.still[i] = static_cast<float>(still[static_cast<std::size_t>(segments.of[i])]);
    moves[i] = out.still[i] < 0.5f ? 1 : 0;
  }
  out.suspected = moves;
  // Parts that are too small, or that nobody suspected a frame ago, are let go.
  std::vector<std::uint8_t> todo = moves;
  std::size_t moving = 0;
  double largest = 0;
  for (std::size_t first = 0; first < todo.size(); ++first) {
    if (!todo[first]) continue;
    std::vector<std::size_t> part{first};
    todo[first] = 0;
    bool again = false;
    for (std::size_t k = 0; k < part.size(); ++k) {
      const int x = static_cast<int>(part[k]) % columns, y = static_cast<int>(part[k]) / columns;
      again = again || suspected_.empty() || suspected_[part[k]];
      const auto visit = [&](int u, int v) {
        if (u < 0 || v < 0 || u >= columns || v >= rows) return;
        const auto cell = static_cast<std::size_t>(v * columns + u);
        if (!todo[cell]) return;
        todo[cell] = 0;
        part.push_back(cell);
      };
      visit(x - 1, y);
      visit(x + 1, y);
      visit(x, y - 1);
      visit(x, y + 1);
    }
    const double share = double(part.size()) / double(measured);
    largest = std::max(largest, share);
    if (share >= kLeast && (again || kTwo == 0)) {
      moving += part.size();
      continue;
    }
    for (const std::size_t cell : part) {
      moves[cell] = 0;
      out.still[cell] = 1;
    }
  }
  out.share = static_cast<double>(moving) / static_cast<double>(std::max<std::size_t>(1, measured));
  if (debug) std::fprintf(stderr, " share %.3f largest %.3f\n", out.share, largest);
  if (moving == 0) {
    out.share = 0;
    out.still.clear();
    return out;
  }
  out.mask = registration::CellMask(CoarseDepth::kStep_px * SurfaceCheck::kCell, columns, std::move(moves));
  return out;
}

void MovingParts::remember(const Judgement& judgement, const registration::FrameMotion& motion) {
  view_.motion = motion;
  suspected_ = views_.size() < 2 ? std::vector<std::uint8_t>() : judgement.suspected;
  if (suspected_.empty() && views_.size() >= 2) suspected_.assign(static_cast<std::size_t>((view_.depth.width() / SurfaceCheck::kCell) * (view_.depth.height() / SurfaceCheck::kCell)), 0);
  constexpr double kLongest_s = 0.7;
  if (const char* folder = std::getenv("MOVDUMP")) {
    const auto name = std::string(folder) + "/" + std::to_string(view_.frame) + ".pgm";
    std::ofstream out(name, std::ios::binary);
    const auto& m = judgement.mask;
    out << "P5 " << m.columns() << " " << m.rows() << " 1\n";
    for (auto c : m.cells()) out.put(static_cast<char>(c));
  }
  still_ = judgement.still;
  moved_ = judgement.mask.any();
  views_.push_back(view_);
  while (views_.size() > 1 && view_.timestamp_s - views_.front().timestamp_s > kLongest_s) {
    views_.pop_front();
  }
}

}  // namespace sgs::tracker

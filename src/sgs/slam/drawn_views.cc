// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/drawn_views.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <unordered_set>
#include <utility>

#include "sgs/registration/view_distance.h"

namespace sgs::slam {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::size_t kMostSources = 100;  // of a map's views; their neighbours show the same
constexpr std::size_t kSources = 12;       // of one drawing
constexpr double kFarthest_m = 6;          // depth is used to there
// A camera this near to a surface sees little else.
constexpr double kClearance_m = 0.4, kVoxel_m = 0.2;
constexpr double kApart_m = 0.7;  // places
constexpr std::size_t kMostPlaces = 90;
constexpr int kDirections = 8;
// Who is no farther than this from a view is found by it.
constexpr double kFound = 0.45;
constexpr double kLeastShown = 0.4;  // of a picture
constexpr int kLargeWidth_px = 480;
constexpr int kColumns = 20, kRows = 15;  // cells of a glance
constexpr float kWorthDrawing = 4;        // cells: less is not worth another source
// Depths that differ by less are of one surface; a surface that is seen at a smaller angle is not
// seen.
constexpr float kSameDepth = 0.05f, kGrazingCosine = 0.1f;
constexpr float kFacing = 127;  // length of a normal in Source::facing

/// Where there is something, in cubes.
class Occupied {
 public:
  void add(const Vector3d& p) { cubes_.insert(key(cube(p))); }
  bool near(const Vector3d& p) const {
    const int reach = static_cast<int>(kClearance_m / kVoxel_m);
    const Eigen::Vector3i c = cube(p);
    for (int x = -reach; x <= reach; ++x)
      for (int y = -reach; y <= reach; ++y)
        for (int z = -reach; z <= reach; ++z)
          if (cubes_.contains(key(c + Eigen::Vector3i(x, y, z)))) return true;
    return false;
  }

 private:
  static Eigen::Vector3i cube(const Vector3d& p) {
    return (p / kVoxel_m).array().floor().cast<int>();
  }
  static std::uint64_t key(const Eigen::Vector3i& c) {
    constexpr std::uint64_t kMask = (1u << 21) - 1;
    return (static_cast<std::uint64_t>(c.x()) & kMask) << 42 |
           (static_cast<std::uint64_t>(c.y()) & kMask) << 21 |
           (static_cast<std::uint64_t>(c.z()) & kMask);
  }
  std::unordered_set<std::uint64_t> cubes_;
};

bool is_apart(const std::vector<Vector3d>& places, const Vector3d& p) {
  return std::none_of(places.begin(), places.end(),
                      [&](const Vector3d& q) { return (p - q).norm() < kApart_m; });
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct SurfacePatch {
  Vector3f point, normal;  // towards the camera, not of length 1; camera
};

/// To one metre of depth.
Vector3f ray(const PinholeCamera& camera, int u, int v) {
  return {(static_cast<float>(u) - static_cast<float>(camera.cx)) / static_cast<float>(camera.fx),
          (static_cast<float>(v) - static_cast<float>(camera.cy)) / static_cast<float>(camera.fy),
          1};
}

/// What a pixel shows, by the next depths beside and below or above it that are of its surface;
/// empty at corners and without depth. Next to it noise would tilt it.
std::optional<SurfacePatch> patch(const PinholeCamera& camera, const DepthImage& depth, int u,
                                  int v) {
  constexpr int kReach = 6;
  const float z = depth(u, v);
  if (!(z > 0 && z < kFarthest_m)) return std::nullopt;
  const Vector3f p = z * ray(camera, u, v);
  const auto along = [&](int du, int dv) -> std::optional<Vector3f> {
    for (const int sign : {1, -1}) {
      const int x = u + sign * du, y = v + sign * dv;
      if (x < 0 || y < 0 || x >= camera.width || y >= camera.height) continue;
      const float d = depth(x, y);
      if (d > 0 && std::abs(d - z) < 2 * kSameDepth * z)
        return static_cast<float>(sign) * (d * ray(camera, x, y) - p);
    }
    return std::nullopt;
  };
  const auto right = along(kReach, 0), down = along(0, kReach);
  if (!right || !down) return std::nullopt;
  return SurfacePatch{p, down->cross(*right)};
}

bool is_seen(const Vector3f& point, const Vector3f& normal) {
  return -normal.dot(point) > kGrazingCosine * normal.norm() * point.norm();
}

/// A picture that grows: of each pixel the nearest surface, as it is seen best.
struct Drawing {
  explicit Drawing(const PinholeCamera& c)
      : camera(c),
        gray(c.width, c.height, std::uint8_t{0}),
        depth(c.width, c.height, 0.f),
        off_px(c.width, c.height, 0.f) {}
  /// A patch of surface at (x, y), seen in pixels of `wide` of these. Of the patches of one surface
  /// a pixel shows the one that tells best what is in its middle. (Simply the one that was seen
  /// from nearest is, of those that reach a pixel, always the one towards the view it comes from:
  /// seen from opposite, pictures would be a pixel too large.)
  void put(float x, float y, float wide, float z, std::uint8_t g) {
    constexpr float kWidest = 2;
    const auto reach = static_cast<int>(std::min(kWidest, 0.5f * wide));
    const auto u = static_cast<int>(std::lround(x)), v = static_cast<int>(std::lround(y));
    for (int j = std::max(0, v - reach); j <= std::min(camera.height - 1, v + reach); ++j) {
      for (int i = std::max(0, u - reach); i <= std::min(camera.width - 1, u + reach); ++i) {
        float& now = depth(i, j);
        const float off = wide + std::hypot(x - static_cast<float>(i), y - static_cast<float>(j));
        const bool covers = !(now > 0) || z < (1 - kSameDepth) * now;
        const bool nearer = z < (1 + kSameDepth) * now && off < off_px(i, j);
        if (!covers && !nearer) continue;
        now = z;
        off_px(i, j) = off;
        gray(i, j) = g;
      }
    }
  }

  PinholeCamera camera;
  Image<std::uint8_t> gray;
  DepthImage depth;
  Image<float> off_px;
};

/// What a view shows (DrawnViews::Source), as from elsewhere.
template <class Source>
void draw_from(const Source& source, const SE3& T_world_camera, Drawing& drawing) {
  const SE3 T = T_world_camera.inverse() * source.T_world_camera;
  const Eigen::Matrix3f R = T.R.cast<float>();
  const Vector3f t = T.t.cast<float>(), eye = T.inverse().t.cast<float>();  // of who draws
  const PinholeCamera& to = drawing.camera;
  const float zoom = static_cast<float>(to.fx / source.camera.fx);
  const auto fx = static_cast<float>(to.fx), fy = static_cast<float>(to.fy);
  const auto cx = static_cast<float>(to.cx), cy = static_cast<float>(to.cy);
  const auto width = static_cast<float>(to.width), height = static_cast<float>(to.height);
  std::vector<float> across;  // of each column's rays
  for (int u = 0; u < source.camera.width; ++u) across.push_back(ray(source.camera, u, 0).x());
  for (int v = 0; v < source.camera.height; ++v) {
    const float down = ray(source.camera, 0, v).y();
    const Vector3f row = down * R.col(1) + R.col(2);
    for (int u = 0; u < source.camera.width; ++u) {
      const auto& facing = source.facing(u, v);
      if (facing.isZero()) continue;
      const float z = source.depth(u, v), x_ray = across[static_cast<std::size_t>(u)];
      const Vector3f p = z * (x_ray * R.col(0) + row) + t;
      if (!(p.z() > 0.1f)) continue;
      const float one = 1 / p.z();
      const float x = fx * p.x() * one + cx, y = fy * p.y() * one + cy;
      if (!(x > -1 && y > -1 && x < width && y < height)) continue;
      const Vector3f sight = Vector3f(z * x_ray, z * down, z) - eye;
      const float towards = -facing.template cast<float>().dot(sight);
      constexpr float kLeast = kGrazingCosine * kFacing;
      if (!(towards > 0 && towards * towards > kLeast * kLeast * sight.squaredNorm())) continue;
      drawing.put(x, y, zoom * z * one, p.z(), source.gray(u, v));
    }
  }
}

/// Single pixels that no patch has reached, in the middle of others.
void fill_gaps(Drawing& drawing) {
  constexpr int kEnough = 5;  // of eight neighbours
  const Image<std::uint8_t> gray = drawing.gray;
  const DepthImage depth = drawing.depth;
  for (int v = 1; v + 1 < drawing.camera.height; ++v) {
    for (int u = 1; u + 1 < drawing.camera.width; ++u) {
      if (depth(u, v) > 0) continue;
      int count = 0;
      float z = 0, g = 0;
      for (int k = 0; k < 9; ++k) {
        const int x = u + k % 3 - 1, y = v + k / 3 - 1;
        if (!(depth(x, y) > 0)) continue;
        ++count;
        z += depth(x, y);
        g += static_cast<float>(gray(x, y));
      }
      if (count < kEnough) continue;
      drawing.depth(u, v) = z / static_cast<float>(count);
      drawing.gray(u, v) = static_cast<std::uint8_t>(g / static_cast<float>(count) + 0.5f);
    }
  }
}

/// As a frame of a camera of the same or of twice the size.
RgbdFrame enlarged(const Drawing& drawing, const PinholeCamera& camera) {
  RgbdFrame frame;
  frame.camera = camera;
  frame.color = ColorImage(camera.width, camera.height);
  frame.depth = DepthImage(camera.width, camera.height, 0.f);
  PixelMask seen(camera.width, camera.height, std::uint8_t{0});
  const double scale = drawing.camera.fx / camera.fx;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const double x = scale * (u + 0.5) - 0.5, y = scale * (v + 0.5) - 0.5;
      const int a = std::clamp(static_cast<int>(std::floor(x)), 0, drawing.camera.width - 2);
      const int b = std::clamp(static_cast<int>(std::floor(y)), 0, drawing.camera.height - 2);
      const float s = std::clamp(static_cast<float>(x - a), 0.f, 1.f);
      const float t = std::clamp(static_cast<float>(y - b), 0.f, 1.f);
      float gray = 0, depth = 0;
      bool whole = true;
      for (int k = 0; k < 4; ++k) {
        const float weight = (k % 2 == 0 ? 1 - s : s) * (k / 2 == 0 ? 1 - t : t);
        const float z = drawing.depth(a + k % 2, b + k / 2);
        whole = whole && z > 0 && std::abs(z - drawing.depth(a, b)) < kSameDepth * z;
        depth += weight * z;
        gray += weight * static_cast<float>(drawing.gray(a + k % 2, b + k / 2));
      }
      if (!whole) continue;
      const auto g = static_cast<std::uint8_t>(gray + 0.5f);
      frame.color(u, v) = {g, g, g};
      frame.depth(u, v) = depth;
      seen(u, v) = 1;
    }
  }
  frame.seen = std::make_shared<const PixelMask>(std::move(seen));
  return frame;
}

}  // namespace

DrawnViews::DrawnViews(const PinholeCamera& camera, std::size_t views, std::size_t most)
    : camera_(camera), most_(most), every_((views + kMostSources - 1) / kMostSources) {}

void DrawnViews::know(const alignment::KnownView& view) {
  if (most_ == 0) return;
  const SE3& T = view.T_world_camera;
  const double depth_m = registration::mean_depth(view.frame.depth, kFarthest_m);
  if (!(depth_m > 0)) return;
  taken_.push_back({T, depth_m});
  fern_seed_ = view.fern_seed;
  if (known_++ % every_ != 0) return;
  Source source = source_of(view);
  for (int k = 0; k < kColumns * kRows; ++k) {
    const int u = (2 * (k % kColumns) + 1) * source.camera.width / (2 * kColumns);
    const int v = (2 * (k / kColumns) + 1) * source.camera.height / (2 * kRows);
    const auto p = patch(source.camera, source.depth, u, v);
    if (!p) continue;
    const Vector3d world = T * p->point.cast<double>();
    patches_.push_back({world.cast<float>(), (T.R * p->normal.cast<double>()).cast<float>(),
                        p->point.z(), static_cast<std::uint32_t>(sources_.size())});
    if (k % 7 != 0) continue;
    for (const double share : {0.3, 0.6}) seen_through_.push_back(T.t + share * (world - T.t));
  }
  sources_.push_back(std::move(source));
}

DrawnViews::Source DrawnViews::source_of(const alignment::KnownView& view) {
  const RgbdFrame& frame = view.frame;
  const int width = frame.camera.width, height = frame.camera.height;
  Source out{view.T_world_camera, frame.camera, Image<std::uint8_t>(width, height), frame.depth,
             Image<Facing>(width, height, Facing::Zero())};
  for (std::size_t i = 0; i < frame.color.size(); ++i) {
    const Rgb8& c = frame.color.data()[i];
    out.gray.data()[i] = static_cast<std::uint8_t>((2 * c.r + 5 * c.g + c.b + 4) / 8);
    if (frame.seen && frame.seen->data()[i] == 0) out.depth.data()[i] = 0;
  }
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const auto p = patch(out.camera, out.depth, u, v);
      if (!p) continue;
      out.facing(u, v) = (kFacing * p->normal.normalized()).array().round().cast<std::int8_t>();
    }
  }
  return out;
}

// As the cameras were held in the mean.
Vector3d DrawnViews::up() const {
  Vector3d sum = Vector3d::Zero();
  for (const Taken& t : taken_) sum -= t.T_world_camera.R.col(1);
  return sum.norm() > 0 ? Vector3d(sum.normalized()) : Vector3d(Vector3d::UnitZ());
}

// Where cameras were, and what they have seen through at about their height.
std::vector<Vector3d> DrawnViews::places() const {
  constexpr double kHigher_m = 0.3;
  Occupied occupied;
  for (const Patch& p : patches_) occupied.add(p.point.cast<double>());
  const Vector3d z = up();
  std::vector<Vector3d> out;
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const Taken& t : taken_) {
    const Vector3d& p = t.T_world_camera.t;
    lowest = std::min(lowest, z.dot(p));
    highest = std::max(highest, z.dot(p));
    if (is_apart(out, p)) out.push_back(p);
  }
  for (const Vector3d& p : seen_through_) {
    const double height = z.dot(p);
    if (height < lowest - kHigher_m || height > highest + kHigher_m) continue;
    if (is_apart(out, p) && !occupied.near(p)) out.push_back(p);
  }
  if (out.size() <= kMostPlaces) return out;
  std::vector<Vector3d> some;  // evenly, where there are too many
  for (std::size_t k = 0; k < kMostPlaces; ++k) some.push_back(out[k * out.size() / kMostPlaces]);
  return some;
}

// All around, upright, as far down as cameras have looked here; beginning with the first view's
// direction.
std::vector<Eigen::Matrix3d> DrawnViews::ways_to_look() const {
  const Vector3d z = up();
  std::vector<double> rise;
  for (const Taken& t : taken_) rise.push_back(z.dot(t.T_world_camera.R.col(2)));
  const double sine = std::clamp(median(rise), -0.9, 0.9), cosine = std::sqrt(1 - sine * sine);
  const Vector3d ahead = taken_.front().T_world_camera.R.col(2);
  const Vector3d level = ahead - z.dot(ahead) * z;
  const Vector3d x = level.norm() > 0.1 ? Vector3d(level.normalized()) : z.unitOrthogonal();
  std::vector<Eigen::Matrix3d> out;
  for (int k = 0; k < kDirections; ++k) {
    const double yaw = 2 * std::numbers::pi * k / kDirections;
    const Vector3d forward = cosine * (std::cos(yaw) * x + std::sin(yaw) * z.cross(x)) + sine * z;
    const Vector3d right = forward.cross(z).normalized();
    Eigen::Matrix3d R;
    R << right, forward.cross(right), forward;
    out.push_back(R);
  }
  return out;
}

bool DrawnViews::is_taken(const SE3& T_world_camera) const {
  return std::any_of(taken_.begin(), taken_.end(), [&](const Taken& t) {
    return registration::view_distance(camera_, t.mean_depth_m,
                                       t.T_world_camera.inverse() * T_world_camera) < kFound;
  });
}

// How much of a picture from there the sources show, by a few hundred patches of each, and which of
// them: one after the other that which shows most of what those before do not, or do not show as
// well. Errors of depth grow with its square: a wall that was seen from afar along itself is drawn
// centimetres off along itself.
DrawnViews::Candidate DrawnViews::glance(const SE3& T_world_camera) const {
  Candidate out{T_world_camera, 0, {}};
  const SE3 T = T_world_camera.inverse();
  const Eigen::Matrix3f R = T.R.cast<float>();
  const Vector3f t = T.t.cast<float>();
  struct Hit {
    std::size_t cell;
    float z, seen_from_m;
    std::uint32_t source;
  };
  std::vector<Hit> hits;
  std::vector<float> nearest(kColumns * kRows, std::numeric_limits<float>::infinity());
  for (const Patch& patch : patches_) {
    const Vector3f p = R * patch.point + t;
    if (!(p.z() > 0.1f && p.z() < kFarthest_m) || !is_seen(p, R * patch.normal)) continue;
    const Eigen::Vector2d uv = camera_.project(p.cast<double>());
    if (!(uv.x() >= 0 && uv.y() >= 0 && uv.x() < camera_.width && uv.y() < camera_.height))
      continue;
    const auto cell =
        static_cast<std::size_t>(static_cast<int>(uv.y() * kRows / camera_.height) * kColumns +
                                 static_cast<int>(uv.x() * kColumns / camera_.width));
    hits.push_back({cell, p.z(), patch.seen_from_m, patch.source});
    nearest[cell] = std::min(nearest[cell], p.z());
  }
  // A cell is wide: what lies behind its nearest patch by a quarter may be seen beside it.
  constexpr float kBehind = 1.25f;
  std::erase_if(hits, [&](const Hit& h) { return h.z > kBehind * nearest[h.cell]; });
  std::vector<float> from_m(nearest.size(), std::numeric_limits<float>::infinity());
  for (const Hit& h : hits) from_m[h.cell] = std::min(from_m[h.cell], h.seen_from_m);
  const std::size_t cells = nearest.size();
  std::vector<float> shows(sources_.size() * cells, 0);  // how well: 1 as the best does
  for (const Hit& h : hits) {
    float& best = shows[h.source * cells + h.cell];
    best = std::max(best, from_m[h.cell] * from_m[h.cell] / (h.seen_from_m * h.seen_from_m));
  }
  std::vector<float> shown(cells, 0);
  while (out.sources.size() < kSources) {
    float most = 0;
    std::size_t best = 0;
    for (std::size_t s = 0; s < sources_.size(); ++s) {
      float gain = 0;
      for (std::size_t c = 0; c < cells; ++c) {
        gain += std::max(0.f, shows[s * cells + c] - shown[c]);
      }
      if (gain <= most) continue;
      most = gain;
      best = s;
    }
    if (most < kWorthDrawing) break;
    for (std::size_t c = 0; c < cells; ++c) shown[c] = std::max(shown[c], shows[best * cells + c]);
    out.sources.push_back(static_cast<std::uint32_t>(best));
  }
  out.shown = static_cast<double>(std::count_if(shown.begin(), shown.end(),
                                                [](float how_well) { return how_well > 0; })) /
              static_cast<double>(cells);
  return out;
}

alignment::KnownView DrawnViews::compose(const Candidate& candidate) const {
  // Smaller: surfaces that were seen at a small angle have few pixels, and these are far apart.
  Drawing drawing(camera_.width >= kLargeWidth_px ? camera_.halved(1) : camera_);
  for (const std::uint32_t source : candidate.sources) {
    draw_from(sources_[source], candidate.T_world_camera, drawing);
  }
  fill_gaps(drawing);
  alignment::KnownView view;
  view.drawn = true;
  view.T_world_camera = candidate.T_world_camera;
  view.timestamp_s = std::numeric_limits<double>::quiet_NaN();
  view.frame = enlarged(drawing, camera_);
  view.fern_seed = fern_seed_;
  view.ferns = features::Ferns(fern_seed_).code(view.frame);
  return view;
}

void DrawnViews::draw(ThreadPool& pool,
                      const std::function<void(const alignment::KnownView&)>& visit) const {
  if (taken_.empty()) return;
  std::vector<SE3> asked;
  const auto ways = ways_to_look();
  for (const Vector3d& place : places()) {
    for (const Eigen::Matrix3d& R : ways) {
      const SE3 T(R, place);
      if (!is_taken(T)) asked.push_back(T);
    }
  }
  std::vector<Candidate> candidates(asked.size());
  pool.run(static_cast<int>(asked.size()), [&](int i, int) {
    candidates[static_cast<std::size_t>(i)] = glance(asked[static_cast<std::size_t>(i)]);
  });
  std::erase_if(candidates, [](const Candidate& c) { return c.shown < kLeastShown; });
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.shown > b.shown; });
  if (candidates.size() > most_) candidates.resize(most_);
  // As many at a time as threads can draw: all of them together would fill the memory.
  const std::size_t batch = 4 * static_cast<std::size_t>(pool.threads());
  std::vector<alignment::KnownView> views;
  for (std::size_t first = 0; first < candidates.size(); first += batch) {
    views.assign(std::min(batch, candidates.size() - first), {});
    pool.run(static_cast<int>(views.size()), [&](int i, int) {
      const auto k = static_cast<std::size_t>(i);
      views[k] = compose(candidates[first + k]);
    });
    for (const alignment::KnownView& view : views) visit(view);
  }
}

}  // namespace sgs::slam

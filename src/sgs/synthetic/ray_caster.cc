// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/ray_caster.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sgs/synthetic/source.h"

namespace sgs::synthetic {

namespace {

constexpr int kTile = 16;
constexpr std::uint16_t kNothing = 0xffff;
constexpr float kFar = 1e9f, kNear = 0.01f;

// Rays of one row of a tile: origin o, directions of unit length along the optical axis, so that
// the ray parameter is the depth. Their dot products with a vector are asked for as a function of
// the pixel in the tile.

// Those of a pinhole: base + x * step.
struct StraightRays {
  Eigen::Vector3f o, base, step;
  int x0;

  struct Dot {
    float base, step;
    int x0;
    float operator()(int i) const { return base + static_cast<float>(x0 + i) * step; }
  };
  Dot dot(const Eigen::Vector3f& v) const { return {v.dot(base), v.dot(step), x0}; }
  Eigen::Vector3f direction(int i) const { return base + static_cast<float>(x0 + i) * step; }
};

// Those behind a lens: from a table.
struct BentRays {
  Eigen::Vector3f o;
  Eigen::Matrix3f R;
  const float *x, *y;  // of the tile's first pixel

  struct Dot {
    float a, b, c;
    const float *x, *y;
    float operator()(int i) const { return a * x[i] + b * y[i] + c; }
  };
  Dot dot(const Eigen::Vector3f& v) const {
    const Eigen::Vector3f w = R.transpose() * v;
    return {w.x(), w.y(), w.z(), x, y};
  }
  Eigen::Vector3f direction(int i) const { return R * Eigen::Vector3f(x[i], y[i], 1); }
};

struct TileHits {
  alignas(64) std::array<float, kTile> t;
  alignas(64) std::array<std::int32_t, kTile> id;
};

StraightRays straight_rays(const RayRequest& request, const SE3& pose, int x0, int y) {
  const PinholeCamera& camera = request.camera;
  const Eigen::Vector2d& shift = request.shift_px;
  const Eigen::Vector3d base((shift.x() - camera.cx) / camera.fx,
                             (y + shift.y() - camera.cy) / camera.fy, 1);
  return {pose.t.cast<float>(), (pose.R * base).cast<float>(),
          (pose.R.col(0) / camera.fx).cast<float>(), x0};
}

BentRays bent_rays(const LensRays& lens, const SE3& pose, int x0, int y) {
  return {pose.t.cast<float>(), pose.R.cast<float>(), lens.x(y) + x0, lens.y(y) + x0};
}

template <class Rays>
void hit_quad(const Primitive& p, int id, const Rays& r, int count, TileHits& hits) {
  const Eigen::Vector3f c = p.centre - r.o;
  const float k = p.n.dot(c);
  if (!p.two_sided && k >= 0) return;
  const auto n = r.dot(p.n), u = r.dot(p.u), v = r.dot(p.v);
  const float uc = p.u.dot(c), vc = p.v.dot(c);
  for (int i = 0; i < count; ++i) {
    const float t = k / n(i);
    const float a = std::abs(t * u(i) - uc), b = std::abs(t * v(i) - vc);
    const std::size_t j = static_cast<std::size_t>(i);
    const bool better = (t > kNear) & (t < hits.t[j]) & (a <= p.half_u) & (b <= p.half_v);
    hits.t[j] = better ? t : hits.t[j];
    hits.id[j] = better ? id : hits.id[j];
  }
}

// A ray meets a capsule where it meets the endless cylinder around the axis, between the caps, or
// else the sphere at the end on whose side that was.
float hit_capsule(const Primitive& p, const Eigen::Vector3f& o, const Eigen::Vector3f& d) {
  const Eigen::Vector3f c = o - p.centre;
  const float along_o = c.dot(p.u), along_d = d.dot(p.u);
  const Eigen::Vector3f c_side = c - along_o * p.u, d_side = d - along_d * p.u;
  const float aa = d_side.squaredNorm(), bb = c_side.dot(d_side);
  const float cc = c_side.squaredNorm() - p.radius * p.radius;
  const float q = bb * bb - aa * cc;
  if (q < 0) return kFar;
  constexpr float kParallel = 1e-9f;
  const float t = aa > kParallel ? (-bb - std::sqrt(q)) / aa : 0;
  const float along = along_o + t * along_d;
  if (aa > kParallel && std::abs(along) <= p.half_height) return t > kNear ? t : kFar;
  const bool top = aa > kParallel ? along > 0 : along_d < 0;
  const Eigen::Vector3f s = c - (top ? p.half_height : -p.half_height) * p.u;
  const float sa = d.squaredNorm(), sb = s.dot(d), sc = s.squaredNorm() - p.radius * p.radius;
  const float sq = sb * sb - sa * sc;
  if (sq < 0) return kFar;
  const float ts = (-sb - std::sqrt(sq)) / sa;
  return ts > kNear ? ts : kFar;
}

// Nearest positive ray parameter at which the ray meets a curved primitive, or kFar.
float hit_curved(const Primitive& p, const Eigen::Vector3f& o, const Eigen::Vector3f& d) {
  if (p.kind == Primitive::Kind::kCapsule) return hit_capsule(p, o, d);
  const Eigen::Vector3f c = o - p.centre;
  const bool sphere = p.kind == Primitive::Kind::kSphere;
  const float aa = sphere ? d.squaredNorm() : d.head<2>().squaredNorm();
  const float bb = sphere ? c.dot(d) : c.head<2>().dot(d.head<2>());
  const float cc = (sphere ? c.squaredNorm() : c.head<2>().squaredNorm()) - p.radius * p.radius;
  if (!sphere && d.z() < 0) {
    const float t = (p.half_height - c.z()) / d.z();
    if (t > kNear && (c + t * d).head<2>().squaredNorm() <= p.radius * p.radius) return t;
  }
  const float q = bb * bb - aa * cc;
  if (q < 0) return kFar;
  const float t = (-bb - std::sqrt(q)) / aa;
  if (t <= kNear || (!sphere && std::abs(c.z() + t * d.z()) > p.half_height)) return kFar;
  return t;
}

// The scene's, then the movers'.
class Surfaces {
 public:
  Surfaces(const Scene& scene, std::span<const Primitive> movers)
      : still_(scene.primitives), movers_(movers) {}
  std::size_t size() const { return still_.size() + movers_.size(); }
  const Primitive& operator[](std::size_t i) const {
    return i < still_.size() ? still_[i] : movers_[i - still_.size()];
  }

 private:
  std::span<const Primitive> still_, movers_;
};

template <class Rays>
void hit_row(const Surfaces& surfaces, const std::vector<int>& list, const Rays& r, int count,
             TileHits& hits) {
  hits.t.fill(kFar);
  hits.id.fill(-1);
  for (int id : list) {
    const Primitive& p = surfaces[static_cast<std::size_t>(id)];
    if (p.kind == Primitive::Kind::kQuad) {
      hit_quad(p, id, r, count, hits);
      continue;
    }
    for (int i = 0; i < count; ++i) {
      const std::size_t j = static_cast<std::size_t>(i);
      const float t = hit_curved(p, r.o, r.direction(i));
      if (t < hits.t[j]) hits.t[j] = t, hits.id[j] = id;
    }
  }
}

// What a part of the image sees: limits of x / z or y / z, in pixels from the principal point.
struct Field {
  float least, most;
};

// Rows [from, to) or columns, six more on either side: two pixels hold what the shutter rolls by
// within a strip, four the shift.
Field straight_field(int from, int to, double centre) {
  return {float(from - 6 - centre), float(to + 6 - centre)};
}

Field bent_field(const std::vector<const float*>& rows, int from, int to, double focal) {
  Field field{1e9f, -1e9f};
  for (const float* row : rows)
    for (int x = from; x < to; ++x) {
      if (std::isnan(row[x])) continue;
      field.least = std::min(field.least, row[x] * float(focal) - 6);
      field.most = std::max(field.most, row[x] * float(focal) + 6);
    }
  return field;
}

// The fields of a strip and of its tiles.
class StripFields {
 public:
  StripFields(const RayRequest& request, int y0, int y1) : request_(request), y0_(y0), y1_(y1) {
    if (request.lens == nullptr) return;
    for (int y = y0; y < y1; ++y) {
      x_.push_back(request.lens->x(y));
      y_.push_back(request.lens->y(y));
    }
  }
  Field rows() const {
    const PinholeCamera& c = request_.camera;
    return request_.lens == nullptr ? straight_field(y0_, y1_, c.cy)
                                    : bent_field(y_, 0, c.width, c.fy);
  }
  Field columns(int from, int to) const {
    const PinholeCamera& c = request_.camera;
    return request_.lens == nullptr ? straight_field(from, to, c.cx)
                                    : bent_field(x_, from, to, c.fx);
  }

 private:
  const RayRequest& request_;
  int y0_, y1_;
  std::vector<const float*> x_, y_;
};

// The hull of every primitive in the camera frame of a strip of rows, for culling tiles.
class StripCuller {
 public:
  StripCuller(const Surfaces& surfaces, const PinholeCamera& camera, const SE3& pose,
              const Field& rows)
      : camera_(camera) {
    const Eigen::Matrix3f R = pose.R.transpose().cast<float>();
    const Eigen::Vector3f t = pose.t.cast<float>();
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      Entry entry{static_cast<int>(i), surfaces[i].hull()};
      for (Eigen::Vector3f& p : entry.hull) p = R * (p - t);
      if (!outside(entry, 1, rows, float(camera.fy))) entries_.push_back(std::move(entry));
    }
  }
  void tile(const Field& columns, std::vector<int>& list) const {
    list.clear();
    for (const Entry& e : entries_)
      if (!outside(e, 0, columns, float(camera_.fx))) list.push_back(e.id);
  }

 private:
  struct Entry {
    int id;
    std::vector<Eigen::Vector3f> hull;
  };
  static bool outside(const Entry& e, int axis, const Field& field, float f) {
    bool all_low = true, all_high = true, all_behind = true;
    for (const Eigen::Vector3f& p : e.hull) {
      all_low &= f * p[axis] < field.least * p.z();
      all_high &= f * p[axis] > field.most * p.z();
      all_behind &= p.z() < kNear;
    }
    return all_low || all_high || all_behind;
  }
  PinholeCamera camera_;
  std::vector<Entry> entries_;
};

Eigen::Array4f shade(const Scene& scene, const Primitive& p, const Eigen::Vector3f& point,
                     Eigen::Vector3f normal, float cosine, float pixel_m) {
  const Eigen::Vector2f uv = p.surface_uv(point);
  // Geometric mean of the two axes of the pixel's footprint.
  const float footprint = pixel_m / std::sqrt(std::max(cosine, 0.05f));
  Rgb color = p.tint;
  if (p.texture) color *= p.texture->sample(uv.x(), uv.y(), footprint);
  color *= p.glow > 0 ? p.glow : scene.irradiance(point, normal);
  return {color[0], color[1], color[2], 0.f};
}

}  // namespace

namespace {

// Light that the paint throws back, as the infrared camera's windows of some pixels average it.
float paint_luma(const Primitive& p, const Eigen::Vector3f& point, float pixel_m) {
  constexpr float kWindow_px = 7;
  Rgb color = p.tint;
  if (p.texture) {
    const Eigen::Vector2f uv = p.surface_uv(point);
    color *= p.texture->sample(uv.x(), uv.y(), kWindow_px * pixel_m);
  }
  return 0.299f * color[0] + 0.587f * color[1] + 0.114f * color[2];
}

template <class Rays>
void fill_pixel(const Scene& scene, const RayRequest& request, const Rays& rays, int i,
                const TileHits& hits, std::size_t pixel, RayImage& out) {
  const std::size_t j = static_cast<std::size_t>(i);
  const Primitive& p = Surfaces(scene, request.movers)[static_cast<std::size_t>(hits.id[j])];
  const Eigen::Vector3f d = rays.direction(i);
  const Eigen::Vector3f point = rays.o + hits.t[j] * d;
  Eigen::Vector3f normal = p.normal(point);
  float cosine = -normal.dot(d) / d.norm();
  if (cosine < 0) normal = -normal, cosine = -cosine;
  out.depth[pixel] = hits.t[j];
  out.cosine[pixel] = cosine;
  out.surface[pixel] = static_cast<std::uint16_t>(hits.id[j]);
  const float pixel_m = hits.t[j] / static_cast<float>(request.camera.fx);
  if (request.with_color) out.color[pixel] = shade(scene, p, point, normal, cosine, pixel_m);
  if (request.with_paint) out.paint[pixel] = paint_luma(p, point, pixel_m);
}

template <class Rays>
void fill_row(const Scene& scene, const RayRequest& request, const std::vector<int>& list,
              const Rays& rays, int count, std::size_t first, TileHits& hits, RayImage& out) {
  hit_row(Surfaces(scene, request.movers), list, rays, count, hits);
  for (int i = 0; i < count; ++i) {
    if (hits.id[static_cast<std::size_t>(i)] < 0) continue;
    fill_pixel(scene, request, rays, i, hits, first + static_cast<std::size_t>(i), out);
  }
}

}  // namespace

RayImage cast_rays(const Scene& scene, const RayRequest& request, ThreadPool& pool) {
  const int w = request.camera.width, h = request.camera.height;
  const std::size_t n = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
  RayImage out{w,
               h,
               std::vector<float>(n, 0.f),
               std::vector<float>(n, 0.f),
               std::vector<std::uint16_t>(n, kNothing),
               {},
               {}};
  if (request.with_color) out.color.assign(n, Eigen::Array4f::Zero());
  if (request.with_paint) out.paint.assign(n, 0.f);
  const auto pose_of = [&](int y) -> const SE3& {
    const auto& poses = request.row_poses;
    return poses.size() == 1 ? poses[0] : poses[static_cast<std::size_t>(y)];
  };
  pool.run((h + kTile - 1) / kTile, [&](int strip, int) {
    const int y0 = strip * kTile, y1 = std::min(h, y0 + kTile);
    const StripFields fields(request, y0, y1);
    const StripCuller culler(Surfaces(scene, request.movers), request.camera,
                             pose_of((y0 + y1) / 2), fields.rows());
    std::vector<int> list;
    TileHits hits;
    for (int x0 = 0; x0 < w; x0 += kTile) {
      const int count = std::min(kTile, w - x0);
      culler.tile(fields.columns(x0, x0 + count), list);
      for (int y = y0; y < y1; ++y) {
        const std::size_t first = static_cast<std::size_t>(y) * static_cast<std::size_t>(w) +
                                  static_cast<std::size_t>(x0);
        if (request.lens == nullptr)
          fill_row(scene, request, list, straight_rays(request, pose_of(y), x0, y), count, first,
                   hits, out);
        else
          fill_row(scene, request, list, bent_rays(*request.lens, pose_of(y), x0, y), count, first,
                   hits, out);
      }
    }
  });
  return out;
}

void smooth_silhouettes(RayImage& image, ThreadPool& pool) {
  const int w = image.width, h = image.height;
  const std::vector<Eigen::Array4f> sharp = image.color;
  pool.run((h + kTile - 1) / kTile, [&](int strip, int) {
    for (int y = std::max(1, strip * kTile); y < std::min(h - 1, (strip + 1) * kTile); ++y)
      for (int x = 1; x + 1 < w; ++x) {
        const std::ptrdiff_t i = std::ptrdiff_t{y} * w + x;
        const std::uint16_t* s = image.surface.data() + i;
        if (s[0] == s[1] && s[0] == s[-1] && s[0] == s[w] && s[0] == s[-w]) continue;
        const Eigen::Array4f* c = sharp.data() + i;
        image.color[static_cast<std::size_t>(i)] = (4 * c[0] + 2 * (c[1] + c[-1] + c[w] + c[-w]) +
                                                    c[w + 1] + c[w - 1] + c[-w + 1] + c[-w - 1]) /
                                                   16;
      }
  });
}

ExactView render_exact(const Scene& scene, const PinholeCamera& camera, const SE3& T_world_camera,
                       ThreadPool& pool) {
  RayRequest request{camera, {T_world_camera}};
  request.with_color = true;
  const RayImage rays = cast_rays(scene, request, pool);
  const int w = camera.width, h = camera.height;
  ExactView view{ColorImage(w, h), DepthImage(w, h),
                 Image<Eigen::Vector3f>(w, h, Eigen::Vector3f::Zero())};
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const std::size_t i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(w) + static_cast<std::size_t>(x);
      const Eigen::Array4f c = rays.color[i].max(0.f).min(1.f) * 255 + 0.5f;
      view.color(x, y) = {static_cast<std::uint8_t>(c[0]), static_cast<std::uint8_t>(c[1]),
                          static_cast<std::uint8_t>(c[2])};
      view.depth(x, y) = rays.depth[i];
      if (rays.surface[i] == kNothing) continue;
      const Eigen::Vector3d p = camera.back_project(x, y, double{rays.depth[i]});
      const Eigen::Vector3f n =
          scene.primitives[rays.surface[i]].normal((T_world_camera * p).cast<float>());
      const Eigen::Vector3f n_camera = T_world_camera.R.transpose().cast<float>() * n;
      view.normals(x, y) = n_camera.dot(p.cast<float>()) > 0 ? -n_camera : n_camera;
    }
  return view;
}

}  // namespace sgs::synthetic

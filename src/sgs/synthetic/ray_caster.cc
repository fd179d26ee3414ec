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

// Rays of one image row: origin o, direction base + x * step, of unit length along the optical
// axis, so that the ray parameter is the depth.
struct RowRays {
  Eigen::Vector3f o, base, step;
};

struct TileHits {
  alignas(64) std::array<float, kTile> t;
  alignas(64) std::array<std::int32_t, kTile> id;
};

RowRays rays_of_row(const PinholeCamera& camera, const SE3& pose, const Eigen::Vector2d& shift,
                    int y) {
  const Eigen::Vector3d base((shift.x() - camera.cx) / camera.fx,
                             (y + shift.y() - camera.cy) / camera.fy, 1);
  return {pose.t.cast<float>(), (pose.R * base).cast<float>(),
          (pose.R.col(0) / camera.fx).cast<float>()};
}

void hit_quad(const Primitive& p, int id, const RowRays& r, int x0, int count, TileHits& hits) {
  const Eigen::Vector3f c = p.centre - r.o;
  const float k = p.n.dot(c);
  if (!p.two_sided && k >= 0) return;
  const float nb = p.n.dot(r.base), ns = p.n.dot(r.step);
  const float ub = p.u.dot(r.base), us = p.u.dot(r.step), uc = p.u.dot(c);
  const float vb = p.v.dot(r.base), vs = p.v.dot(r.step), vc = p.v.dot(c);
  for (int i = 0; i < count; ++i) {
    const float x = static_cast<float>(x0 + i);
    const float t = k / (nb + x * ns);
    const float a = std::abs(t * (ub + x * us) - uc), b = std::abs(t * (vb + x * vs) - vc);
    const std::size_t j = static_cast<std::size_t>(i);
    const bool better = (t > kNear) & (t < hits.t[j]) & (a <= p.half_u) & (b <= p.half_v);
    hits.t[j] = better ? t : hits.t[j];
    hits.id[j] = better ? id : hits.id[j];
  }
}

// Nearest positive ray parameter at which the ray meets a curved primitive, or kFar.
float hit_curved(const Primitive& p, const Eigen::Vector3f& o, const Eigen::Vector3f& d) {
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

void hit_row(const Scene& scene, const std::vector<int>& list, const RowRays& r, int x0, int count,
             TileHits& hits) {
  hits.t.fill(kFar);
  hits.id.fill(-1);
  for (int id : list) {
    const Primitive& p = scene.primitives[static_cast<std::size_t>(id)];
    if (p.kind == Primitive::Kind::kQuad) {
      hit_quad(p, id, r, x0, count, hits);
      continue;
    }
    for (int i = 0; i < count; ++i) {
      const std::size_t j = static_cast<std::size_t>(i);
      const float t = hit_curved(p, r.o, r.base + static_cast<float>(x0 + i) * r.step);
      if (t < hits.t[j]) hits.t[j] = t, hits.id[j] = id;
    }
  }
}

// The hull of every primitive in the camera frame of a strip of rows, for culling tiles.
class StripCuller {
 public:
  StripCuller(const Scene& scene, const PinholeCamera& camera, const SE3& pose, double y0,
              double y1)
      : camera_(camera) {
    const Eigen::Matrix3f R = pose.R.transpose().cast<float>();
    const Eigen::Vector3f t = pose.t.cast<float>();
    for (std::size_t i = 0; i < scene.primitives.size(); ++i) {
      Entry entry{static_cast<int>(i), scene.primitives[i].hull()};
      for (Eigen::Vector3f& p : entry.hull) p = R * (p - t);
      if (!outside(entry, 1, float(y0 - camera.cy), float(y1 - camera.cy), float(camera.fy)))
        entries_.push_back(std::move(entry));
    }
  }
  void tile(double x0, double x1, std::vector<int>& list) const {
    list.clear();
    for (const Entry& e : entries_)
      if (!outside(e, 0, float(x0 - camera_.cx), float(x1 - camera_.cx), float(camera_.fx)))
        list.push_back(e.id);
  }

 private:
  struct Entry {
    int id;
    std::vector<Eigen::Vector3f> hull;
  };
  static bool outside(const Entry& e, int axis, float lo, float hi, float f) {
    bool all_low = true, all_high = true, all_behind = true;
    for (const Eigen::Vector3f& p : e.hull) {
      all_low &= f * p[axis] < lo * p.z();
      all_high &= f * p[axis] > hi * p.z();
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

RayImage cast_rays(const Scene& scene, const PinholeCamera& camera,
                   const std::vector<SE3>& row_poses, const Eigen::Vector2d& shift_px,
                   bool with_color, ThreadPool& pool) {
  const int w = camera.width, h = camera.height;
  const std::size_t n = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
  RayImage out{w,
               h,
               std::vector<float>(n, 0.f),
               std::vector<float>(n, 0.f),
               std::vector<std::uint16_t>(n, kNothing),
               {}};
  if (with_color) out.color.assign(n, Eigen::Array4f::Zero());
  const auto pose_of = [&](int y) -> const SE3& {
    return row_poses.size() == 1 ? row_poses[0] : row_poses[static_cast<std::size_t>(y)];
  };
  pool.run((h + kTile - 1) / kTile, [&](int strip, int) {
    const int y0 = strip * kTile, y1 = std::min(h, y0 + kTile);
    // Two pixels of margin hold what the shutter rolls by within a strip, four the shift.
    const StripCuller culler(scene, camera, pose_of((y0 + y1) / 2), y0 - 6, y1 + 6);
    std::vector<int> list;
    TileHits hits;
    for (int x0 = 0; x0 < w; x0 += kTile) {
      const int count = std::min(kTile, w - x0);
      culler.tile(x0 - 6, x0 + count + 6, list);
      for (int y = y0; y < y1; ++y) {
        const RowRays rays = rays_of_row(camera, pose_of(y), shift_px, y);
        hit_row(scene, list, rays, x0, count, hits);
        for (int i = 0; i < count; ++i) {
          const std::size_t j = static_cast<std::size_t>(i);
          if (hits.id[j] < 0) continue;
          const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(w) +
                                    static_cast<std::size_t>(x0 + i);
          const Primitive& p = scene.primitives[static_cast<std::size_t>(hits.id[j])];
          const Eigen::Vector3f d = rays.base + static_cast<float>(x0 + i) * rays.step;
          const Eigen::Vector3f point = rays.o + hits.t[j] * d;
          Eigen::Vector3f normal = p.normal(point);
          float cosine = -normal.dot(d) / d.norm();
          if (cosine < 0) normal = -normal, cosine = -cosine;
          out.depth[pixel] = hits.t[j];
          out.cosine[pixel] = cosine;
          out.surface[pixel] = static_cast<std::uint16_t>(hits.id[j]);
          if (with_color)
            out.color[pixel] =
                shade(scene, p, point, normal, cosine, hits.t[j] / static_cast<float>(camera.fx));
        }
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
  const RayImage rays = cast_rays(scene, camera, {T_world_camera}, {0, 0}, true, pool);
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

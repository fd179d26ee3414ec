// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/canvas.h"

#include <limits>

#include "sgs/core/error.h"

namespace sgs::synthetic {

namespace {

struct Box {
  int x0, y0, x1, y1;  // inclusive
};

Box clip(const Canvas& c, float x0, float y0, float x1, float y1) {
  const auto limit = [](float v, int size) {
    return static_cast<int>(std::clamp(v, -1.f, static_cast<float>(size)));
  };
  return {std::max(0, limit(std::floor(x0 - 1), c.width())),
          std::max(0, limit(std::floor(y0 - 1), c.height())),
          std::min(c.width() - 1, limit(std::ceil(x1 + 1), c.width())),
          std::min(c.height() - 1, limit(std::ceil(y1 + 1), c.height()))};
}

// Coverage of a texel whose centre lies `distance` inside (positive) an edge.
float coverage(float distance) { return std::clamp(distance + 0.5f, 0.f, 1.f); }

int mirror(int i, int size) {
  if (i < 0) i = -1 - i;
  if (i >= size) i = 2 * size - 1 - i;
  return std::clamp(i, 0, size - 1);
}

Eigen::Array4f load(const Canvas::Texel& t) {
  return {float(t.c[0]), float(t.c[1]), float(t.c[2]), 0.f};
}

Eigen::Array4f bilinear(const Canvas& level, float x, float y) {
  const float xf = std::floor(x), yf = std::floor(y);
  const int x0 = static_cast<int>(xf), y0 = static_cast<int>(yf);
  const float fx = x - xf, fy = y - yf;
  int xa = x0, xb = x0 + 1, ya = y0, yb = y0 + 1;
  if (x0 < 0 || xb >= level.width()) xa = mirror(xa, level.width()), xb = mirror(xb, level.width());
  if (y0 < 0 || yb >= level.height())
    ya = mirror(ya, level.height()), yb = mirror(yb, level.height());
  const Canvas::Texel* r0 = level.row(ya);
  const Canvas::Texel* r1 = level.row(yb);
  const Eigen::Array4f a = load(r0[xa]), b = load(r0[xb]), c = load(r1[xa]), d = load(r1[xb]);
  const Eigen::Array4f top = a + fx * (b - a), bottom = c + fx * (d - c);
  return top + fy * (bottom - top);
}

}  // namespace

Canvas::Canvas(int width, int height, float texel_m)
    : width_(width),
      height_(height),
      texel_m_(texel_m),
      texels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
  SGS_CHECK(width > 0 && height > 0 && texel_m > 0, "a canvas needs a size");
}

void Canvas::fill(const Rgb& color) {
  set(0, 0, color);
  std::fill(texels_.begin(), texels_.end(), Texel(texels_[0]));
}

void Canvas::stroke(const Eigen::Vector2f& a, const Eigen::Vector2f& b, float width,
                    const Rgb& color) {
  const float r = std::max(width / 2, 0.3f);
  const Box box = clip(*this, std::min(a.x(), b.x()) - r, std::min(a.y(), b.y()) - r,
                       std::max(a.x(), b.x()) + r, std::max(a.y(), b.y()) + r);
  const Eigen::Vector2f ab = b - a;
  const float inverse = 1 / std::max(ab.squaredNorm(), 1e-6f);
  for (int y = box.y0; y <= box.y1; ++y)
    for (int x = box.x0; x <= box.x1; ++x) {
      const Eigen::Vector2f p = Eigen::Vector2f(float(x), float(y)) - a;
      const float s = std::clamp(p.dot(ab) * inverse, 0.f, 1.f);
      blend(x, y, color, coverage(r - (p - s * ab).norm()));
    }
}

void Canvas::ellipse(const Eigen::Vector2f& centre, const Eigen::Vector2f& r, float angle,
                     const Rgb& color, float alpha) {
  const float reach = r.maxCoeff(), c = std::cos(angle), s = std::sin(angle);
  const Box box =
      clip(*this, centre.x() - reach, centre.y() - reach, centre.x() + reach, centre.y() + reach);
  for (int y = box.y0; y <= box.y1; ++y)
    for (int x = box.x0; x <= box.x1; ++x) {
      const float dx = float(x) - centre.x(), dy = float(y) - centre.y();
      const float q = std::hypot((c * dx + s * dy) / r.x(), (c * dy - s * dx) / r.y());
      blend(x, y, color, alpha * coverage((1 - q) * r.minCoeff()));
    }
}

void Canvas::polygon(const std::vector<Eigen::Vector2f>& corners, const Rgb& color, float alpha) {
  Eigen::Vector2f lo = corners[0], hi = corners[0];
  float area = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2f &p = corners[i], &q = corners[(i + 1) % corners.size()];
    lo = lo.cwiseMin(p);
    hi = hi.cwiseMax(p);
    area += p.x() * q.y() - p.y() * q.x();
  }
  struct Edge {
    float a, b, c;  // a x + b y + c is the distance inside
  };
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2f &p = corners[i], &q = corners[(i + 1) % corners.size()];
    const Eigen::Vector2f e = q - p;
    const float length = e.norm();
    if (length < 1e-4f) continue;
    const float k = (area > 0 ? 1.f : -1.f) / length;
    edges.push_back({-e.y() * k, e.x() * k, (e.y() * p.x() - e.x() * p.y()) * k});
  }
  const Box box = clip(*this, lo.x(), lo.y(), hi.x(), hi.y());
  for (int y = box.y0; y <= box.y1; ++y)
    for (int x = box.x0; x <= box.x1; ++x) {
      float inside = 1;
      for (const Edge& e : edges)
        inside = std::min(inside, coverage(e.a * float(x) + e.b * float(y) + e.c));
      blend(x, y, color, alpha * inside);
    }
}

void Canvas::rectangle(float x0, float y0, float x1, float y1, const Rgb& color, float alpha) {
  polygon({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, color, alpha);
}

void Canvas::paste(const Canvas& picture, const Eigen::Vector2f& centre, float angle, int row_begin,
                   int row_end) {
  const float k = texel_m_ / picture.texel_m(), c = std::cos(angle), s = std::sin(angle);
  const float hw = float(picture.width()) / 2, hh = float(picture.height()) / 2;
  const float reach = std::hypot(hw, hh) / k;
  const Box box =
      clip(*this, centre.x() - reach, centre.y() - reach, centre.x() + reach, centre.y() + reach);
  for (int y = std::max(box.y0, row_begin); y <= box.y1 && y < row_end; ++y)
    for (int x = box.x0; x <= box.x1; ++x) {
      const float dx = (float(x) - centre.x()) * k, dy = (float(y) - centre.y()) * k;
      const float u = c * dx + s * dy, v = c * dy - s * dx;
      const float inside = std::min(hw - std::abs(u), hh - std::abs(v)) / k;
      if (inside <= -0.5f) continue;
      const Eigen::Array4f color = bilinear(picture, u + hw - 0.5f, v + hh - 0.5f);
      blend(x, y, color.head<3>() * (1.f / 255), coverage(inside));
    }
}

Texture::Texture(Canvas canvas) {
  width_m_ = float(canvas.width()) * canvas.texel_m();
  height_m_ = float(canvas.height()) * canvas.texel_m();
  levels_.push_back(std::move(canvas));
  while (levels_.back().width() > 1 && levels_.back().height() > 1 && levels_.size() < 12) {
    const Canvas& fine = levels_.back();
    Canvas coarse(fine.width() / 2, fine.height() / 2, fine.texel_m() * 2);
    for (int y = 0; y < coarse.height(); ++y)
      for (int x = 0; x < coarse.width(); ++x)
        for (int k = 0; k < 3; ++k)
          coarse.row(y)[x].c[k] = static_cast<std::uint8_t>(
              (fine.row(2 * y)[2 * x].c[k] + fine.row(2 * y)[2 * x + 1].c[k] +
               fine.row(2 * y + 1)[2 * x].c[k] + fine.row(2 * y + 1)[2 * x + 1].c[k] + 2) /
              4);
    levels_.push_back(std::move(coarse));
  }
}

Rgb Texture::sample(float x_m, float y_m, float footprint_m) const {
  const float texels = footprint_m / levels_[0].texel_m();
  float lod = texels > 1 ? std::log2(texels) : 0.f;
  lod = std::min(lod, static_cast<float>(levels_.size() - 1));
  const std::size_t l = static_cast<std::size_t>(lod);
  const float f = lod - static_cast<float>(l);
  const float k = 1 / levels_[l].texel_m();
  Eigen::Array4f color = bilinear(levels_[l], x_m * k - 0.5f, y_m * k - 0.5f);
  if (f > 0 && l + 1 < levels_.size()) {
    const float k2 = 0.5f * k;
    color += f * (bilinear(levels_[l + 1], x_m * k2 - 0.5f, y_m * k2 - 0.5f) - color);
  }
  return color.head<3>() * (1.f / 255);
}

}  // namespace sgs::synthetic

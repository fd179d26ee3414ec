// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/render/evaluation_check.h"
#include "sgs/render/rasterizer.h"
#include "sgs/render/reference/reference_scene.h"

namespace sgs::render {
namespace {

class ReferenceTrainingView final : public TrainingView {
 public:
  explicit ReferenceTrainingView(const TrainingImage& source)
      : TrainingView(source.camera), image(source) {}
  const TrainingImage image;
};

class ReferenceRasterizer final : public Rasterizer {
 public:
  using Rasterizer::evaluate;

  std::string name() const override { return "reference"; }

  void render(std::span<const map::Gaussian> gaussians, const PinholeCamera& camera,
              const SE3& T_world_camera, Rendering& out) override {
    SGS_CHECK(camera.valid(), "the camera must be valid");
    const auto rows = convert(gaussians);
    store(reference::composite(reference::project_all(rows, camera, T_world_camera), camera),
          camera, out);
  }

  std::shared_ptr<const TrainingView> prepare(const TrainingImage& image) const override {
    check_training_image(image);
    return std::make_shared<ReferenceTrainingView>(image);
  }

  void evaluate(std::span<const map::Gaussian> gaussians, const TrainingView& training,
                const SE3& T_world_camera, const LossConfig& loss, Gradients& out,
                const EvaluateOptions& options) override {
    const auto* own = dynamic_cast<const ReferenceTrainingView*>(&training);
    SGS_CHECK(own != nullptr, "the training view was prepared by another kind of rasterizer");
    check_options(options, gaussians.size());
    const auto rows = convert(gaussians);
    const auto e = reference::evaluate(rows, own->image, T_world_camera, loss, options);
    const Capture& capture = options.capture;
    if (capture.reached != nullptr) {
      capture.reached->clear(rows.size());
      for (std::size_t i = 0; i < rows.size(); ++i) {
        if (e.reached[i]) capture.reached->insert(i);
      }
    }
    out.visible.clear();
    out.gradient.clear();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (!e.visible[i]) continue;
      out.visible.push_back(static_cast<std::uint32_t>(i));
      out.gradient.push_back(to_row(e.gradient[i]));
    }
    out.camera_twist = e.camera_twist;
    out.loss = e.loss;
    out.exposure_measured = e.exposure_measured;
    out.exposure_rendered = e.exposure_rendered;
    if (capture.rendering != nullptr) store(e.image, training.camera(), *capture.rendering);
    if (options.sink != nullptr) {
      options.sink->accept(out.visible, out.gradient.data());
      out.gradient.clear();
    }
  }

 private:
  static std::vector<reference::Parameters> convert(std::span<const map::Gaussian> gaussians) {
    std::vector<reference::Parameters> rows;
    rows.reserve(gaussians.size());
    for (const auto& g : gaussians) rows.push_back(reference::to_parameters(g));
    return rows;
  }

  static map::Gaussian to_row(const reference::Parameters& p) {
    const auto f = [&](std::size_t i) { return static_cast<float>(p[i]); };
    return {{f(0), f(1), f(2)},       {f(3), f(4), f(5)},
            {f(6), f(7), f(8), f(9)}, f(10),
            {f(11), f(12), f(13)},    {0, 0}};
  }

  static void store(const reference::PixelImage& image, const PinholeCamera& camera,
                    Rendering& out) {
    out.color = Image<Rgbf>(camera.width, camera.height);
    out.depth_sum = Image<float>(camera.width, camera.height);
    out.alpha = Image<float>(camera.width, camera.height);
    for (std::size_t i = 0; i < image.size(); ++i) {
      const auto f = [&](std::size_t k) { return static_cast<float>(image[i][k]); };
      out.color.data()[i] = {f(0), f(1), f(2)};
      out.depth_sum.data()[i] = f(3);
      out.alpha.data()[i] = f(4);
    }
  }
};

}  // namespace

std::unique_ptr<Rasterizer> make_reference_rasterizer() {
  return std::make_unique<ReferenceRasterizer>();
}

}  // namespace sgs::render

// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "commands.h"
#include "interrupt.h"
#include "progress.h"
#include "sgs/core/print.h"
#include "sgs/dataset/prefetch.h"
#include "sgs/dataset/tum_writer.h"
#include "sgs/input/input.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/image_io.h"
#include "sgs/synthetic/moving_masks.h"
#include "sgs/synthetic/source.h"

namespace sgs::app {
namespace {

/// Writes the truth of what moves beside the frames: masks/ and masks.txt.
class MaskWriter {
 public:
  /// Does nothing where nobody is in the scene.
  static Result<MaskWriter> create(const synthetic::SynthOptions& scene,
                                   const std::filesystem::path& folder) {
    SGS_ASSIGN_OR_RETURN(auto masks, synthetic::make_moving_masks(scene));
    if (masks) {
      SGS_RETURN_IF_ERROR(io::make_folder(folder / "masks"));
      SGS_RETURN_IF_ERROR(
          io::write_file(folder / "masks.txt", "# timestamp filename share_of_movers\n"));
    }
    return MaskWriter(std::move(masks), folder);
  }

  Status add(const RgbdFrame& frame) {
    if (!masks_) return {};
    const GrayImage mask = masks_->mask(frame.index);
    const auto still = std::count(mask.data(), mask.data() + mask.size(), std::uint8_t{0});
    const double share = 1 - static_cast<double>(still) / static_cast<double>(mask.size());
    const std::string name = fmt::format("masks/{:.6f}.png", frame.timestamp_s);
    SGS_RETURN_IF_ERROR(io::save_gray(folder_ / name, mask));
    return io::append_file(folder_ / "masks.txt",
                           fmt::format("{:.6f} {} {:.4f}\n", frame.timestamp_s, name, share));
  }

 private:
  MaskWriter(std::unique_ptr<synthetic::MovingMasks> masks, std::filesystem::path folder)
      : masks_(std::move(masks)), folder_(std::move(folder)) {}

  std::unique_ptr<synthetic::MovingMasks> masks_;
  std::filesystem::path folder_;
};

struct SynthCommand {
  run::InputSpec input;
  std::string scene, folder;
  int frames = 0, threads = 2;
  bool clean = false, jpeg = false, quiet = false;
};

int run_synth(const SynthCommand& command) {
  run::InputSpec spec = command.input;
  spec.input = synthetic::is_synth_spec(command.scene) ? command.scene : "synth:" + command.scene;
  if (command.clean) {
    if (std::count(spec.input.begin(), spec.input.end(), ':') > 1) {
      return report({ErrorCode::kInvalidArgument,
                     fmt::format("--clean contradicts the level in '{}'", command.scene),
                     "use one of them"});
    }
    spec.input += ":clean";
  }
  if (command.frames > 0) spec.frames = fmt::format("0:{}", command.frames);
  auto scene = run::synth_options(spec, command.threads);
  if (!scene) return report(scene.error());
  scene->as_recorded = true;
  auto made = synthetic::make_synthetic_source(*scene);
  if (!made) return report(made.error());
  constexpr std::size_t kFramesAhead = 4;
  dataset::PrefetchingSource source(std::move(*made), kFramesAhead);
  dataset::TumSequenceWriter::Options options;
  options.name = source.name();
  options.jpeg_color = command.jpeg;
  options.distortion = synthetic::synth_lens(*scene);
  auto writer = dataset::TumSequenceWriter::create(command.folder, source.camera(), options);
  if (!writer) return report(writer.error());
  auto masks = MaskWriter::create(*scene, command.folder);
  if (!masks) return report(masks.error());
  Progress progress("frames", source.size(), command.quiet);
  RgbdFrame frame;
  Error error;
  while (!interrupted()) {
    const auto status = source.next(frame, error);
    if (status == dataset::FrameRead::kEnd) break;
    if (status != dataset::FrameRead::kOk) continue;
    if (const auto written = writer->add(frame); !written) return report(written.error());
    if (const auto written = masks->add(frame); !written) return report(written.error());
    progress.step("");
  }
  progress.finish();
  print("{}\n", command.folder);
  return interrupted() ? kExitInterrupted : kExitDone;
}

}  // namespace

void add_synth(CLI::App& app, Action& action) {
  auto command = std::make_shared<SynthCommand>();
  auto* sub = app.add_subcommand("synth", "Render a synthetic sequence to disk (TUM layout)");
  sub->add_option("NAME", command->scene,
                  "Scene, see `sgs info --scenes`; NAME:LEVEL chooses the sensor, NAME+OPTION who "
                  "moves in it: then the truth of what moves is written, too (masks.txt)")
      ->required();
  sub->add_option("OUT", command->folder, "Folder to create")->required();
  sub->add_option("--trajectory", command->input.trajectory, "TUM file: fly along this motion");
  sub->add_option("--frames", command->frames, "At most so many frames")
      ->check(CLI::PositiveNumber);
  sub->add_option("--seed", command->input.synth_seed, "Scene, motion and noise");
  sub->add_option("--threads", command->threads, "Rendering threads")->check(CLI::Range(1, 256));
  sub->add_flag("--clean", command->clean, "No sensor noise (level clean)");
  sub->add_flag("--jpeg", command->jpeg, "Colour as JPEG instead of PNG");
  sub->add_flag("--quiet", command->quiet, "No progress");
  sub->callback([command, &action] { action = [command] { return run_synth(*command); }; });
}

}  // namespace sgs::app

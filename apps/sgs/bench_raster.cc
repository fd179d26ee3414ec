// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "mapping_loop.h"
#include "sgs/core/stopwatch.h"
#include "sgs/render/instruction_set.h"

namespace sgs::app {
namespace {

struct RasterCommand {
  benchmarks::MappingLoopOptions options;
  std::string scene = "room", isa = "best";
  int iterations = 40;
  bool json = false;
};

int run_bench_raster(RasterCommand command) {
  constexpr int kWarmUp = 3;
  if (const auto chosen = render::use_instruction_set(command.isa); !chosen) {
    return report(chosen.error());
  }
  command.options.dense = command.scene == "dense";
  benchmarks::MappingLoop loop(command.options);
  for (int i = 0; i < kWarmUp; ++i) loop.iterate();
  std::vector<double> cpu_ms, wall_ms;
  for (int i = 0; i < command.iterations; ++i) {
    const double wall_s = wall_time_s(), cpu_s = thread_cpu_time_s();
    loop.iterate();
    cpu_ms.push_back(1e3 * (thread_cpu_time_s() - cpu_s));
    wall_ms.push_back(1e3 * (wall_time_s() - wall_s));
  }
  // With one thread the thread's own time, which other processes do not disturb.
  const auto& ms = command.options.threads == 1 ? cpu_ms : wall_ms;
  nlohmann::ordered_json json = {{"gaussians", command.options.gaussians},
                                 {"visible", loop.visible()},
                                 {"scene", command.scene},
                                 {"width", command.options.width},
                                 {"threads", command.options.threads},
                                 {"isa", command.isa},
                                 {"dssim", command.options.dssim_weight > 0},
                                 {"iterations", command.iterations},
                                 {"ms_p50", quantile(ms, 0.5)},
                                 {"ms_min", quantile(ms, 0)},
                                 {"cpu_ms_p50", quantile(cpu_ms, 0.5)},
                                 {"wall_ms_p50", quantile(wall_ms, 0.5)}};
  if (command.json) {
    fmt::print("{}\n", json.dump());
  } else {
    fmt::print(
        "{} of {} Gaussians visible: {:.2f} ms per mapping iteration (median of {}), {:.0f}/s\n",
        loop.visible(), command.options.gaussians, quantile(ms, 0.5), command.iterations,
        1e3 / quantile(ms, 0.5));
  }
  return kExitDone;
}

}  // namespace

void add_bench_raster(CLI::App& app, Action& action) {
  auto command = std::make_shared<RasterCommand>();
  auto* sub = app.get_subcommand("bench")->add_subcommand(
      "raster", "Time one mapping iteration (L1, backward, Adam) on a synthetic room");
  sub->add_option("--gaussians", command->options.gaussians, "Gaussians in the map")
      ->check(CLI::Range(1, 10000000));
  sub->add_option("--scene", command->scene, "room (40 % in view) or dense (all of them)")
      ->check(CLI::IsMember({"room", "dense"}));
  sub->add_option("--width", command->options.width, "Image width, pixels; the height is 3/4 of it")
      ->check(CLI::Range(32, 8000));
  sub->add_option("--sigma", command->options.sigma, "Tangential sigma, in spacings")
      ->check(CLI::PositiveNumber);
  sub->add_option("--threads", command->options.threads, "Threads")->check(CLI::Range(1, 256));
  sub->add_option("--dssim", command->options.dssim_weight, "Weight of D-SSIM; 0 = none")
      ->check(CLI::NonNegativeNumber);
  sub->add_option("--isa", command->isa, "best, or avx512, avx2, sse4, neon, scalar");
  sub->add_option("--iterations", command->iterations, "Timed iterations")
      ->check(CLI::Range(1, 1000000));
  sub->add_flag("--json", command->json, "Print one line of JSON");
  sub->callback([command, &action] { action = [command] { return run_bench_raster(*command); }; });
}

}  // namespace sgs::app

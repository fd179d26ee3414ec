// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Times one mapping iteration (forward, L1, backward, Adam) on a synthetic room.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "mapping_loop.h"
#include "sgs/core/stopwatch.h"
#include "sgs/render/instruction_set.h"

namespace {

using namespace sgs;

struct Command {
  benchmarks::MappingLoopOptions options;
  std::string scene = "room", isa = "best";
  int iterations = 40;
  bool json = false;
};

/// Milliseconds of each iteration.
struct Times {
  std::vector<double> cpu_ms, wall_ms;
};

void add_options(CLI::App& app, Command& command) {
  app.add_option("--gaussians", command.options.gaussians, "Gaussians in the map")
      ->check(CLI::Range(1, 10000000));
  app.add_option("--scene", command.scene, "room (40 % in view) or dense (all of them)")
      ->check(CLI::IsMember({"room", "dense"}));
  app.add_option("--width", command.options.width, "Image width, pixels; the height is 3/4 of it")
      ->check(CLI::Range(32, 8000));
  app.add_option("--sigma", command.options.sigma, "Tangential sigma, in spacings")
      ->check(CLI::PositiveNumber);
  app.add_option("--threads", command.options.threads, "Threads")->check(CLI::Range(1, 256));
  app.add_option("--dssim", command.options.dssim_weight, "Weight of D-SSIM; 0 = none")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--isa", command.isa, "best, or avx512, avx2, sse4, neon, scalar");
  app.add_option("--iterations", command.iterations, "Timed iterations")
      ->check(CLI::Range(1, 1000000));
  app.add_flag("--json", command.json, "Print one line of JSON");
}

Times time_iterations(benchmarks::MappingLoop& loop, int iterations) {
  constexpr int kWarmUp = 3;
  for (int i = 0; i < kWarmUp; ++i) loop.iterate();
  Times times;
  for (int i = 0; i < iterations; ++i) {
    const double wall_s = wall_time_s(), cpu_s = thread_cpu_time_s();
    loop.iterate();
    times.cpu_ms.push_back(1e3 * (thread_cpu_time_s() - cpu_s));
    times.wall_ms.push_back(1e3 * (wall_time_s() - wall_s));
  }
  return times;
}

void print(const Command& command, const Times& times, std::size_t visible) {
  // With one thread the thread's own time, which other processes do not disturb.
  const auto& ms = command.options.threads == 1 ? times.cpu_ms : times.wall_ms;
  nlohmann::ordered_json json = {{"gaussians", command.options.gaussians},
                                 {"visible", visible},
                                 {"scene", command.scene},
                                 {"width", command.options.width},
                                 {"threads", command.options.threads},
                                 {"isa", command.isa},
                                 {"dssim", command.options.dssim_weight > 0},
                                 {"iterations", command.iterations},
                                 {"ms_p50", quantile(ms, 0.5)},
                                 {"ms_min", quantile(ms, 0)},
                                 {"cpu_ms_p50", quantile(times.cpu_ms, 0.5)},
                                 {"wall_ms_p50", quantile(times.wall_ms, 0.5)}};
  if (command.json) {
    fmt::print("{}\n", json.dump());
  } else {
    fmt::print(
        "{} of {} Gaussians visible: {:.2f} ms per mapping iteration (median of {}), {:.0f}/s\n",
        visible, command.options.gaussians, quantile(ms, 0.5), command.iterations,
        1e3 / quantile(ms, 0.5));
  }
}

}  // namespace

int main(int argc, char** argv) {
  Command command;
  CLI::App app{"Time one mapping iteration (L1, backward, Adam) on a synthetic room"};
  add_options(app, command);
  CLI11_PARSE(app, argc, argv);
  if (const auto chosen = render::use_instruction_set(command.isa); !chosen) {
    fmt::print(stderr, "{}\n", chosen.error().text());
    return EXIT_FAILURE;
  }
  command.options.dense = command.scene == "dense";
  benchmarks::MappingLoop loop(command.options);
  const Times times = time_iterations(loop, command.iterations);
  print(command, times, loop.visible());
  return EXIT_SUCCESS;
}

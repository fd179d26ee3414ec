// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/suite/jobs.h"

#include <regex>

namespace sgs::suite {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRecorded = "recorded";

using Words = std::vector<std::string>;

void add(Words& to, const Words& more) { to.insert(to.end(), more.begin(), more.end()); }

/// Along which path the camera flies through a scene: for `sgs run` and `sgs synth`.
Words motion_arguments(const Options& options, const Sequence& sequence) {
  if (options.trajectories.empty() || sequence.motion.empty()) return {};
  const fs::path recording = fs::path(options.trajectories) / sequence.motion;
  return {"--trajectory", (recording / "groundtruth.txt").string()};
}

/// Sets the input of a job on a scene: rendered in the run, or once into the cache.
void use_scene(Job& job, const Options& options, const Sequence& sequence) {
  const std::string scene = fmt::format("{}:{}", sequence.scene, job.level);
  const std::string seed = std::to_string(job.seed);
  const Words motion = motion_arguments(options, sequence);
  if (options.cache.empty()) {
    add(job.arguments, {"synth:" + scene, "--synth-seed", seed});
    add(job.arguments, motion);
    return;
  }
  job.rendered =
      fs::path(options.cache) / fmt::format("{}-{}-{}", job.sequence, job.level, job.seed);
  job.arguments.push_back(job.rendered.string());
  job.render_arguments = {"synth", scene, "--seed", seed, "--quiet"};
  add(job.render_arguments, motion);
}

Job make_job(const Options& options, const Sequence& sequence, const std::string& level,
             const Variant& variant, int seed) {
  Job job{sequence.name, level, variant.name, seed, {}, {"run"}, {}, {}};
  job.folder = fs::path(options.output) / job.name();
  if (sequence.scene.empty()) {
    job.arguments.push_back(sequence.input);
  } else {
    use_scene(job, options, sequence);
  }
  add(job.arguments, {"--seed", std::to_string(seed), "--quiet"});
  add(job.arguments, variant.arguments);
  if (!options.rendering) {
    add(job.arguments, {"--no-eval"});
  } else if (!options.lpips_weights.empty()) {
    add(job.arguments, {"--lpips-weights", options.lpips_weights});
  }
  if (options.frames > 0) add(job.arguments, {"--frames", fmt::format("0:{}", options.frames)});
  for (const std::string& assignment : options.assignments) {
    add(job.arguments, {"--set", assignment});
  }
  return job;
}

bool is_there(const fs::path& path) {
  std::error_code unreadable;
  return fs::exists(path, unreadable);
}

}  // namespace

std::string Job::name() const { return fmt::format("{}-{}-{}-{}", sequence, level, variant, seed); }

fs::path Job::unfinished_mark() const { return folder / "unfinished"; }

fs::path Job::making(int generation) const {
  return folder.parent_path() / "running" / fmt::format("{}.{}", name(), generation);
}

fs::path Job::rendering(int generation) const {
  return fmt::format("{}.part{}", rendered.string(), generation);
}

std::vector<std::string> Job::words(const fs::path& making) const {
  Words all = arguments;
  add(all, {"-o", making.string()});
  return all;
}

std::vector<std::string> Job::render_words(const fs::path& rendering) const {
  Words all = render_arguments;
  all.insert(all.begin() + 2, rendering.string());  // synth SCENE FOLDER
  return all;
}

bool Job::is_done() const {
  return is_there(folder / "metrics.json") && !is_there(unfinished_mark());
}

bool Job::is_rendered() const { return rendered.empty() || is_there(rendered); }

Result<std::vector<Job>> make_jobs(const Suite& suite, const Options& options) {
  std::regex filter;
  try {
    filter = options.filter;
  } catch (const std::regex_error& error) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("--filter '{}': {}", options.filter, error.what()),
                "use an ECMAScript regular expression");
  }
  Words levels = options.levels;
  levels.push_back(kRecorded);
  std::vector<Job> jobs;
  for (const std::string& level : levels)
    for (const Sequence& sequence : suite.sequences)
      for (const Variant& variant : options.variants)
        for (const int seed : options.seeds) {
          if ((level == kRecorded) != sequence.scene.empty()) continue;
          Job job = make_job(options, sequence, level, variant, seed);
          if (std::regex_search(job.name(), filter)) jobs.push_back(std::move(job));
        }
  return jobs;
}

std::vector<Job> shard(const std::vector<Job>& jobs, std::size_t index, std::size_t count) {
  SGS_CHECK(index < count, "a shard is one of its number");
  std::vector<Job> out;
  for (std::size_t i = index; i < jobs.size(); i += count) out.push_back(jobs[i]);
  return out;
}

Result<eval::Metrics> job_metrics(const Job& job) {
  if (!job.is_done()) return fail(ErrorCode::kNotFound, job.name() + " did not end well");
  return eval::load_metrics(job.folder / "metrics.json");
}

}  // namespace sgs::suite

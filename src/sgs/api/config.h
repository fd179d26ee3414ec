// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "sgs/api/export.h"

namespace sgs::run {
struct RunConfig;
}

namespace sgs::api {

/// What is known about one parameter (docs/parameters.md lists them all).
struct ParameterInfo {
  std::string key, meaning, unit;
  double min = 0, max = 0;           ///< of numbers; infinite where there is no limit
  std::vector<std::string> choices;  ///< of words; empty = any
};

/// Everything that decides what a session computes, and a whole run(): the same frames,
/// configuration and seed give the same bits. A value: copies are independent.
class SGS_API Config {
 public:
  using Value = std::variant<bool, std::int64_t, double, std::string>;

  /// Starts from a preset: "default" (ours), "paper", or "quality" (more mapping, and run() refines
  /// the map in the end: `refine.steps_per_frame`). Throws kInvalidArgument for others.
  explicit Config(const std::string& preset = "default");
  /// The default preset with what a TOML file says, e.g. a run's config.toml.
  static Config load(const std::string& path);
  Config(const Config& other);
  Config& operator=(const Config& other);
  ~Config();

  /// Sets one parameter from text as in TOML or `sgs run --set`. Throws kUnknownKey, naming the
  /// nearest key, and kInvalidArgument, naming what is allowed; nothing changes then.
  void set(const std::string& key, const std::string& value);
  /// The value of a parameter. Throws kUnknownKey.
  Value get(const std::string& key) const;
  /// All keys in the order of docs/parameters.md.
  std::vector<std::string> keys() const;
  /// Throws kUnknownKey.
  ParameterInfo info(const std::string& key) const;
  /// Everything as TOML, which load() reads.
  std::string to_toml() const;

  /// Of the modules behind the library; of no use to programs.
  const run::RunConfig& modules() const;

 private:
  std::unique_ptr<run::RunConfig> config_;
};

}  // namespace sgs::api

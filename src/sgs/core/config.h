// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sgs/core/error.h"

namespace sgs {

/// Closed interval of allowed values.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

/// One configuration value: where it lives, what it means and what it may be.
struct Parameter {
  using Target = std::variant<bool*, int*, std::uint64_t*, double*, std::string*>;

  std::string key;   ///< dotted name as in TOML and `--set`, e.g. "mapper.insertion.leaf_max_px"
  Target target;     ///< the field of the config struct that this parameter reads and writes
  std::string doc;   ///< one sentence; ends up in docs/parameters.md
  std::string unit;  ///< "m", "px", "rad", ... or empty
  Range range;       ///< checked for numbers
  std::vector<std::string> choices;  ///< allowed values of a string; empty = any

  /// Current value as it would be written in TOML.
  std::string value_text() const;
  /// Parses and range-checks `text` (TOML scalar syntax; quotes optional for strings).
  Status set_from_text(std::string_view text) const;
};

/// Every parameter of a configuration, declared once by the config structs themselves:
///
///     struct MapperConfig {
///       int window = 8;
///       void declare(ParameterList& p) { p.add("window", window, "Keyframes per round", "", {1,
///       64}); }
///     };
///     ParameterList list;
///     { auto scope = list.group("mapper"); config.mapper.declare(list); }
///
/// Pointers into the config struct are kept: it must outlive the list and must not move.
class ParameterList {
 public:
  /// Restores the previous key prefix when it dies.
  class Group {
   public:
    Group(ParameterList& list, std::string previous)
        : list_(list), previous_(std::move(previous)) {}
    ~Group() { list_.prefix_ = previous_; }
    Group(const Group&) = delete;
    Group& operator=(const Group&) = delete;

   private:
    ParameterList& list_;
    std::string previous_;
  };

  /// Prefixes the keys added while the returned object lives with `name` and a dot.
  [[nodiscard]] Group group(std::string_view name);

  void add(std::string_view name, bool& field, std::string doc);
  void add(std::string_view name, int& field, std::string doc, std::string unit, Range range);
  void add(std::string_view name, std::uint64_t& field, std::string doc);
  void add(std::string_view name, double& field, std::string doc, std::string unit, Range range);
  void add(std::string_view name, std::string& field, std::string doc,
           std::vector<std::string> choices);

  const std::vector<Parameter>& parameters() const { return parameters_; }
  const Parameter* find(std::string_view key) const;
  /// Sets one value; an unknown key is an error that names the nearest known one.
  Status set(std::string_view key, std::string_view value_text) const;
  /// Sets "key=value" as given to `--set`.
  Status set_assignment(std::string_view assignment) const;

  /// The whole configuration as TOML, one table per group, in order of first declaration.
  std::string to_toml() const;
  /// The table of docs/parameters.md (key, default, unit, range, meaning).
  std::string to_markdown() const;

 private:
  void push(Parameter parameter);
  std::string prefix_;
  std::vector<Parameter> parameters_;
};

}  // namespace sgs

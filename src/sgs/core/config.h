// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sgs/core/enum_names.h"
#include "sgs/core/error.h"

namespace sgs {

/// Closed interval of allowed values.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

/// A field of some enum type, seen as a place in the table of its names.
struct EnumField {
  void* field;
  std::int64_t (*number)(const void* field);
  std::optional<std::size_t> (*place)(const void* field);  ///< empty = a value without a name
  void (*assign)(void* field, std::size_t place);

  template <NamedEnum E>
  static EnumField of(E& field);
};

/// One configuration value: where it lives, what it means and what it may be.
struct Parameter {
  using Target = std::variant<bool*, int*, std::uint64_t*, double*, std::string*, EnumField>;
  /// A word that a parameter once accepted, and what to write today.
  struct FormerWord {
    std::string word, instead;
  };

  std::string key;   ///< dotted name as in TOML and `--set`, e.g. "mapper.insertion.leaf_max_px"
  Target target;     ///< the field of the config struct that this parameter reads and writes
  std::string doc;   ///< one sentence; ends up in docs/parameters.md
  std::string unit;  ///< "m", "px", "rad", ... or empty
  Range range;       ///< checked for numbers
  std::vector<std::string_view> choices;  ///< words of an enum or a string; empty = any string
  std::vector<FormerWord> former_words;
  bool for_experts = true;  ///< see ParameterList::for_users()

  /// Whether TOML writes the value as a string.
  bool is_text() const;
  /// Current value as it would be written in TOML. Whole numbers beyond TOML's 64 bits with sign
  /// stand in quotes.
  std::string value_text() const;
  /// Whether the current value is allowed; the error names key, value and what is allowed.
  Status check() const;
  /// Parses and checks `text`: a TOML scalar, but a string may stand without quotes, and its
  /// escapes are not read. The field is unchanged on failure.
  Status set_from_text(std::string_view text) const;

 private:
  Status check_number(double value, std::string_view text) const;
  Status check_word(std::string_view word) const;
  tl::unexpected<Error> refused(std::string_view text, std::string_view expected) const;
};

/// A key that is no longer declared.
struct FormerKey {
  std::string key;       ///< of a parameter, or of a group whose keys keep their last part
  std::string now;       ///< its name today; empty = removed
  std::string why_gone;  ///< of a removed one

  /// Name today of `full`, which is this key or, where this is a group, below it.
  std::string name_now(std::string_view full) const {
    return now + std::string(full.substr(key.size()));
  }
};

/// Whom a parameter is for.
enum class Audience { kAll, kUsers, kExperts };
constexpr auto enum_names(Audience) {
  using enum Audience;
  return std::to_array<EnumName<Audience>>(
      {{kAll, "all"}, {kUsers, "users"}, {kExperts, "experts"}});
}

/// Every parameter of a configuration, declared once by the config structs themselves. Meaning,
/// unit, range and names stand in declare(), right below the fields, and nowhere else: the fields
/// carry no comments of their own, docs/parameters.md is written from it, and a new parameter is a
/// field with its line here.
///
///     /// How the mapper spends its steps.
///     struct ScheduleConfig {
///       int window = 8;
///       Order order = Order::kBalanced;
///
///       void declare(ParameterList& p) {
///         p.add("window", window, "Keyframes per round.", "", {1, 64});
///         p.add("order", order, "Which keyframe is visited when.");  // words: enum_names(Order)
///         p.renamed("size", "window");
///       }
///     };
///
///     ParameterList list;
///     list.add_group("schedule", config.schedule);     // keys schedule.window, schedule.order
///     SGS_RETURN_IF_ERROR(check(config.schedule));     // as does Session::create()
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
  /// Declares a config struct as a group.
  template <class Config>
  void add_group(std::string_view name, Config& config) {
    const Group scope = group(name);
    config.declare(*this);
  }

  void add(std::string_view name, bool& field, std::string_view doc);
  void add(std::string_view name, int& field, std::string_view doc, std::string_view unit,
           Range range);
  void add(std::string_view name, std::uint64_t& field, std::string_view doc);
  void add(std::string_view name, double& field, std::string_view doc, std::string_view unit,
           Range range);
  void add(std::string_view name, std::string& field, std::string_view doc,
           std::vector<std::string_view> choices);
  template <NamedEnum E>
  void add(std::string_view name, E& field, std::string_view doc) {
    push({join(name), EnumField::of(field), std::string(doc), "", {}, enum_words<E>(), {}});
  }

  /// Marks parameters of the current group (added before) as such that users set: they stand in
  /// docs/parameters.md, all others in docs/parameters-expert.md. A mark changes nothing else.
  void for_users(std::initializer_list<std::string_view> names);
  /// Makes an error of the key `former` (below the current group) that names `now` (likewise), so
  /// that old files and habits are refused with advice, not obeyed and not called unknown. `former`
  /// may also be a group: its keys are then looked for in the group `now`.
  void renamed(std::string_view former, std::string_view now);
  /// Makes an error of the key `former` that says why it is gone.
  void removed(std::string_view former, std::string_view why);
  /// From now on what an earlier version wrote is read: values of renamed keys go where they belong
  /// today, those of removed keys are passed over.
  void read_earlier_versions() { reads_earlier_versions_ = true; }
  /// Makes an error of a word that the parameter `name` (added before) once accepted; `instead`
  /// says what to write, e.g. "relative" or "tracker.type = paper".
  void renamed_word(std::string_view name, std::string_view former, std::string_view instead);

  const std::vector<Parameter>& parameters() const { return parameters_; }
  const std::vector<FormerKey>& former_keys() const { return former_keys_; }
  /// Null for a key that is not known; see read_earlier_versions().
  const Parameter* find(std::string_view key) const;
  /// The first value that is not allowed, as an error; see Parameter::check().
  Status check() const;
  /// Sets one value. An unknown key is an error that names the nearest known one, a former key one
  /// that names the key it has now.
  Status set(std::string_view key, std::string_view value_text) const;
  /// Sets "key=value" as given to `--set`.
  Status set_assignment(std::string_view assignment) const;

  /// The configuration as TOML, one table per group, in order of first declaration.
  std::string to_toml(Audience audience = Audience::kAll) const;
  /// The table of docs/parameters.md (key, default, unit, range, meaning).
  std::string to_markdown(Audience audience = Audience::kAll) const;

 private:
  std::string join(std::string_view name) const { return prefix_ + std::string(name); }
  void push(Parameter parameter);
  /// The parameter of that name in the current group; null = none was added.
  Parameter* added(std::string_view name);
  const FormerKey* former(std::string_view key) const;
  tl::unexpected<Error> unknown_key(std::string_view key) const;

  std::string prefix_;
  std::vector<Parameter> parameters_;
  std::vector<FormerKey> former_keys_;
  bool reads_earlier_versions_ = false;
};

/// Whether every value of a config struct is allowed, however it was built. Keys in the error are
/// as `declare()` names them.
template <class Config>
Status check(Config config) {
  // By value: declaring needs fields that can be written.
  ParameterList list;
  config.declare(list);
  return list.check();
}

template <NamedEnum E>
EnumField EnumField::of(E& field) {
  return {&field,
          [](const void* pointer) {
            return static_cast<std::int64_t>(*static_cast<const E*>(pointer));
          },
          [](const void* pointer) -> std::optional<std::size_t> {
            const auto names = enum_names(E{});
            for (std::size_t i = 0; i < names.size(); ++i) {
              if (names[i].value == *static_cast<const E*>(pointer)) return i;
            }
            return std::nullopt;
          },
          [](void* pointer, std::size_t number_in_table) {
            *static_cast<E*>(pointer) = enum_names(E{})[number_in_table].value;
          }};
}

}  // namespace sgs

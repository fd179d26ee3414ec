// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/config.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "sgs/core/text.h"

namespace sgs {
namespace {

std::string number_text(double value) {
  // The shortest text that reads back as the same number, and always recognisable as a float.
  char buffer[64];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  std::string text(buffer, end);
  if (text.find_first_of(".einf") == std::string::npos) text += ".0";
  return text;
}

template <class T>
bool parse_number(std::string_view text, T& value) {
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  return result.ec == std::errc{} && result.ptr == text.data() + text.size();
}

std::string_view without_quotes(std::string_view text) {
  const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
  return quoted ? text.substr(1, text.size() - 2) : text;
}

std::string range_text(const Parameter& p) {
  if (!p.choices.empty()) return fmt::format("{}", fmt::join(p.choices, " | "));
  if (std::holds_alternative<bool*>(p.target)) return "true | false";
  const bool low = std::isfinite(p.range.min), high = std::isfinite(p.range.max);
  if (!low && !high) return "";
  return fmt::format("{} .. {}", low ? fmt::format("{:g}", p.range.min) : "",
                     high ? fmt::format("{:g}", p.range.max) : "");
}

/// Whether `key` is `prefix` or lies in the group of that name.
bool is_or_below(std::string_view key, std::string_view prefix) {
  return key.starts_with(prefix) && (key.size() == prefix.size() || key[prefix.size()] == '.');
}

std::string markdown_cell(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '|') out += '\\';
    out += c;
  }
  return out;
}

}  // namespace

bool Parameter::is_text() const {
  return std::holds_alternative<std::string*>(target) || std::holds_alternative<EnumField>(target);
}

std::string Parameter::value_text() const {
  struct Visitor {
    const Parameter& p;
    std::string operator()(const bool* v) const { return *v ? "true" : "false"; }
    std::string operator()(const int* v) const { return std::to_string(*v); }
    std::string operator()(const std::uint64_t* v) const {
      constexpr std::uint64_t kLargestToml = std::numeric_limits<std::int64_t>::max();
      const std::string digits = std::to_string(*v);
      return *v <= kLargestToml ? digits : toml_quoted(digits);
    }
    std::string operator()(const double* v) const { return number_text(*v); }
    std::string operator()(const std::string* v) const { return toml_quoted(*v); }
    std::string operator()(const EnumField& v) const {
      const auto place = v.place(v.field);
      return place ? toml_quoted(p.choices[*place]) : std::to_string(v.number(v.field));
    }
  };
  return std::visit(Visitor{*this}, target);
}

tl::unexpected<Error> Parameter::refused(std::string_view text, std::string_view expected) const {
  const std::string allowed = range_text(*this);
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("config key '{}': '{}' is not {}", key, shortened(text), expected),
              allowed.empty()
                  ? doc
                  : fmt::format("{} Allowed: {}{}{}", doc, allowed, unit.empty() ? "" : " ", unit));
}

Status Parameter::check_number(double value, std::string_view text) const {
  if (!std::isfinite(value)) return refused(text, "a number");
  if (!(value >= range.min && value <= range.max)) return refused(text, "within range");
  return {};
}

Status Parameter::check_word(std::string_view word) const {
  if (!is_utf8(word)) return refused(word, "UTF-8 text, which is all that a TOML file can hold");
  if (choices.empty() || std::find(choices.begin(), choices.end(), word) != choices.end()) {
    return {};
  }
  const auto former = std::find_if(former_words.begin(), former_words.end(),
                                   [&](const FormerWord& f) { return f.word == word; });
  if (former != former_words.end()) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("config key '{}': '{}' is no longer a value", key, word),
                fmt::format("write {} instead", former->instead));
  }
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("config key '{}': '{}' is not an allowed value", key, shortened(word)),
              allowed_words(word, choices));
}

Status Parameter::check() const {
  if (const auto* const* integer = std::get_if<int*>(&target)) {
    return check_number(**integer, value_text());
  }
  if (const auto* const* number = std::get_if<double*>(&target)) {
    return check_number(**number, value_text());
  }
  if (const auto* const* string = std::get_if<std::string*>(&target)) return check_word(**string);
  if (const auto* field = std::get_if<EnumField>(&target); field && !field->place(field->field)) {
    return refused(value_text(), "one of the enum's values");
  }
  return {};
}

Status Parameter::set_from_text(std::string_view text) const {
  if (auto* const* flag = std::get_if<bool*>(&target)) {
    const bool on = text == "true" || text == "1";
    if (!on && text != "false" && text != "0") return refused(text, "true or false");
    **flag = on;
    return {};
  }
  if (is_text()) {
    const std::string_view word = without_quotes(text);
    SGS_RETURN_IF_ERROR(check_word(word));
    if (auto* const* string = std::get_if<std::string*>(&target)) {
      **string = word;
    } else {
      const auto place = std::find(choices.begin(), choices.end(), word) - choices.begin();
      const EnumField& field = std::get<EnumField>(target);
      field.assign(field.field, static_cast<std::size_t>(place));
    }
    return {};
  }
  if (auto* const* seed = std::get_if<std::uint64_t*>(&target)) {
    std::uint64_t value = 0;
    if (!parse_number(without_quotes(text), value)) return refused(text, "a whole number >= 0");
    **seed = value;
    return {};
  }
  double value = 0;
  if (!parse_number(text, value)) return refused(text, "a number");
  SGS_RETURN_IF_ERROR(check_number(value, text));
  if (auto* const* integer = std::get_if<int*>(&target)) {
    using Limits = std::numeric_limits<int>;
    if (value != std::floor(value)) return refused(text, "a whole number");
    if (value < Limits::min() || value > Limits::max()) return refused(text, "within range");
    **integer = static_cast<int>(value);
  } else {
    *std::get<double*>(target) = value;
  }
  return {};
}

ParameterList::Group ParameterList::group(std::string_view name) {
  std::string previous = prefix_;
  prefix_ += std::string(name) + ".";
  return {*this, std::move(previous)};
}

void ParameterList::push(Parameter parameter) {
  SGS_CHECK(find(parameter.key) == nullptr, "config key declared twice: " + parameter.key);
  parameters_.push_back(std::move(parameter));
}

void ParameterList::add(std::string_view name, bool& field, std::string_view doc) {
  push({join(name), &field, std::string(doc), "", {}, {}, {}});
}
void ParameterList::add(std::string_view name, int& field, std::string_view doc,
                        std::string_view unit, Range range) {
  push({join(name), &field, std::string(doc), std::string(unit), range, {}, {}});
}
void ParameterList::add(std::string_view name, std::uint64_t& field, std::string_view doc) {
  push({join(name), &field, std::string(doc), "", {0, Range{}.max}, {}, {}});
}
void ParameterList::add(std::string_view name, double& field, std::string_view doc,
                        std::string_view unit, Range range) {
  push({join(name), &field, std::string(doc), std::string(unit), range, {}, {}});
}
void ParameterList::add(std::string_view name, std::string& field, std::string_view doc,
                        std::vector<std::string_view> choices) {
  push({join(name), &field, std::string(doc), "", {}, std::move(choices), {}});
}

void ParameterList::renamed(std::string_view former, std::string_view now) {
  former_keys_.push_back({join(former), join(now), ""});
}

void ParameterList::removed(std::string_view former, std::string_view why) {
  former_keys_.push_back({join(former), "", std::string(why)});
}

void ParameterList::renamed_word(std::string_view name, std::string_view former,
                                 std::string_view instead) {
  Parameter* parameter = added(name);
  SGS_CHECK(parameter != nullptr && !parameter->choices.empty(), "no such words: " + join(name));
  parameter->former_words.push_back({std::string(former), std::string(instead)});
}

Parameter* ParameterList::added(std::string_view name) {
  const auto it = std::find_if(parameters_.begin(), parameters_.end(),
                               [&](const Parameter& p) { return p.key == join(name); });
  return it == parameters_.end() ? nullptr : &*it;
}

void ParameterList::for_users(std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    Parameter* parameter = added(name);
    SGS_CHECK(parameter != nullptr, "no such parameter: " + join(name));
    parameter->for_experts = false;
  }
}

const Parameter* ParameterList::find(std::string_view key) const {
  const FormerKey* gone = reads_earlier_versions_ ? former(key) : nullptr;
  const std::string now = gone != nullptr && !gone->now.empty() ? gone->name_now(key) : "";
  const auto it = std::ranges::find_if(
      parameters_, [&](const Parameter& p) { return p.key == key || p.key == now; });
  return it == parameters_.end() ? nullptr : &*it;
}

Status ParameterList::check() const {
  for (const Parameter& p : parameters_) SGS_RETURN_IF_ERROR(p.check());
  return {};
}

const FormerKey* ParameterList::former(std::string_view key) const {
  const auto it = std::ranges::find_if(former_keys_,
                                       [&](const FormerKey& f) { return is_or_below(key, f.key); });
  return it == former_keys_.end() ? nullptr : &*it;
}

tl::unexpected<Error> ParameterList::unknown_key(std::string_view key) const {
  if (const FormerKey* gone = former(key)) {
    if (gone->now.empty()) {
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("config key '{}' was removed: {}", shortened(key), gone->why_gone),
                  "leave it out");
    }
    const std::string now = gone->name_now(key);
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("config key '{}' is now called '{}'", shortened(key), shortened(now)),
                fmt::format("write {} instead", shortened(now)));
  }
  std::vector<std::string_view> keys;
  for (const Parameter& p : parameters_) keys.push_back(p.key);
  return fail(ErrorCode::kInvalidArgument, fmt::format("unknown config key '{}'", shortened(key)),
              keys.empty() ? ""
                           : fmt::format("did you mean '{}'? `sgs info --config` lists all keys",
                                         nearest_word(key, keys)));
}

Status ParameterList::set(std::string_view key, std::string_view value_text) const {
  if (const Parameter* parameter = find(key)) return parameter->set_from_text(value_text);
  const FormerKey* gone = reads_earlier_versions_ ? former(key) : nullptr;
  if (gone != nullptr && gone->now.empty()) return {};
  return unknown_key(key);
}

Status ParameterList::set_assignment(std::string_view assignment) const {
  const auto equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("'{}' is not of the form key=value", shortened(assignment)),
                "for example --set mapper.iterations_per_frame=2");
  }
  return set(assignment.substr(0, equals), assignment.substr(equals + 1));
}

namespace {
bool is_for(const Parameter& parameter, Audience audience) {
  return audience == Audience::kAll || parameter.for_experts == (audience == Audience::kExperts);
}
}  // namespace

std::string ParameterList::to_toml(Audience audience) const {
  // A group may go on after a nested one, but TOML allows each table only once.
  std::vector<std::pair<std::string, std::string>> tables = {{"", ""}};
  for (const Parameter& p : parameters_) {
    if (!is_for(p, audience)) continue;
    const auto dot = p.key.rfind('.');
    const std::string group = dot == std::string::npos ? "" : p.key.substr(0, dot);
    auto table = std::find_if(tables.begin(), tables.end(),
                              [&](const auto& entry) { return entry.first == group; });
    if (table == tables.end()) {
      table = tables.insert(tables.end(), {group, fmt::format("\n[{}]\n", group)});
    }
    table->second += fmt::format(
        "{} = {}\n", dot == std::string::npos ? p.key : p.key.substr(dot + 1), p.value_text());
  }
  std::string out;
  for (const auto& [group, text] : tables) out += text;
  return out;
}

std::string ParameterList::to_markdown(Audience audience) const {
  std::string out = "| key | default | unit | allowed | meaning |\n|---|---|---|---|---|\n";
  for (const Parameter& p : parameters_) {
    if (!is_for(p, audience)) continue;
    out += fmt::format("| `{}` | `{}` | {} | {} | {} |\n", p.key, p.value_text(), p.unit,
                       markdown_cell(range_text(p)), markdown_cell(p.doc));
  }
  return out;
}

}  // namespace sgs

// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/config.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>

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

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

template <class T>
bool parse_number(std::string_view text, T& value) {
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  return result.ec == std::errc{} && result.ptr == text.data() + text.size();
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t up = row[j];
      row[j] = std::min({up + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = up;
    }
  }
  return row.back();
}

std::string range_text(const Parameter& p) {
  if (!p.choices.empty()) return fmt::format("{}", fmt::join(p.choices, " | "));
  if (std::holds_alternative<bool*>(p.target)) return "true | false";
  const bool low = std::isfinite(p.range.min), high = std::isfinite(p.range.max);
  if (!low && !high) return "";
  return fmt::format("{} .. {}", low ? fmt::format("{:g}", p.range.min) : "",
                     high ? fmt::format("{:g}", p.range.max) : "");
}

}  // namespace

std::string Parameter::value_text() const {
  struct Visitor {
    std::string operator()(const bool* v) const { return *v ? "true" : "false"; }
    std::string operator()(const int* v) const { return std::to_string(*v); }
    std::string operator()(const std::uint64_t* v) const { return std::to_string(*v); }
    std::string operator()(const double* v) const { return number_text(*v); }
    std::string operator()(const std::string* v) const { return quoted(*v); }
  };
  return std::visit(Visitor{}, target);
}

Status Parameter::set_from_text(std::string_view text) const {
  const auto bad = [&](std::string_view expected) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("config key '{}': '{}' is not {}", key, text, expected),
                fmt::format("{} Allowed: {}", doc, range_text(*this)));
  };
  if (auto* const* flag = std::get_if<bool*>(&target)) {
    if (text == "true" || text == "1") {
      **flag = true;
    } else if (text == "false" || text == "0") {
      **flag = false;
    } else {
      return bad("true or false");
    }
    return {};
  }
  if (auto* const* string = std::get_if<std::string*>(&target)) {
    if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
      text = text.substr(1, text.size() - 2);
    }
    if (!choices.empty() && std::find(choices.begin(), choices.end(), text) == choices.end()) {
      return bad("an allowed value");
    }
    **string = std::string(text);
    return {};
  }
  if (auto* const* seed = std::get_if<std::uint64_t*>(&target)) {
    std::uint64_t value = 0;
    if (!parse_number(text, value)) return bad("a whole number >= 0");
    **seed = value;
    return {};
  }
  double value = 0;
  if (!parse_number(text, value) || !std::isfinite(value)) return bad("a number");
  if (!(value >= range.min && value <= range.max)) return bad("within range");
  if (auto* const* integer = std::get_if<int*>(&target)) {
    using Limits = std::numeric_limits<int>;
    if (value != std::floor(value)) return bad("a whole number");
    if (value < Limits::min() || value > Limits::max()) return bad("within range");
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

void ParameterList::add(std::string_view name, bool& field, std::string doc) {
  push({prefix_ + std::string(name), &field, std::move(doc), "", {}, {}});
}
void ParameterList::add(std::string_view name, int& field, std::string doc, std::string unit,
                        Range range) {
  push({prefix_ + std::string(name), &field, std::move(doc), std::move(unit), range, {}});
}
void ParameterList::add(std::string_view name, std::uint64_t& field, std::string doc) {
  push({prefix_ + std::string(name), &field, std::move(doc), "", {0, Range{}.max}, {}});
}
void ParameterList::add(std::string_view name, double& field, std::string doc, std::string unit,
                        Range range) {
  push({prefix_ + std::string(name), &field, std::move(doc), std::move(unit), range, {}});
}
void ParameterList::add(std::string_view name, std::string& field, std::string doc,
                        std::vector<std::string> choices) {
  push({prefix_ + std::string(name), &field, std::move(doc), "", {}, std::move(choices)});
}

const Parameter* ParameterList::find(std::string_view key) const {
  const auto it = std::find_if(parameters_.begin(), parameters_.end(),
                               [&](const Parameter& p) { return p.key == key; });
  return it == parameters_.end() ? nullptr : &*it;
}

Status ParameterList::set(std::string_view key, std::string_view value_text) const {
  if (const Parameter* parameter = find(key)) return parameter->set_from_text(value_text);
  const auto nearest = std::min_element(
      parameters_.begin(), parameters_.end(), [&](const Parameter& a, const Parameter& b) {
        return edit_distance(a.key, key) < edit_distance(b.key, key);
      });
  return fail(
      ErrorCode::kInvalidArgument, fmt::format("unknown config key '{}'", key),
      nearest == parameters_.end()
          ? ""
          : fmt::format("did you mean '{}'? `sgs info --config` lists all keys", nearest->key));
}

Status ParameterList::set_assignment(std::string_view assignment) const {
  const auto equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("'{}' is not of the form key=value", assignment),
                "for example --set mapper.iterations_per_frame=2");
  }
  return set(assignment.substr(0, equals), assignment.substr(equals + 1));
}

std::string ParameterList::to_toml() const {
  // A group may go on after a nested one, but TOML allows each table only once.
  std::vector<std::pair<std::string, std::string>> tables = {{"", ""}};
  for (const Parameter& p : parameters_) {
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

std::string ParameterList::to_markdown() const {
  std::string out = "| key | default | unit | allowed | meaning |\n|---|---|---|---|---|\n";
  for (const Parameter& p : parameters_) {
    std::string allowed = range_text(p);
    for (std::size_t i = 0; (i = allowed.find('|', i)) != std::string::npos; i += 2) {
      allowed.insert(i, "\\");
    }
    out += fmt::format("| `{}` | `{}` | {} | {} | {} |\n", p.key, p.value_text(), p.unit, allowed,
                       p.doc);
  }
  return out;
}

}  // namespace sgs

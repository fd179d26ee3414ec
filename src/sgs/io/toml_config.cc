// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/toml_config.h"

#include <string>

#include "sgs/io/atomic_file.h"
#include "sgs/io/text.h"
#include "sgs/io/toml_library.h"

namespace sgs::io {
namespace {

tl::unexpected<Error> wrong_type(const toml::node& node, std::string_view source,
                                 const Parameter& parameter, std::string_view expected) {
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("{}: config key '{}' must be {}", toml_place(node, source), parameter.key,
                          expected),
              parameter.doc);
}

/// The value in the spelling that Parameter::set_from_text() reads; an error when the TOML type
/// does not fit the parameter (8 for a string, "8" for a number, 1 for a flag).
Result<std::string> value_text(const toml::node& node, std::string_view source,
                               const Parameter& parameter) {
  if (std::holds_alternative<bool*>(parameter.target)) {
    const auto* value = node.as_boolean();
    if (value == nullptr) return wrong_type(node, source, parameter, "true or false");
    return std::string(value->get() ? "true" : "false");
  }
  if (parameter.is_text()) {
    const auto* value = node.as_string();
    if (value == nullptr) return wrong_type(node, source, parameter, "a string");
    return "\"" + value->get() + "\"";
  }
  if (std::holds_alternative<std::uint64_t*>(parameter.target) && node.is_string()) {
    return node.as_string()->get();  // beyond TOML's whole numbers
  }
  if (const auto* value = node.as_integer()) return std::to_string(value->get());
  if (const auto* value = node.as_floating_point()) {
    if (std::holds_alternative<double*>(parameter.target)) return fmt::format("{}", value->get());
    return wrong_type(node, source, parameter, "a whole number");
  }
  return wrong_type(node, source, parameter, "a number");
}

Status apply_node(const toml::node& node, const std::string& key, std::string_view source,
                  const ParameterList& parameters) {
  const auto located = [&](Error error) {
    error.message = fmt::format("{}: {}", toml_place(node, source), error.message);
    return tl::unexpected<Error>(std::move(error));
  };
  const Parameter* parameter = parameters.find(key);
  if (parameter == nullptr) {
    // ParameterList words the error for unknown keys; the value no longer matters.
    const Status status = parameters.set(key, "");
    return status ? status : located(status.error());
  }
  SGS_ASSIGN_OR_RETURN(const std::string text, value_text(node, source, *parameter));
  if (auto status = parameter->set_from_text(text); !status) return located(status.error());
  return {};
}

Status apply_table(const toml::table& table, const std::string& prefix, std::string_view source,
                   const ParameterList& parameters) {
  for (const auto& [name, node] : table) {
    const std::string key = prefix + std::string(name.str());
    if (const auto* child = node.as_table()) {
      SGS_RETURN_IF_ERROR(apply_table(*child, key + ".", source, parameters));
    } else {
      SGS_RETURN_IF_ERROR(apply_node(node, key, source, parameters));
    }
  }
  return {};
}

}  // namespace

std::string toml_place(const toml::node& node, std::string_view source) {
  return fmt::format("{}:{}", source, node.source().begin.line);
}

namespace {

/// Length of the longest chain of dots between two separators: the depth of tables that a dotted
/// key makes. The parser bounds the depth of arrays and inline tables, but not that of keys.
std::size_t longest_dotted_key(std::string_view text) {
  std::size_t longest = 0, dots = 0;
  for (const char c : text) {
    if (c == '.') longest = std::max(longest, ++dots);
    if (c == '\n' || c == ',' || c == '=' || c == '[' || c == ']' || c == '{' || c == '}') dots = 0;
  }
  return longest;
}

}  // namespace

Result<toml::table> parse_toml(std::string_view text, std::string_view source) {
  // limit: TOML text, bytes
  constexpr std::size_t kLargestText_bytes = 1 << 20;
  // limit: parts of a TOML key
  constexpr std::size_t kDeepestKey = 500;
  if (text.size() > kLargestText_bytes || longest_dotted_key(text) > kDeepestKey) {
    return fail(
        ErrorCode::kUnsupported,
        fmt::format("{}: larger than 1 MB, or a key of more than {} parts", source, kDeepestKey),
        "is this a configuration?");
  }
  try {
    return toml::parse(text, source);
  } catch (const toml::parse_error& e) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}:{}: {}", source, e.source().begin.line, e.description()),
                "see https://toml.io for the syntax");
  }
}

Status apply_toml_table(const toml::table& table, std::string_view source,
                        const ParameterList& parameters) {
  return apply_table(table, "", source, parameters);
}

Status apply_toml_text(std::string_view text, std::string_view source,
                       const ParameterList& parameters) {
  SGS_ASSIGN_OR_RETURN(const toml::table table, parse_toml(text, source));
  return apply_table(table, "", source, parameters);
}

Status apply_toml_file(const std::filesystem::path& path, const ParameterList& parameters) {
  SGS_ASSIGN_OR_RETURN(const std::string text, read_text(path));
  return apply_toml_text(text, path.string(), parameters);
}

}  // namespace sgs::io

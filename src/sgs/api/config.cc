// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/api/config.h"

#include <utility>

#include "sgs/api/internal/guard.h"
#include "sgs/core/config.h"
#include "sgs/runfolder/run_config.h"

namespace sgs::api {
namespace {

ParameterList declared(run::RunConfig& config) {
  ParameterList list;
  config.declare(list);
  return list;
}

/// Refuses a key that is not declared, in the words of ParameterList (nearest key, former names).
const Parameter& find_or_raise(const ParameterList& list, const std::string& key) {
  if (const Parameter* found = list.find(key)) return *found;
  const sgs::Status unknown = list.set(key, "");
  throw Error(ErrorCode::kUnknownKey, unknown ? key : unknown.error().message,
              unknown ? "" : unknown.error().remedy);
}

Config::Value value_of(const Parameter& parameter) {
  struct Read {
    const Parameter& parameter;
    Config::Value operator()(const bool* field) const { return *field; }
    Config::Value operator()(const int* field) const { return std::int64_t{*field}; }
    Config::Value operator()(const std::uint64_t* field) const {
      return std::in_range<std::int64_t>(*field) ? Config::Value(static_cast<std::int64_t>(*field))
                                                 : Config::Value(std::to_string(*field));
    }
    Config::Value operator()(const double* field) const { return *field; }
    Config::Value operator()(const std::string* field) const { return *field; }
    Config::Value operator()(const EnumField& field) const {
      const auto place = field.place(field.field);
      return std::string(place ? parameter.choices[*place] : "?");
    }
  };
  return std::visit(Read{parameter}, parameter.target);
}

}  // namespace

Config::Config(const std::string& preset)
    : config_(internal::guarded([&] {
        return std::make_unique<run::RunConfig>(
            internal::value_or_raise(run::make_run_config(preset)));
      })) {}

Config Config::load(const std::string& path) {
  return internal::guarded([&] {
    run::InputSpec unused;
    run::ConfigSources sources;
    sources.file = path;
    Config config;
    *config.config_ = internal::value_or_raise(run::resolve_config(sources, unused));
    return config;
  });
}

Config::Config(const Config& other) : config_(std::make_unique<run::RunConfig>(*other.config_)) {}

Config& Config::operator=(const Config& other) {
  *config_ = *other.config_;
  return *this;
}

Config::~Config() = default;

void Config::set(const std::string& key, const std::string& value) {
  internal::guarded([&] {
    const ParameterList list = declared(*config_);
    internal::check_or_raise(find_or_raise(list, key).set_from_text(value));
  });
}

Config::Value Config::get(const std::string& key) const {
  return internal::guarded([&] {
    const ParameterList list = declared(*config_);
    return value_of(find_or_raise(list, key));
  });
}

std::vector<std::string> Config::keys() const {
  std::vector<std::string> keys;
  const ParameterList list = declared(*config_);
  for (const Parameter& p : list.parameters()) keys.push_back(p.key);
  return keys;
}

ParameterInfo Config::info(const std::string& key) const {
  return internal::guarded([&] {
    const ParameterList list = declared(*config_);
    const Parameter& p = find_or_raise(list, key);
    return ParameterInfo{p.key,       p.doc,       p.unit,
                         p.range.min, p.range.max, {p.choices.begin(), p.choices.end()}};
  });
}

std::string Config::to_toml() const { return declared(*config_).to_toml(); }

const run::RunConfig& Config::modules() const { return *config_; }

}  // namespace sgs::api

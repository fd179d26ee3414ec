// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <regex>

#include "sgs/core/text.h"
#include "sgs/io/toml_library.h"
#include "sgs/suite/suite.h"
#include "sgs/synthetic/scene_table.h"

namespace sgs::suite {
namespace {

/// The text that is read, by the name that errors call it.
struct Source {
  std::string_view name;

  tl::unexpected<Error> wrong(const toml::node& node, std::string_view what,
                              std::string remedy = {}) const {
    return fail(ErrorCode::kInvalidFormat, fmt::format("{}: {}", io::toml_place(node, name), what),
                std::move(remedy));
  }
};

Status read(const toml::node& node, const Source& source, std::string& out) {
  const auto* text = node.as_string();
  if (text == nullptr || text->get().empty()) return source.wrong(node, "this must be a text");
  out = text->get();
  return {};
}

/// A trajectory error in cm; empty: lost.
Status read(const toml::node& node, const Source& source, std::optional<double>& out) {
  if (node.value<std::string>() == "lost") return {};
  out = node.value<double>();
  if (out && std::isfinite(*out) && *out >= 0) return {};
  return source.wrong(node, "this must be an error in cm or \"lost\"");
}

/// A score, 0 or more.
Status read(const toml::node& node, const Source& source, double& out) {
  out = node.value<double>().value_or(-1);
  if (std::isfinite(out) && out >= 0) return {};
  return source.wrong(node, "this must be a number, 0 or more");
}

/// A list, of texts or of tables.
template <class Row>
Status read(const toml::node& node, const Source& source, std::vector<Row>& out) {
  const auto* array = node.as_array();
  if (array == nullptr) return source.wrong(node, "this must be a list");
  for (const toml::node& row : *array) {
    SGS_RETURN_IF_ERROR(read(row, source, out.emplace_back()));
  }
  return {};
}

/// A table whose keys are free.
template <class Value>
Status read(const toml::node& node, const Source& source, std::map<std::string, Value>& out) {
  const auto* table = node.as_table();
  if (table == nullptr) return source.wrong(node, "this must be a table");
  for (const auto& [key, value] : *table) {
    SGS_RETURN_IF_ERROR(read(value, source, out[std::string(key.str())]));
  }
  return {};
}

/// Reads a table with fixed keys, any of which may be missing: take() each, then ask for the
/// status. Keys that nobody took are errors.
class Fields {
 public:
  Fields(const toml::node& node, const Source& source) : source_(source), table_(node.as_table()) {
    if (table_ == nullptr) status_ = source.wrong(node, "this must be a table");
  }

  template <class Field>
  Fields& take(std::string_view key, Field& field) {
    known_.push_back(key);
    if (!status_) return *this;
    if (const toml::node* value = table_->get(key)) status_ = read(*value, source_, field);
    return *this;
  }

  Status status() const {
    if (!status_) return status_;
    for (const auto& [key, value] : *table_) {
      if (std::find(known_.begin(), known_.end(), key.str()) != known_.end()) continue;
      return source_.wrong(value, fmt::format("unknown key '{}'", key.str()),
                           allowed_words(key.str(), known_));
    }
    return {};
  }

 private:
  const Source& source_;
  const toml::table* table_;
  std::vector<std::string_view> known_;
  Status status_;
};

/// Names become parts of a folder's name.
Status check_name(const toml::node& node, const Source& source, const std::string& name) {
  static const std::regex form("[A-Za-z0-9][A-Za-z0-9_.-]*");
  if (std::regex_match(name, form)) return {};
  return source.wrong(node, fmt::format("the name '{}' cannot be used", name),
                      "write 'name' with letters, digits, '_', '.' and '-'");
}

Status read(const toml::node& node, const Source& source, Sequence& out) {
  SGS_RETURN_IF_ERROR(Fields(node, source)
                          .take("name", out.name)
                          .take("scene", out.scene)
                          .take("motion", out.motion)
                          .take("input", out.input)
                          .take("folders", out.folders)
                          .take("needs", out.needs)
                          .status());
  SGS_RETURN_IF_ERROR(check_name(node, source, out.name));
  if (out.name == Publication::kAverage) {
    return source.wrong(node, fmt::format("no sequence can be called '{}'", out.name));
  }
  if (int{!out.scene.empty()} + int{!out.input.empty()} + int{!out.folders.empty()} != 1) {
    return source.wrong(
        node, fmt::format("sequence '{}' needs 'scene' or 'input' or 'folders'", out.name),
        "a scene of the generator, the folder of a recording, or names to look for in --data");
  }
  if (out.scene.empty()) return {};
  const auto scene = synthetic::parse_synth_spec("synth:" + out.scene);
  return scene ? Status() : source.wrong(node, scene.error().message, scene.error().remedy);
}

Status read(const toml::node& node, const Source& source, Variant& out) {
  SGS_RETURN_IF_ERROR(
      Fields(node, source).take("name", out.name).take("arguments", out.arguments).status());
  return check_name(node, source, out.name);
}

Status read(const toml::node& node, const Source& source, std::optional<Benchmark>& out) {
  out.emplace();
  return Fields(node, source).take("name", out->name).take("archives", out->archives).status();
}

Status read(const toml::node& node, const Source& source, Publication::Row& out) {
  double fps = 0;
  SGS_RETURN_IF_ERROR(Fields(node, source)
                          .take("system", out.system)
                          .take("ate_cm", out.ate_cm)
                          .take("psnr_db", out.psnr_db)
                          .take("ssim", out.ssim)
                          .take("lpips", out.lpips)
                          .take("fps", fps)
                          .status());
  if (fps > 0) out.fps = fps;
  return out.system.empty() ? source.wrong(node, "'system' is missing") : Status();
}

Status read(const toml::node& node, const Source& source, Publication& out) {
  SGS_RETURN_IF_ERROR(
      Fields(node, source).take("source", out.source).take("results", out.results).status());
  if (!out.source.empty()) return {};
  return source.wrong(node, "'source' is missing", "say who published it, where, in which table");
}

/// The names of rows, which must differ.
template <class Row>
Result<std::vector<std::string_view>> names_of(const std::vector<Row>& rows,
                                               std::string_view source) {
  std::vector<std::string_view> names;
  for (const Row& row : rows) {
    if (std::find(names.begin(), names.end(), row.name) != names.end()) {
      return fail(ErrorCode::kInvalidFormat,
                  fmt::format("{}: '{}' is there twice", source, row.name));
    }
    names.push_back(row.name);
  }
  return names;
}

/// An error where something is reported of what is no sequence.
Status check_results(const Publication& publication, std::string_view source,
                     const std::vector<std::string_view>& sequences) {
  for (const Publication::Row& row : publication.results) {
    std::vector<std::string> reported;
    for (const auto& [name, error] : row.ate_cm) reported.push_back(name);
    for (const auto* scores : {&row.psnr_db, &row.ssim, &row.lpips}) {
      for (const auto& [name, score] : *scores) reported.push_back(name);
    }
    for (const std::string& name : reported) {
      if (name == Publication::kAverage) continue;
      if (std::find(sequences.begin(), sequences.end(), name) != sequences.end()) continue;
      return fail(ErrorCode::kInvalidFormat,
                  fmt::format("{}: '{}' reports of '{}'", source, row.system, name),
                  allowed_words(name, sequences));
    }
  }
  return {};
}

Status check_whole(const Suite& suite, std::string_view source) {
  SGS_ASSIGN_OR_RETURN(const auto sequences, names_of(suite.sequences, source));
  for (const Publication& publication : suite.publications) {
    SGS_RETURN_IF_ERROR(check_results(publication, source, sequences));
  }
  for (const Sequence& sequence : suite.sequences) {
    if (sequence.folders.empty() || (suite.benchmark && !suite.benchmark->name.empty())) continue;
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: '{}' is looked for by name, but of which benchmark?", source,
                            sequence.name),
                "add a table [benchmark] with the 'name' under which it is published");
  }
  if (const auto variants = names_of(suite.variants, source); !variants) {
    return tl::unexpected<Error>(variants.error());
  }
  return {};
}

template <class Row>
void append(std::vector<Row>& to, std::vector<Row>& from) {
  std::move(from.begin(), from.end(), std::back_inserter(to));
}

}  // namespace

Status read_suite(std::string_view text, std::string_view name, Suite& suite) {
  const Source source{name};
  SGS_ASSIGN_OR_RETURN(const toml::table table, io::parse_toml(text, name));
  Suite added;
  SGS_RETURN_IF_ERROR(Fields(table, source)
                          .take("sequence", added.sequences)
                          .take("variant", added.variants)
                          .take("aliases", added.aliases)
                          .take("publication", added.publications)
                          .take("benchmark", added.benchmark)
                          .status());
  SGS_RETURN_IF_ERROR(check_whole(added, name));
  std::erase_if(suite.variants, [&](const Variant& old) {
    return std::any_of(added.variants.begin(), added.variants.end(),
                       [&](const Variant& now) { return now.name == old.name; });
  });
  append(suite.sequences, added.sequences);
  append(suite.variants, added.variants);
  append(suite.publications, added.publications);
  if (added.benchmark) suite.benchmark = std::move(added.benchmark);
  for (auto& [alias, key] : added.aliases) suite.aliases[alias] = key;
  return {};
}

}  // namespace sgs::suite

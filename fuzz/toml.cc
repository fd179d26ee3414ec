// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Configuration as TOML and as `--set`: whatever is accepted can be written down and says the same
// when it is read back.
#include <array>
#include <cstddef>

#include "harness.h"
#include "sgs/input/input.h"
#include "sgs/io/calibration_io.h"
#include "sgs/io/toml_config.h"
#include "sgs/slam/session_config.h"

namespace {

using namespace sgs;

struct Everything {
  run::InputSpec input;
  slam::SessionConfig config;
  std::array<ParameterList, 5> lists;  ///< of one part each, but for the second

  Everything() {
    input.declare(lists[0]);
    input.declare(lists[1]);  // all of them: that of inputs that begin with 0 or 1 in ASCII
    config.declare(lists[1]);
    lists[2].add_group("tracker", config.tracker);
    lists[3].add_group("mapper", config.mapper);
    lists[4].add_group("loops", config.loops);
  }
  /// As new; a list of hundreds of keys is not made for every input.
  Everything& reset() {
    input = {};
    config = {};
    return *this;
  }
};

void assignments(std::string_view text, const ParameterList& list) {
  while (!text.empty()) {
    const auto end = text.find('\n');
    if (!list.set_assignment(std::string(text.substr(0, end)))) return;  // as `sgs run` does
    if (end == std::string_view::npos) return;
    text.remove_prefix(end + 1);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::Choice input(data, size);
  static Everything first, second;
  const Everything& given = first.reset();
  const std::size_t part = input.number / 3 % given.lists.size();
  const ParameterList& list = given.lists[part];
  if (input.number % 3 == 0) {
    if (!io::apply_toml_text(input.rest, "fuzz", list)) return 0;
  } else if (input.number % 3 == 1) {
    assignments(input.rest, list);
  } else {
    const fuzz::MemoryFile file(input.rest);
    (void)io::load_sequence_toml(file.path());
    return 0;
  }
  if (!check(given.input)) return 0;
  const std::string text = list.to_toml();
  const ParameterList& again = second.reset().lists[part];
  const auto status = io::apply_toml_text(text, "fuzz", again);
  fuzz::require(status.has_value(), "a configuration can be read back");
  fuzz::require(again.to_toml() == text, "a configuration says the same when read back");
  return 0;
}

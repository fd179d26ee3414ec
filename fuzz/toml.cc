// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Configuration as TOML and as `--set`: whatever is accepted can be written down and says the same
// when it is read back.
#include "harness.h"
#include "sgs/io/calibration_io.h"
#include "sgs/io/toml_config.h"
#include "sgs/run/input.h"
#include "sgs/slam/session_config.h"

namespace {

using namespace sgs;

struct Everything {
  run::InputSpec input;
  slam::SessionConfig config;
  ParameterList list;

  Everything() {
    input.declare(list);
    config.declare(list);
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
  if (input.number % 3 == 0) {
    if (!io::apply_toml_text(input.rest, "fuzz", given.list)) return 0;
  } else if (input.number % 3 == 1) {
    assignments(input.rest, given.list);
  } else {
    const fuzz::MemoryFile file(input.rest);
    (void)io::load_sequence_toml(file.path());
    return 0;
  }
  if (!check(given.input)) return 0;
  const std::string text = given.list.to_toml();
  const Everything& again = second.reset();
  const auto status = io::apply_toml_text(text, "fuzz", again.list);
  fuzz::require(status.has_value(), "a configuration can be read back");
  fuzz::require(again.list.to_toml() == text, "a configuration says the same when read back");
  return 0;
}

// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/suite/claim_record.h"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <vector>

#include "sgs/core/text.h"
#include "sgs/io/atomic_file.h"

namespace sgs::suite {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kLongestWord = 160;

std::string first_line_of(const fs::path& file) {
  const std::string text = io::read_file(file).value_or("");
  return text.substr(0, text.find('\n'));
}

/// Which processes can be looked up by their number from here: the boot and the name space.
std::string process_space() {
  std::error_code error;
  const std::string space = fs::read_symlink("/proc/self/ns/pid", error).string();
  return first_line_of("/proc/sys/kernel/random/boot_id") + " " + space;
}

/// When a process started, in ticks since the boot; empty where none of that number lives. The
/// second field of the line, in brackets, may hold anything.
std::string start_ticks(std::string_view pid) {
  const std::string line = first_line_of(fmt::format("/proc/{}/stat", pid));
  const auto bracket = line.rfind(')');
  if (bracket == std::string::npos || line.substr(bracket).starts_with(") Z")) return "";
  constexpr int kStartTime = 22, kAfterBracket = 3;  // numbers of fields, proc(5)
  std::size_t at = bracket + 2;
  for (int field = kAfterBracket; field < kStartTime && at != std::string::npos; ++field) {
    at = line.find(' ', at);
    if (at != std::string::npos) ++at;
  }
  return at == std::string::npos ? "" : line.substr(at, line.find(' ', at) - at);
}

/// The value of the line "key value" of a record.
std::string_view value_of(std::string_view text, std::string_view key) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    if (line.starts_with(key) && line.substr(key.size()).starts_with(' ')) {
      return line.substr(key.size() + 1);
    }
    at = end + 1;
  }
  return {};
}

}  // namespace

std::string process_identity(int pid) {
  const std::string number = std::to_string(pid);
  return fmt::format("{} {} {}", process_space(), number, start_ticks(number));
}

bool has_ended(std::string_view identity) {
  const std::string here = process_space() + " ";
  if (here.size() < 8 || !identity.starts_with(here)) return false;
  const std::string_view process = identity.substr(here.size());
  const std::size_t space = process.find(' ');
  if (space == 0 || space == std::string_view::npos) return false;
  return start_ticks(process.substr(0, space)) != process.substr(space + 1);
}

std::string claim_text(const ClaimRecord& record) {
  std::string text = fmt::format(
      "state {}\nbeat {}\nworker {}\nidentity {}\n", to_string(record.state), record.beat,
      record.worker.substr(0, kLongestWord), record.identity.substr(0, kLongestWord));
  text.resize(kClaimRecordBytes, '\n');
  return text;
}

ClaimRecord parse_claim(std::string_view text) {
  ClaimRecord record;
  const std::string_view state = value_of(text, "state"), beat = value_of(text, "beat");
  for (const auto& name : enum_names(ClaimState{})) {
    if (name.name == state) record.state = name.value;
  }
  std::from_chars(beat.data(), beat.data() + beat.size(), record.beat);
  record.worker = value_of(text, "worker");
  record.identity = value_of(text, "identity");
  return record;
}

}  // namespace sgs::suite

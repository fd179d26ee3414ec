// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/runfolder/resume_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include "sgs/core/archive.h"
#include "sgs/io/atomic_file.h"
#include "sgs/render/instruction_set.h"
#include "sgs/runfolder/version.h"

namespace sgs::run {
namespace {

constexpr std::string_view kMagic = "sgs-resume";

std::uint32_t checksum(std::string_view bytes) {
  const auto* data = reinterpret_cast<const Bytef*>(bytes.data());
  return static_cast<std::uint32_t>(::crc32_z(::crc32_z(0, nullptr, 0), data, bytes.size()));
}

/// What follows the state: the file is complete where it ends with this, and nothing has to be
/// moved in memory to write it.
struct Footer {
  std::string version = run::version();
  std::string instructions = render::instruction_sets().front();
  std::uint64_t length = 0;  ///< of the state
  std::uint32_t state_sum = 0;
  std::int32_t format = kResumeFormat;

  template <class Archive>
  void archive(Archive& a) {
    a(version, instructions, length, state_sum, format);
  }
};

/// At the very end: where the footer begins, and whether it is one. Never changes with the format.
struct Tail {
  std::uint32_t footer_length = 0;
  std::uint32_t footer_sum = 0;
  std::array<char, kMagic.size()> magic = {};

  static constexpr std::size_t kSize = 4 + 4 + kMagic.size();
  template <class Archive>
  void archive(Archive& a) {
    a(footer_length, footer_sum, magic);
  }
};

tl::unexpected<Error> damaged(const std::filesystem::path& path) {
  return fail(ErrorCode::kInvalidFormat,
              fmt::format("{} is damaged: the run cannot be gone on with", path.string()),
              "run it again from the beginning; what it had done can be read as it is");
}

tl::unexpected<Error> foreign(const std::filesystem::path& path, const std::string& what) {
  return fail(ErrorCode::kUnsupported, fmt::format("{} was written {}", path.string(), what),
              "go on with it there, or run it again from the beginning");
}

}  // namespace

Status save_resume_file(const std::filesystem::path& path, std::string state) {
  Footer footer;
  footer.length = state.size();
  footer.state_sum = checksum(state);
  ArchiveWriter footer_bytes;
  footer_bytes(footer);
  const std::string after = footer_bytes.take();
  Tail tail{static_cast<std::uint32_t>(after.size()), checksum(after), {}};
  kMagic.copy(tail.magic.data(), tail.magic.size());
  ArchiveWriter bytes(std::move(state) + after);
  bytes(tail);
  return io::write_file(path, bytes.take());
}

Result<std::string> load_resume_file(const std::filesystem::path& path) {
  SGS_ASSIGN_OR_RETURN(std::string bytes, io::read_file(path));
  if (bytes.size() < Tail::kSize) return damaged(path);
  std::string_view rest = bytes;
  Tail tail;
  ArchiveReader tail_bytes(rest.substr(rest.size() - Tail::kSize));
  tail_bytes(tail);
  rest.remove_suffix(Tail::kSize);
  const bool named = std::string_view(tail.magic.data(), tail.magic.size()) == kMagic;
  if (!named || tail.footer_length > rest.size()) return damaged(path);
  const std::string_view after = rest.substr(rest.size() - tail.footer_length);
  if (checksum(after) != tail.footer_sum) return damaged(path);
  Footer footer;
  ArchiveReader footer_bytes(after);
  footer_bytes(footer);
  rest.remove_suffix(after.size());
  if (footer_bytes.failed()) return damaged(path);
  if (footer.format != kResumeFormat || footer.version != version()) {
    return foreign(path, fmt::format("by sgs {} (format {}), not by this one: {} (format {})",
                                     footer.version, footer.format, version(), kResumeFormat));
  }
  const std::string here = render::instruction_sets().front();
  if (footer.instructions != here) {
    return foreign(path, fmt::format("on a processor with {}, where results differ in their last "
                                     "bits from those of this one with {}",
                                     footer.instructions, here));
  }
  if (rest.size() != footer.length || checksum(rest) != footer.state_sum) return damaged(path);
  bytes.resize(rest.size());
  return bytes;
}

}  // namespace sgs::run

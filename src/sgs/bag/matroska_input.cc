// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/bag/matroska_input.h"

#include <algorithm>
#include <array>
#include <bit>
#include <new>
#include <utility>

namespace sgs::bag {

namespace fs = std::filesystem;

static_assert(kNoTime == AV_NOPTS_VALUE);

Result<MatroskaInput> MatroskaInput::open(const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(const AvLibrary* av, av_library());
  MatroskaInput input(av);
  // With the protocol's name a colon in the file's means nothing.
  const std::string url = "file:" + path.string();
  const int status = av->avformat_open_input(&input.context_, url.c_str(),
                                             av->av_find_input_format("matroska"), nullptr);
  if (status < 0) {
    std::array<char, AV_ERROR_MAX_STRING_SIZE> reason{};
    av->av_strerror(status, reason.data(), reason.size());
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: its tracks cannot be read: {}", path.string(), reason.data()),
                "the file is damaged or was cut off at its beginning; copy or record it again");
  }
  input.context_->flags |= AVFMT_FLAG_NOPARSE | AVFMT_FLAG_NOFILLIN;
  input.packet_ = av->av_packet_alloc();
  if (input.packet_ == nullptr) throw std::bad_alloc();
  return input;
}

MatroskaInput::~MatroskaInput() {
  if (packet_ != nullptr) av_->av_packet_free(&packet_);
  if (context_ != nullptr) av_->avformat_close_input(&context_);
}

MatroskaInput::MatroskaInput(MatroskaInput&& other) noexcept
    : av_(other.av_),
      context_(std::exchange(other.context_, nullptr)),
      packet_(std::exchange(other.packet_, nullptr)) {}

std::string MatroskaInput::tag(const char* name) const {
  if (const auto value = entry(context_->metadata, name); !value.empty()) return value;
  for (const AVStream* stream : streams()) {
    if (const auto value = entry(stream->metadata, name); !value.empty()) return value;
  }
  return {};
}

std::string MatroskaInput::entry(const AVDictionary* of, const char* name) const {
  const AVDictionaryEntry* found = av_->av_dict_get(of, name, nullptr, 0);
  return found != nullptr && found->value != nullptr ? found->value : "";
}

void MatroskaInput::keep_only(std::span<const int> tracks) {
  for (AVStream* stream : streams()) {
    const bool kept = std::find(tracks.begin(), tracks.end(), stream->index) != tracks.end();
    stream->discard = kept ? AVDISCARD_DEFAULT : AVDISCARD_ALL;
  }
}

const AVPacket* MatroskaInput::next() {
  av_->av_packet_unref(packet_);
  return av_->av_read_frame(context_, packet_) < 0 ? nullptr : packet_;
}

std::int64_t MatroskaInput::time_ns(const AVPacket& packet) const {
  const std::int64_t time = packet.pts != kNoTime ? packet.pts : packet.dts;
  if (time == kNoTime || time < 0) return kNoTime;
  constexpr AVRational kNanosecond{1, 1'000'000'000};
  const auto ns =
      av_->av_rescale_q(time, context_->streams[packet.stream_index]->time_base, kNanosecond);
  return ns < 0 || ns > kLatest_ns ? kNoTime : ns;
}

std::optional<std::uint64_t> announced_end(ByteFile& file) {
  constexpr std::uint32_t kSegment = 0x18538067;
  constexpr std::uint64_t kHead_bytes = 256;
  const auto head = file.view(0, std::min(file.size(), kHead_bytes));
  if (!head) return std::nullopt;
  std::size_t at = 0;
  // A number says in its first byte, by zeros before the first one, how many bytes follow.
  const auto number = [&](bool with_mark) -> std::optional<std::uint64_t> {
    if (at >= head->size()) return std::nullopt;
    const auto first = static_cast<std::uint8_t>((*head)[at]);
    const auto more = static_cast<std::size_t>(std::countl_zero(first));
    if (more > 7 || at + more >= head->size()) return std::nullopt;
    std::uint64_t value = with_mark ? first : first & (0x7Fu >> more);
    bool all_ones = (first | (0xFFu << (7 - more) & 0xFFu)) == 0xFF;
    for (std::size_t i = 1; i <= more; ++i) {
      const auto byte = static_cast<std::uint8_t>((*head)[at + i]);
      all_ones = all_ones && byte == 0xFF;
      value = value << 8 | byte;
    }
    at += more + 1;
    if (!with_mark && all_ones) return std::nullopt;  // not known when it was written
    return value;
  };
  while (true) {
    const auto id = number(true);
    const auto size = id ? number(false) : std::nullopt;
    if (!size) return std::nullopt;
    if (*id == kSegment) return at + *size;
    if (*size > head->size() - at) return std::nullopt;
    at += *size;
  }
}

}  // namespace sgs::bag

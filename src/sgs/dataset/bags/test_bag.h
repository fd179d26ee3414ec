// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sgs/bag/bag.h"

namespace sgs::dataset {

// A recording in memory, for tests, and its messages as ROS 1 packs them.

template <class T>
std::string packed(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}

inline std::string packed_text(const std::string& text) {
  return packed(static_cast<std::uint32_t>(text.size())) + text;
}

inline std::string packed_header(std::int64_t stamp_ns, const std::string& frame) {
  return packed(0u) + packed(static_cast<std::uint32_t>(stamp_ns / 1'000'000'000)) +
         packed(static_cast<std::uint32_t>(stamp_ns % 1'000'000'000)) + packed_text(frame);
}

/// Messages in memory.
class MemoryBag : public bag::Bag {
 public:
  std::size_t topic(const std::string& name, const std::string& type) {
    return channel_of(name, type, bag::Encoding::kRos1);
  }
  void add(std::size_t channel, std::string data, std::int64_t record_ns = 0) {
    messages_.push_back({channel, record_ns, std::move(data)});
  }
  /// A message that is only a header.
  void stamp(std::size_t channel, std::int64_t ms) {
    add(channel, packed_header(ms * 1'000'000, "c"));
  }
  void damage() { messages_.push_back({kDamage, 0, ""}); }

  std::unique_ptr<bag::Cursor> read(const std::vector<std::size_t>& channels) const override {
    return std::make_unique<MemoryCursor>(*this, channels.front());
  }

 private:
  static constexpr std::size_t kDamage = 99;
  struct MemoryCursor : bag::Cursor {
    MemoryCursor(const MemoryBag& b, std::size_t c) : bag(b), channel(c) {}
    Result<std::optional<bag::Message>> next() override {
      while (at < bag.messages_.size()) {
        const bag::Message& message = bag.messages_[at++];
        if (message.channel == kDamage) return fail(ErrorCode::kInvalidFormat, "damaged");
        if (message.channel == channel) return message;
      }
      return std::nullopt;
    }
    const MemoryBag& bag;
    std::size_t channel, at = 0;
  };
  std::vector<bag::Message> messages_;
};

}  // namespace sgs::dataset

// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "sgs/bag/bag.h"
#include "sgs/core/text.h"

namespace sgs::bag {

/// Reads the fields of a message one after the other, as ROS 1 or CDR packs them (OMG DDS-XTypes
/// 1.3, section 7.4.3: plain CDR version 1). Reading beyond the end gives zeros and is remembered:
/// check ok() at the end.
class Wire {
 public:
  Wire(std::string_view bytes, Encoding encoding) : bytes_(bytes), encoding_(encoding) {
    if (encoding == Encoding::kOther) ok_ = false;
    if (encoding != Encoding::kCdr) return;
    constexpr std::size_t kCdrHead = 4;  // 0, representation, options
    const bool plain =
        bytes.size() >= kCdrHead && bytes[0] == 0 && (bytes[1] == 0 || bytes[1] == 1);
    if (!plain) {
      ok_ = false;
      return;
    }
    swap_ = bytes[1] == 0;
    bytes_.remove_prefix(kCdrHead);  // alignment counts from here
  }

  Encoding encoding() const { return encoding_; }
  bool ok() const { return ok_; }
  std::size_t left() const { return bytes_.size() - at_; }

  template <class T>
  T number() {
    static_assert(std::is_arithmetic_v<T>);
    if (encoding_ == Encoding::kCdr)
      at_ = std::min(bytes_.size(), (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T));
    char raw[sizeof(T)] = {};
    const std::string_view from = piece(sizeof(T));
    if (!from.empty()) std::memcpy(raw, from.data(), sizeof(T));
    if (swap_) std::reverse(raw, raw + sizeof(T));
    T value{};
    std::memcpy(&value, raw, sizeof(T));
    return value;
  }
  std::uint32_t count() { return number<std::uint32_t>(); }
  /// Fit to be shown.
  std::string string() {
    std::string_view text = piece(count());
    // CDR counts the closing zero.
    if (encoding_ == Encoding::kCdr && text.ends_with('\0')) text.remove_suffix(1);
    return printable(text);
  }
  /// A sequence of bytes.
  std::string_view bytes() { return piece(count()); }

 private:
  std::string_view piece(std::size_t length) {
    if (!ok_ || length > left()) {
      ok_ = false;
      return {};
    }
    const std::string_view result = bytes_.substr(at_, length);
    at_ += length;
    return result;
  }

  std::string_view bytes_;
  Encoding encoding_;
  std::size_t at_ = 0;
  bool swap_ = false;
  bool ok_ = true;
};

}  // namespace sgs::bag

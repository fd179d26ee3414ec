// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "sgs/bag/bag.h"

namespace sgs::bag {

/// Packs the fields of a message one after the other, as Wire (bag/wire.h) reads them. Encoding
/// kOther packs nothing around them: plain numbers and strings, of which containers consist.
class WireWriter {
 public:
  explicit WireWriter(Encoding encoding = Encoding::kOther) : encoding_(encoding) {
    constexpr std::string_view kLittleEndianCdr("\0\1\0\0", 4);
    if (encoding == Encoding::kCdr) bytes_ = kLittleEndianCdr;
  }

  template <class T>
  WireWriter& number(T value) {
    static_assert(std::is_arithmetic_v<T> && std::endian::native == std::endian::little);
    if (encoding_ == Encoding::kCdr) {
      constexpr std::size_t kCdrHead = 4;  // alignment counts from behind it
      while ((bytes_.size() - kCdrHead) % sizeof(T) != 0) bytes_.push_back('\0');
    }
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
    return *this;
  }
  WireWriter& count(std::size_t value) { return number(static_cast<std::uint32_t>(value)); }
  WireWriter& string(std::string_view text) {
    const bool closing_zero = encoding_ == Encoding::kCdr;
    count(text.size() + (closing_zero ? 1 : 0));
    bytes_.append(text);
    if (closing_zero) bytes_.push_back('\0');
    return *this;
  }
  /// A sequence of bytes.
  WireWriter& bytes(std::string_view data) {
    count(data.size());
    bytes_.append(data);
    return *this;
  }

  Encoding encoding() const { return encoding_; }
  const std::string& data() const { return bytes_; }

 private:
  Encoding encoding_;
  std::string bytes_;
};

}  // namespace sgs::bag

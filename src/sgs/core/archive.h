// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace sgs {

/// Writes the state of objects as bytes and reads it back. One list of fields serves both ways:
///
///     template <class Archive>
///     void archive(Archive& a) { a(count_, poses_, random_); }
///
/// Fields are numbers, enums, strings, vectors, arrays and optionals of fields, matrices of fixed
/// size, objects with such a member, and types with a function `archive_fields(Archive&, T&)`
/// beside them. The bytes are those of this machine: for the same program to read.
///
/// A type whose bytes are its value may be taken as a block: specialise this for it.
template <class T>
inline constexpr bool archived_as_bytes = std::is_arithmetic_v<T> || std::is_enum_v<T>;

namespace archive_detail {

template <class T>
concept FixedMatrix = requires(T& m) {
  typename T::Scalar;
  { m.data() } -> std::same_as<typename T::Scalar*>;
  requires(T::SizeAtCompileTime > 0);
};

/// Hands a field to the part of an archive that knows its kind.
template <class Archive, class T>
void visit(Archive& a, T& field) {
  if constexpr (std::is_same_v<T, bool>) {
    a.flag(field);
  } else if constexpr (archived_as_bytes<T>) {
    a.block(&field, sizeof(T));
  } else if constexpr (FixedMatrix<T>) {
    a.block(field.data(), sizeof(typename T::Scalar) * static_cast<std::size_t>(field.size()));
  } else if constexpr (requires { field.archive(a); }) {
    field.archive(a);
  } else {
    archive_fields(a, field);
  }
}

}  // namespace archive_detail

/// The bytes that an archive grows to.
class ArchiveWriter {
 public:
  static constexpr bool kReads = false;

  /// Goes on behind `bytes`.
  explicit ArchiveWriter(std::string bytes = {}) : bytes_(std::move(bytes)) {}

  template <class... T>
  void operator()(T&... fields) {
    (archive_detail::visit(*this, fields), ...);
  }
  /// Makes room for so many bytes more.
  void reserve(std::size_t bytes) { bytes_.reserve(bytes_.size() + bytes); }
  std::string take() { return std::move(bytes_); }

  void block(const void* from, std::size_t size) {
    bytes_.append(static_cast<const char*>(from), size);
  }
  void flag(bool value) { bytes_.push_back(value ? 1 : 0); }
  /// Of readers only.
  void fail() {}
  /// The elements of a container whose bytes are their values.
  template <class Container>
  void blocks(Container& container) {
    count(container.size());
    block(container.data(), container.size() * sizeof(*container.data()));
  }
  template <class T>
  void objects(std::vector<T>& objects) {
    count(objects.size());
    for (T& object : objects) (*this)(object);
  }

 private:
  void count(std::uint64_t elements) { block(&elements, sizeof elements); }

  std::string bytes_;
};

/// Reads what an ArchiveWriter wrote. Bytes that end too early, or counts that they cannot hold,
/// leave the archive failed: what was read since is of no meaning then.
class ArchiveReader {
 public:
  static constexpr bool kReads = true;

  explicit ArchiveReader(std::string_view bytes) : rest_(bytes) {}

  template <class... T>
  void operator()(T&... fields) {
    (archive_detail::visit(*this, fields), ...);
  }
  bool failed() const { return failed_; }
  void fail() { failed_ = true; }
  /// Everything was there, and nothing is left.
  bool complete() const { return !failed_ && rest_.empty(); }

  void block(void* to, std::size_t size) {
    if (failed_ || size > rest_.size()) return fail();
    if (size == 0) return;
    std::memcpy(to, rest_.data(), size);
    rest_.remove_prefix(size);
  }
  void flag(bool& value) {
    char byte = 0;
    block(&byte, 1);
    value = byte != 0;
  }
  // Neither takes memory for more elements than there are bytes.
  template <class Container>
  void blocks(Container& container) {
    constexpr std::size_t kSize = sizeof(*container.data());
    const std::uint64_t elements = count();
    if (failed_ || elements > rest_.size() / kSize) return fail();
    container.resize(static_cast<std::size_t>(elements));
    block(container.data(), container.size() * kSize);
  }
  template <class T>
  void objects(std::vector<T>& objects) {
    objects.clear();
    const std::uint64_t elements = count();
    for (std::uint64_t i = 0; i < elements && !failed_; ++i) (*this)(objects.emplace_back());
  }

 private:
  std::uint64_t count() {
    std::uint64_t elements = 0;
    block(&elements, sizeof elements);
    return elements;
  }

  std::string_view rest_;
  bool failed_ = false;
};

template <class Archive, class T>
void archive_fields(Archive& a, std::vector<T>& elements) {
  if constexpr (archived_as_bytes<T>) {
    a.blocks(elements);
  } else {
    a.objects(elements);
  }
}

template <class Archive>
void archive_fields(Archive& a, std::string& text) {
  a.blocks(text);
}

template <class Archive, class T, std::size_t n>
void archive_fields(Archive& a, std::array<T, n>& elements) {
  for (T& element : elements) a(element);
}

template <class Archive, class T>
void archive_fields(Archive& a, std::optional<T>& value) {
  bool there = value.has_value();
  a(there);
  if (!there) {
    value.reset();
    return;
  }
  if (!value) value.emplace();
  a(*value);
}

}  // namespace sgs

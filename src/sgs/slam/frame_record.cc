// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/frame_record.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <concepts>
#include <type_traits>

#include "sgs/core/enum_names.h"
#include "sgs/io/csv.h"

namespace sgs::slam {
namespace {

constexpr int kAxes = 6;

template <class T>
concept Number = std::is_arithmetic_v<T> && !std::same_as<T, bool>;

std::string numbered(const FrameColumn& c, int k) { return fmt::format("{}_{}", c.key, k); }
/// Of entry `k` of a matrix in the order of its memory: axis after axis.
std::string axis_entry(const FrameColumn& c, int k) {
  return fmt::format("{}_{}_{}", c.key, k / kAxes, k % kAxes);
}

/// Appends the names of columns.
struct HeaderVisitor {
  std::string& text;

  void operator()(const FrameColumn& c, const std::array<double, kAxes>&) const {
    for (int k = 0; k < kAxes; ++k) add(numbered(c, k));
  }
  void operator()(const FrameColumn& c, const std::optional<Matrix6d>&) const {
    for (int k = 0; k < kAxes * kAxes; ++k) add(axis_entry(c, k));
  }
  template <class Field>
  void operator()(const FrameColumn& c, const Field&) const {
    add(std::string(c.key));
  }
  void add(const std::string& key) const { text += (text.empty() ? "" : ",") + key; }
};

/// Appends the cells of a line.
struct LineVisitor {
  std::string& text;

  void operator()(const FrameColumn&, const StatusCell<const FrameRecord>& cell) const {
    add(cell.record.bad ? "bad" : to_string(cell.record.status));
  }
  void operator()(const FrameColumn& c, const std::array<double, kAxes>& values) const {
    for (const double value : values) add(real(c, value));
  }
  void operator()(const FrameColumn& c, const std::optional<Matrix6d>& axes) const {
    for (int k = 0; k < kAxes * kAxes; ++k) add(axes ? real(c, axes->data()[k]) : "");
  }
  void operator()(const FrameColumn& c, double value) const { add(real(c, value)); }
  void operator()(const FrameColumn&, bool value) const { add(value ? "1" : "0"); }
  template <std::integral T>
  void operator()(const FrameColumn&, T value) const {
    add(std::to_string(value));
  }
  template <NamedEnum E>
  void operator()(const FrameColumn&, E value) const {
    add(to_string(value));
  }

  static std::string real(const FrameColumn& c, double value) {
    return std::isfinite(value) ? fmt::format(fmt::runtime(c.format), value) : "";
  }
  void add(const std::string& cell) const { text += (text.empty() ? "" : ",") + cell; }
};

/// Fills a record from the cells of a row; the first cell that does not fit is the error.
class RowVisitor {
 public:
  RowVisitor(const io::CsvTable& table, std::size_t row)
      : table_(table), row_(row), cells_(table.row(row)) {}

  void operator()(const FrameColumn& c, StatusCell<FrameRecord> cell) {
    const std::string_view text = cell_of(c.key);
    cell.record.bad = text == "bad";
    if (!cell.record.bad) (*this)(c, cell.record.status);
  }
  void operator()(const FrameColumn& c, std::array<double, kAxes>& values) {
    for (int k = 0; k < kAxes; ++k) read(numbered(c, k), values[static_cast<std::size_t>(k)]);
  }
  void operator()(const FrameColumn& c, std::optional<Matrix6d>& axes) {
    Matrix6d m;
    bool complete = true;
    for (int k = 0; k < kAxes * kAxes; ++k) {
      complete = read(axis_entry(c, k), m.data()[k]) && complete;
    }
    if (complete) axes = m;
  }
  void operator()(const FrameColumn& c, bool& value) {
    int number = value ? 1 : 0;
    if (read(std::string(c.key), number)) value = number != 0;
  }
  template <Number T>
  void operator()(const FrameColumn& c, T& value) {
    read(std::string(c.key), value);
  }
  template <NamedEnum E>
  void operator()(const FrameColumn& c, E& value) {
    const std::string_view text = cell_of(c.key);
    if (text.empty()) return;
    if (const auto parsed = from_string<E>(c.key, text)) {
      value = *parsed;
    } else {
      note(table_.bad_cell(row_, c.key, text, "one of its words"));
    }
  }

  const Status& status() const { return status_; }

 private:
  std::string_view cell_of(std::string_view key) const {
    const auto column = table_.column(key);
    return column ? cells_[*column] : std::string_view();
  }
  /// False where there is no number; an error where there is something else.
  template <Number T>
  bool read(const std::string& key, T& value) {
    const std::string_view text = cell_of(key);
    if (text.empty()) return false;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ec == std::errc{} && result.ptr == text.data() + text.size()) return true;
    note(table_.bad_cell(row_, key, text, "a number"));
    return false;
  }
  void note(const tl::unexpected<Error>& error) {
    if (status_) status_ = error;
  }

  const io::CsvTable& table_;
  std::size_t row_;
  std::vector<std::string_view> cells_;
  Status status_;
};

}  // namespace

std::string frames_csv_header() {
  std::string text;
  const FrameRecord any;
  visit_columns(any, HeaderVisitor{text});
  return text + "\n";
}

std::string frames_csv_line(const FrameRecord& record) {
  std::string text;
  bool over = false;
  visit_columns(record, [&](const FrameColumn& c, const auto& field) {
    if (over) return;
    LineVisitor{text}(c, field);
    over = record.bad && c.key == "status";
  });
  return text + "\n";
}

std::string frames_csv(std::span<const FrameRecord> records) {
  std::string text = frames_csv_header();
  for (const FrameRecord& record : records) text += frames_csv_line(record);
  return text;
}

Result<std::vector<FrameRecord>> frames_from_csv(std::string_view text, std::string_view source) {
  // limit: frame number in frames.csv
  constexpr std::int64_t kLargestIndex = 10'000'000;  // four days at 30 Hz
  SGS_ASSIGN_OR_RETURN(const auto table, io::CsvTable::parse(text, source));
  for (const char* needed : {"index", "timestamp_s", "status"}) {
    if (!table.column(needed)) {
      return fail(ErrorCode::kInvalidFormat,
                  fmt::format("{}: there is no column '{}'", source, needed),
                  "expected the frames.csv of a run");
    }
  }
  std::vector<FrameRecord> records(table.rows());
  for (std::size_t i = 0; i < records.size(); ++i) {
    RowVisitor visitor(table, i);
    visit_columns(records[i], visitor);
    SGS_RETURN_IF_ERROR(visitor.status());
    const std::int64_t least = i == 0 ? 0 : records[i - 1].index + 1;
    if (records[i].index < least || records[i].index > kLargestIndex) {
      return table.bad_cell(i, "index", std::to_string(records[i].index),
                            "a frame number in order");
    }
  }
  return records;
}

std::string frame_columns_markdown() {
  std::string text = "| column | unit | meaning |\n|---|---|---|\n";
  const FrameRecord any;
  visit_columns(any, [&]<class Field>(const FrameColumn& c, const Field&) {
    using T = std::decay_t<Field>;
    std::string name = fmt::format("`{}`", c.key);
    if constexpr (std::is_same_v<T, std::array<double, kAxes>>) {
      name = fmt::format("`{}` to `{}`", numbered(c, 0), numbered(c, kAxes - 1));
    } else if constexpr (std::is_same_v<T, std::optional<Matrix6d>>) {
      name = fmt::format("`{}` to `{}`", axis_entry(c, 0), axis_entry(c, kAxes * kAxes - 1));
    }
    std::string meaning(c.meaning);
    if constexpr (NamedEnum<T>) {
      meaning += " One of";
      for (const std::string_view word : enum_words<T>()) {
        meaning += fmt::format("{} `{}`", meaning.ends_with("of") ? "" : ",", word);
      }
      meaning += ".";
    }
    text += fmt::format("| {} | {} | {} |\n", name, c.unit, meaning);
  });
  return text;
}

}  // namespace sgs::slam

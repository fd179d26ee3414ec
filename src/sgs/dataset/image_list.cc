// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/image_list.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>
#include <tuple>

#include "sgs/core/text.h"
#include "sgs/dataset/calendar_time.h"
#include "sgs/dataset/frame_list.h"
#include "sgs/io/text.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kBlanks = " \t\r";

/// A row as it is read: times are not in seconds yet.
struct Row {
  double time = 0;
  bool whole = false;  ///< written without a fraction
  fs::path path;
  std::string origin;
  // In a list of pairs: the partner, and by how much later it was taken.
  fs::path depth = {};
  double depth_delay = 0;
};

tl::unexpected<Error> bad_line(const fs::path& list, const io::TextLine& line, const char* form) {
  constexpr std::size_t kShown = 120;
  return fail(ErrorCode::kInvalidFormat,
              fmt::format("{}:{}: cannot read '{}'", list.string(), line.number,
                          printable(line.text.substr(0, kShown))),
              fmt::format("each row must be '{}', times as numbers of seconds", form));
}

std::string_view trimmed(std::string_view text, std::string_view off) {
  const auto begin = text.find_first_not_of(off);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(off) - begin + 1);
}

bool is_number_with_comma(std::string_view text) {
  const auto comma = text.find(',');
  return comma != std::string_view::npos && comma > 0 && comma + 1 < text.size() &&
         text.find_first_not_of("0123456789,-+") == std::string_view::npos &&
         text.find(',', comma + 1) == std::string_view::npos;
}

/// The time at the front of a row and what follows it. A comma in the time is a decimal one if a
/// blank or a semicolon separates the time from the name.
struct Split {
  double time = 0;
  bool whole = false;
  std::string_view rest;
};

/// A date or a time of day at the front of a row; its own blanks and commas belong to it.
std::optional<Split> split_calendar_time(std::string_view text) {
  constexpr int kMostParts = 3;
  std::optional<Split> found;
  std::size_t end = 0;
  for (int part = 0; part < kMostParts && end != std::string_view::npos; ++part) {
    end = text.find_first_of(" \t;,", end + (part > 0 ? 1 : 0));
    if (end == std::string_view::npos) break;
    const auto time = calendar_seconds(trimmed(text.substr(0, end), "\""));
    const std::string_view rest = trimmed(text.substr(end), " \t\r;,");
    if (time && !rest.empty()) found = Split{*time, false, rest};
  }
  return found;
}

/// Whether a row goes on with a time: then what stood before it only counts the rows.
bool begins_with_time(std::string_view text) {
  constexpr std::size_t kDigitsOfTime = 9;
  const std::string_view token = text.substr(0, text.find_first_of(" \t;,"));
  const bool long_enough =
      token.size() >= kDigitsOfTime || token.find('.') != std::string_view::npos;
  return token.size() < text.size() && long_enough && io::parse_double(token).has_value();
}

std::optional<Split> split_time(std::string_view text) {
  if (const auto calendar = split_calendar_time(text)) return calendar;
  const auto end = std::min(text.find_first_of(" \t;"), text.size());
  std::string_view token = text.substr(0, end);
  std::string_view rest = trimmed(text.substr(end), " \t\r;,");
  if (rest.empty() || !is_number_with_comma(token)) {
    const auto comma = token.find(',');
    if (comma != std::string_view::npos) {
      rest = trimmed(text.substr(comma), " \t\r;,");
      token = token.substr(0, comma);
    }
  }
  token = trimmed(token, "\"");
  const auto time = io::parse_decimal(token);
  if (!time || !std::isfinite(*time) || rest.empty()) return std::nullopt;
  if (token.find_first_not_of("0123456789") == std::string_view::npos && begins_with_time(rest)) {
    return split_time(rest);
  }
  return Split{*time, token.find_first_of(".,eE") == std::string_view::npos, rest};
}

/// A picture under this name, or of this name and another ending; empty where there is none.
fs::path picture_there(const fs::path& file) {
  std::error_code error;
  if (fs::exists(file, error)) return file;
  for (const char* ending : {".png", ".jpg", ".jpeg"}) {
    const fs::path other = fs::path(file).replace_extension(ending);
    if (fs::exists(other, error)) return other;
  }
  return {};
}

/// The file that a list names: as written, or else with the other slash, in other letters, with
/// another ending, in the folder that is called as the list, or where a list of another machine has
/// its last folder.
fs::path file_named(const fs::path& folder, std::string_view name, const std::string& list) {
  name = trimmed(name, "\" \t\r");
  const fs::path plain = folder / name;
  std::error_code error;
  if (fs::exists(plain, error)) return plain;
  std::string slashed(name);
  std::replace(slashed.begin(), slashed.end(), '\\', '/');
  const fs::path written = slashed, last = written.parent_path().filename() / written.filename();
  // Archives that are unpacked beside each other hold one folder more.
  for (const fs::path& tried :
       {entry_of(folder, written.relative_path()), folder / last,
        folder / list / written.filename(), folder / list / written.relative_path()}) {
    if (const fs::path found = picture_there(tried); !found.empty()) return found;
  }
  return plain;
}

/// A name is what follows the time up to a blank, unless it is there only with its blanks.
fs::path named_file(const fs::path& folder, std::string_view rest, const std::string& list) {
  const auto fields = io::split_fields(rest, ",;");
  const std::string_view first = fields.empty() ? rest : fields.front();
  if (first.size() == rest.size()) return file_named(folder, first, list);
  std::error_code error;
  const fs::path whole = file_named(folder, rest, list);
  return fs::exists(whole, error) ? whole : file_named(folder, first, list);
}

/// Notes that pictures were found elsewhere than a list says.
void warn_of_other_names(const fs::path& list, std::string_view written, const fs::path& found,
                         std::vector<std::string>& warnings) {
  const fs::path as_written = list.parent_path() / trimmed(written, "\" \t\r");
  std::error_code error;
  if (found == as_written || fs::exists(as_written, error) || !fs::exists(found, error)) return;
  warnings.push_back(fmt::format("{}: '{}' is not there as it is written, {} is read, and so on",
                                 list.string(), printable(written), found.string()));
}

/// Times of rows in seconds, with a word about what they were.
TimeUnit bring_to_seconds(std::vector<Row>& rows, const fs::path& list,
                          std::vector<std::string>& warnings) {
  std::vector<double> times;
  for (const Row& row : rows) times.push_back(row.time);
  const bool written_whole =
      std::all_of(rows.begin(), rows.end(), [](const Row& r) { return r.whole; });
  // "1.0", "2.0", ...: numbers of frames from a program that knows no whole numbers.
  const bool counts = median_step(times) == 1 &&
                      std::all_of(rows.begin(), rows.end(),
                                  [](const Row& r) { return r.time == std::floor(r.time); });
  const bool even = steps_evenly(times);
  const double step = median_step(times);
  const TimeUnit unit = unit_of_times(std::move(times), written_whole || counts);
  if (unit.name.empty()) {
    constexpr double kLongestStep_s = 2;
    if (even && step > kLongestStep_s) {
      warnings.push_back(fmt::format(
          "{}: its times go by {:.3g} s, as evenly as a camera's do: if they are milliseconds, "
          "write them in seconds",
          list.string(), step));
    }
    return unit;
  }
  for (Row& row : rows) {
    row.time /= unit.per_second;
    row.depth_delay /= unit.per_second;
  }
  warnings.push_back(
      unit.known
          ? fmt::format("{}: its times are {}; they are brought to seconds", list.string(),
                        unit.name)
          : fmt::format("{}: its times are {}; they are taken as {:g} a second, which is a guess",
                        list.string(), unit.name, unit.per_second));
  return unit;
}

/// Leaves out what stands in a list more than once, as where lists were put together: it would look
/// like a clock that was set back. A row or two are left to put_in_order().
void drop_repeated(std::vector<Row>& rows, const fs::path& list,
                   std::vector<std::string>& warnings) {
  constexpr std::size_t kMany = 3;
  std::set<std::tuple<double, fs::path, fs::path>> seen;
  std::vector<Row> once;
  for (const Row& row : rows) {
    if (seen.insert({row.time, row.path, row.depth}).second) once.push_back(row);
  }
  const std::size_t repeated = rows.size() - once.size();
  if (repeated < kMany) return;
  rows = std::move(once);
  warnings.push_back(fmt::format("{}: {} rows stand there more than once, which are left out",
                                 list.string(), repeated));
}

/// The rows at which a clock that was set back begins anew; empty where times go back for another
/// reason.
std::vector<std::size_t> set_back_at(const std::vector<Row>& rows) {
  constexpr double kSetBack_s = 0.3;
  constexpr std::size_t kShortest = 3, kMost = 5;
  std::vector<std::size_t> begins;
  std::size_t begin = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (rows[i].time >= rows[i - 1].time) continue;
    const bool far = rows[i].time < rows[i - 1].time - kSetBack_s;
    if (!far || i - begin < kShortest || rows.size() - i < kShortest) return {};
    begins.push_back(i);
    begin = i;
  }
  return begins.size() <= kMost ? begins : std::vector<std::size_t>{};
}

/// Whether parts of a list only stand in another order: each begins where some other one ends.
bool are_parts_in_another_order(const std::vector<Row>& rows,
                                const std::vector<std::size_t>& begins, double step_s) {
  constexpr double kSteps = 20;
  for (std::size_t k = 0; k < begins.size(); ++k) {
    const std::size_t end = k + 1 < begins.size() ? begins[k + 1] : rows.size();
    const double before = rows[k == 0 ? 0 : begins[k - 1]].time - rows[end - 1].time;
    if (before < 0 || before > kSteps * step_s) return false;
  }
  return true;
}

/// Moves the stretches after a clock was set back behind those before. Returns by how much, as the
/// other list of the recording was moved where that has as many stretches.
std::vector<double> follow_set_back(std::vector<Row>& rows, const std::vector<double>& other_s,
                                    std::vector<std::string>& warnings) {
  const auto begins = set_back_at(rows);
  std::vector<double> times, moved_s;
  for (const Row& row : rows) times.push_back(row.time);
  const double step_s = median_step(times);
  if (are_parts_in_another_order(rows, begins, step_s)) return {};
  for (std::size_t k = 0; k < begins.size(); ++k) {
    const std::size_t begin = begins[k];
    const std::size_t end = k + 1 < begins.size() ? begins[k + 1] : rows.size();
    const double back_s = times[begin - 1] - times[begin];
    const double move_s = other_s.size() == begins.size()
                              ? other_s[k]
                              : rows[begin - 1].time + step_s - rows[begin].time;
    for (std::size_t i = begin; i < end; ++i) rows[i].time += move_s;
    moved_s.push_back(move_s);
    warnings.push_back(
        fmt::format("{}: the clock was set back by {:.3f} s; the {} rows after it "
                    "are a new stretch, moved to follow those before",
                    rows[begin].origin, back_s, end - begin));
  }
  return moved_s;
}

/// Sorts rows by time and drops repeated times, and says so. Times that lost their digits are an
/// error: what is left would be no recording.
Status put_in_order(std::vector<Row>& rows, const fs::path& list,
                    std::vector<std::string>& warnings) {
  const auto earlier = [](const Row& a, const Row& b) { return a.time < b.time; };
  if (!std::is_sorted(rows.begin(), rows.end(), earlier)) {
    warnings.push_back(fmt::format("{}: rows out of time order were sorted", list.string()));
    std::stable_sort(rows.begin(), rows.end(), earlier);
  }
  const std::size_t all = rows.size();
  const auto last = std::unique(rows.begin(), rows.end(),
                                [](const Row& a, const Row& b) { return a.time == b.time; });
  const auto different = static_cast<std::size_t>(last - rows.begin());
  constexpr std::size_t kFew = 3;
  if (all > kFew && 2 * different < all) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: its {} rows share {} different times: they lost their digits "
                            "(whole seconds, or single precision)",
                            list.string(), all, different),
                "write the times again with all their digits; or, without times, put an sgs.toml "
                "there with [sequence] color = \"rgb\", depth = \"depth\", match = \"order\", fps "
                "= 30 (the folders' names, and the camera's rate)");
  }
  if (different < all) {
    warnings.push_back(fmt::format("{}: {} rows with a repeated time were dropped", list.string(),
                                   all - different));
    rows.erase(last, rows.end());
  }
  return {};
}

/// Whether a row names a file that macOS left beside the real one.
bool is_left_behind_row(const Row& row) { return is_left_behind(row.path); }

Result<std::vector<Row>> read_rows(const fs::path& list, std::vector<std::string>& warnings) {
  SGS_ASSIGN_OR_RETURN(const std::string content, io::read_text(list));
  const fs::path folder = list.parent_path();
  const std::string of_list = io::lower_case(list.stem().string());
  std::vector<Row> rows;
  for (const io::TextLine& line : io::content_lines(content)) {
    const auto split = split_time(line.text);
    if (!split) {
      // A line of names on top.
      const bool heading = rows.empty() && line.number == 1 &&
                           line.text.find_first_of("0123456789") == std::string_view::npos;
      if (heading) continue;
      return bad_line(list, line, "timestamp filename");
    }
    rows.push_back({split->time, split->whole, named_file(folder, split->rest, of_list),
                    fmt::format("{}:{}", list.string(), line.number)});
    if (rows.size() == 1) warn_of_other_names(list, split->rest, rows.back().path, warnings);
  }
  std::erase_if(rows, is_left_behind_row);
  drop_repeated(rows, list, warnings);
  if (rows.empty()) {
    return fail(ErrorCode::kInvalidFormat, fmt::format("{}: lists no images", list.string()),
                "each row must be 'timestamp filename'");
  }
  return rows;
}

/// One row of associations.txt.
struct Association {
  Split first, second;  ///< what follows the times are the names
};

/// "time name time name", or "time name name"; names may have blanks, and then the second time is
/// the number that both files are there with.
std::optional<Association> split_association(std::string_view text, const fs::path& folder) {
  const auto first = split_time(text);
  if (!first) return std::nullopt;
  std::optional<Association> found;
  for (std::size_t at = 0; (at = first->rest.find_first_of(" \t;,", at)) != std::string_view::npos;
       ++at) {
    const auto second = split_time(trimmed(first->rest.substr(at), " \t;,"));
    if (!second) continue;
    Association candidate{*first, *second};
    candidate.first.rest = trimmed(first->rest.substr(0, at), " \t;,");
    std::error_code error;
    if (!found) found = candidate;
    if (candidate.first.rest.find_first_of(kBlanks) == std::string_view::npos) return candidate;
    if (fs::exists(file_named(folder, candidate.first.rest, "rgb"), error)) return candidate;
  }
  const auto names = io::split_fields(first->rest, ",;");
  if (!found && names.size() == 2) {
    const auto named = [&](std::string_view name) {
      return Split{first->time, first->whole, name};
    };
    return Association{named(names[0]), named(names[1])};
  }
  return found;
}

}  // namespace

Result<ImageList> read_image_list(const fs::path& list, std::vector<std::string>& warnings,
                                  const std::vector<double>& moved_s) {
  SGS_ASSIGN_OR_RETURN(auto rows, read_rows(list, warnings));
  ImageList out;
  out.rows = rows.size();
  const auto [first, last] = std::minmax_element(
      rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.time < b.time; });
  out.first = first->time;
  out.last = last->time;
  out.unit = bring_to_seconds(rows, list, warnings);
  out.moved_s = follow_set_back(rows, moved_s, warnings);
  SGS_RETURN_IF_ERROR(put_in_order(rows, list, warnings));
  for (Row& row : rows) {
    out.images.push_back({row.time, std::move(row.path), std::move(row.origin)});
  }
  return out;
}

// associate.py writes colour first; some tools write depth first, which the folder's name gives
// away.
Result<TimeUnit> read_associations(const fs::path& list, bool frame_numbers, FrameList& out) {
  SGS_ASSIGN_OR_RETURN(const std::string content, io::read_text(list));
  const fs::path folder = list.parent_path();
  std::vector<Row> rows;
  for (const io::TextLine& line : io::content_lines(content)) {
    const auto both = split_association(line.text, folder);
    if (!both) return bad_line(list, line, "timestamp color timestamp depth");
    const bool swapped =
        both->first.rest.starts_with("depth") && !both->second.rest.starts_with("depth");
    const Split &color = swapped ? both->second : both->first,
                &depth = swapped ? both->first : both->second;
    rows.push_back({color.time, color.whole, named_file(folder, color.rest, "rgb"),
                    fmt::format("{}:{}", list.string(), line.number),
                    named_file(folder, depth.rest, "depth"), depth.time - color.time});
    if (rows.size() == 1) warn_of_other_names(list, color.rest, rows.back().path, out.warnings);
  }
  if (rows.empty()) {
    return fail(ErrorCode::kInvalidFormat, fmt::format("{}: lists no images", list.string()),
                "each row must be 'timestamp color timestamp depth'");
  }
  drop_repeated(rows, list, out.warnings);
  out.color_images = rows.size();
  TimeUnit unit;
  if (!frame_numbers) unit = bring_to_seconds(rows, list, out.warnings);
  out.clock_set_back = !follow_set_back(rows, {}, out.warnings).empty();
  SGS_RETURN_IF_ERROR(put_in_order(rows, list, out.warnings));
  for (Row& row : rows) {
    FrameEntry& frame = out.frames.emplace_back(
        FrameEntry{row.time, std::move(row.path), std::move(row.depth), row.origin, row.origin});
    frame.depth_delay_s = row.depth_delay;
  }
  return unit;
}

}  // namespace sgs::dataset

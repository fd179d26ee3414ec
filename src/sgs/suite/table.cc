// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/suite/table.h"

#include <algorithm>
#include <array>
#include <optional>

namespace sgs::suite {
namespace {

constexpr std::string_view kPublished = "published, on the real sequences";

void add_once(std::vector<std::string>& names, const std::string& name) {
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

/// Width of each column, that of the names first.
std::vector<std::size_t> widths(const std::vector<Table::Row>& rows) {
  std::vector<std::size_t> out(rows[0].cells.size() + 1, 0);
  for (const Table::Row& row : rows) {
    out[0] = std::max(out[0], row.name.size());
    for (std::size_t i = 1; i < out.size(); ++i) {
      out[i] = std::max(out[i], row.cells[i - 1].size());
    }
  }
  return out;
}

/// Names to the left, cells to the right.
std::string line(const Table::Row& row, const std::vector<std::size_t>& widths) {
  std::string text = fmt::format("{:<{}}", row.name, widths[0]);
  for (std::size_t i = 1; i < widths.size(); ++i) {
    text += fmt::format("  {:>{}}", row.cells[i - 1], widths[i]);
  }
  return text.erase(text.find_last_not_of(' ') + 1) + "\n";
}

std::string published_cell(const Publication::Row& row, const std::string& sequence) {
  const auto found = row.ate_cm.find(sequence);
  if (found == row.ate_cm.end()) return "";
  return found->second ? fmt::format("{:.2f}", *found->second) : "lost";
}

std::string processor_of(const eval::Metrics& m) { return m.cpu.value_or("unknown CPU"); }

/// Mean of what was measured; empty where nothing was.
std::optional<double> mean_of(std::span<const eval::Metrics> runs,
                              eval::Metrics::Real eval::Metrics::*value) {
  double sum = 0;
  int count = 0;
  for (const eval::Metrics& m : runs) {
    if (!(m.*value)) continue;
    sum += *(m.*value);
    ++count;
  }
  return count == 0 ? std::nullopt : std::optional(sum / count);
}

std::string times_cell(std::span<const eval::Metrics> runs) {
  const auto fps = mean_of(runs, &eval::Metrics::fps_wall);
  const auto p95_ms = mean_of(runs, &eval::Metrics::track_ms_p95);
  if (!fps && !p95_ms) return "-";
  const auto text = [](const char* format, const std::optional<double>& value) {
    return value ? fmt::format(fmt::runtime(format), *value) : "-";
  };
  return text("{:.0f}", fps) + " / " + text("{:.1f}", p95_ms);
}

/// How many runs of a grid each processor made.
std::map<std::string, int> processors_of(const Grid& grid) {
  std::map<std::string, int> counts;
  for (const auto& [place, runs] : grid.runs) {
    if (place.second == Publication::kAverage) continue;
    for (const eval::Metrics& m : runs) ++counts[processor_of(m)];
  }
  return counts;
}

/// A score of pictures, ours and others'.
struct PictureScore {
  const char* title;
  eval::Metrics::Real eval::Metrics::*ours;
  std::map<std::string, double> Publication::Row::*theirs;
  int digits;
};

const std::array<PictureScore, 3> kPictureScores = {{
    {"PSNR in dB (rule gsicp), mean over seeds", &eval::Metrics::psnr_db,
     &Publication::Row::psnr_db, 2},
    {"SSIM (rule gsicp), mean over seeds", &eval::Metrics::ssim, &Publication::Row::ssim, 3},
    {"LPIPS (rule gsicp), mean over seeds", &eval::Metrics::lpips, &Publication::Row::lpips, 3},
}};

/// Mean over runs; "-" where none measured it.
std::string mean_cell(std::span<const eval::Metrics> runs,
                      eval::Metrics::Real eval::Metrics::*value, int digits) {
  const auto mean = mean_of(runs, value);
  return mean ? fmt::format("{:.{}f}", *mean, digits) : "-";
}

/// Adds a published row where any of its cells says something.
void add_published(Table::Row row, const std::string& source, Table& table) {
  const bool any = std::any_of(row.cells.begin(), row.cells.end(),
                               [](const std::string& cell) { return !cell.empty(); });
  if (!any) return;
  if (table.sources.empty() || table.sources.back() != source) table.sources.push_back(source);
  row.name += fmt::format(" [{}]", table.sources.size());
  table.published.push_back(std::move(row));
}

Table picture_table(const PictureScore& score, const Grid& grid,
                    const std::vector<Publication>& publications) {
  Table table{score.title, grid.columns, {}, {}, {}};
  for (const std::string& name : grid.rows) {
    Table::Row& row = table.rows.emplace_back(Table::Row{name, {}});
    for (const std::string& column : grid.columns) {
      row.cells.push_back(mean_cell(grid.at(name, column), score.ours, score.digits));
    }
  }
  for (const Publication& publication : publications) {
    for (const Publication::Row& result : publication.results) {
      Table::Row row{result.system, {}};
      for (const std::string& column : grid.columns) {
        const auto found = (result.*score.theirs).find(column);
        row.cells.push_back(found == (result.*score.theirs).end()
                                ? ""
                                : fmt::format("{:.{}f}", found->second, score.digits));
      }
      add_published(std::move(row), publication.source, table);
    }
  }
  return table;
}

/// Theirs is one number over all sequences, so ours is, too.
Table speed_table(const Grid& grid, const std::vector<Publication>& publications) {
  Table table{"Frames per second, mean over sequences and seeds", {"all"}, {}, {}, {}};
  for (const std::string& name : grid.rows) {
    std::vector<eval::Metrics> all;
    for (const std::string& column : grid.columns) {
      if (column == Publication::kAverage) continue;  // these are in the others
      const auto runs = grid.at(name, column);
      all.insert(all.end(), runs.begin(), runs.end());
    }
    table.rows.push_back({name, {mean_cell(all, &eval::Metrics::fps_system, 1)}});
  }
  for (const Publication& publication : publications) {
    for (const Publication::Row& result : publication.results) {
      add_published({result.system, {result.fps ? fmt::format("{:.2f}", *result.fps) : ""}},
                    publication.source, table);
    }
  }
  return table;
}

/// Whether anybody published a mean over all sequences.
bool any_average(const std::vector<Publication>& publications) {
  const auto has_one = [](const Publication::Row& row) {
    const std::string key = Publication::kAverage;
    return row.ate_cm.contains(key) || row.psnr_db.contains(key) || row.ssim.contains(key) ||
           row.lpips.contains(key);
  };
  return std::any_of(publications.begin(), publications.end(), [&](const Publication& one) {
    return std::any_of(one.results.begin(), one.results.end(), has_one);
  });
}

std::string source_lines(const Table& table, std::string_view bullet) {
  std::string text;
  for (std::size_t i = 0; i < table.sources.size(); ++i) {
    text += fmt::format("{}[{}] {}\n", bullet, i + 1, table.sources[i]);
  }
  return text;
}

}  // namespace

std::span<const eval::Metrics> Grid::at(const std::string& row, const std::string& column) const {
  const auto found = runs.find({row, column});
  return found == runs.end() ? std::span<const eval::Metrics>() : found->second;
}

Grid collect(std::span<const Job> jobs, const NameOf& row, const NameOf& column) {
  Grid grid;
  for (const Job& job : jobs) {
    add_once(grid.rows, row(job));
    add_once(grid.columns, column(job));
    if (auto scores = job_metrics(job)) grid.runs[{row(job), column(job)}].push_back(*scores);
  }
  return grid;
}

void complete(const Suite& suite, const std::vector<std::string>& names, Grid& grid) {
  grid.columns = names;
  if (names.size() != suite.sequences.size() || !any_average(suite.publications)) return;
  grid.columns.push_back(Publication::kAverage);
  for (const std::string& row : grid.rows) {
    std::vector<eval::Metrics> all;
    bool whole = true;
    for (const std::string& name : names) {
      const auto runs = grid.at(row, name);
      whole = whole && !runs.empty();
      all.insert(all.end(), runs.begin(), runs.end());
    }
    if (whole) grid.runs[{row, Publication::kAverage}] = std::move(all);
  }
}

Table ate_table(const Grid& grid, std::string title) {
  Table table{std::move(title), grid.columns, {}, {}, {}};
  for (const std::string& name : grid.rows) {
    Table::Row& row = table.rows.emplace_back(Table::Row{name, {}});
    for (const std::string& column : grid.columns)
      row.cells.push_back(ate_cell(grid.at(name, column)));
  }
  return table;
}

Table times_table(const Grid& grid, std::string title) {
  Table table{std::move(title), grid.columns, {}, {}, {}};
  for (const std::string& name : grid.rows) {
    for (const auto& [processor, count] : processors_of(grid)) {
      Table::Row row{fmt::format("{}, {}", name, processor), {}};
      bool any = false;
      for (const std::string& column : grid.columns) {
        std::vector<eval::Metrics> runs;
        for (const eval::Metrics& m : grid.at(name, column)) {
          if (processor_of(m) == processor) runs.push_back(m);
        }
        any = any || !runs.empty();
        row.cells.push_back(times_cell(runs));
      }
      if (any) table.rows.push_back(std::move(row));
    }
  }
  return table;
}

std::string processors_line(const Grid& grid) {
  const auto counts = processors_of(grid);
  if (counts.size() < 2) return "";
  std::vector<std::string> parts;
  for (const auto& [processor, count] : counts) {
    parts.push_back(fmt::format("{} on {}", count, processor));
  }
  return fmt::format("runs: {}; their times are not to be compared\n", fmt::join(parts, ", "));
}

void add_publications(const std::vector<Publication>& publications, Table& table) {
  for (const Publication& publication : publications) {
    const std::size_t number = table.sources.size() + 1, before = table.published.size();
    for (const Publication::Row& result : publication.results) {
      Table::Row row{fmt::format("{} [{}]", result.system, number), {}};
      for (const std::string& name : table.columns)
        row.cells.push_back(published_cell(result, name));
      const bool any = std::any_of(row.cells.begin(), row.cells.end(),
                                   [](const std::string& cell) { return !cell.empty(); });
      if (any) table.published.push_back(std::move(row));
    }
    if (table.published.size() > before) table.sources.push_back(publication.source);
  }
}

std::vector<Table> published_tables(const Grid& grid,
                                    const std::vector<Publication>& publications) {
  std::vector<Table> tables;
  for (const PictureScore& score : kPictureScores) {
    tables.push_back(picture_table(score, grid, publications));
  }
  tables.push_back(speed_table(grid, publications));
  std::erase_if(tables, [](const Table& table) { return table.published.empty(); });
  return tables;
}

std::string ate_cell(std::span<const eval::Metrics> runs) {
  double sum = 0, worst = 0, tracked = 100;
  int count = 0;
  for (const eval::Metrics& m : runs) {
    if (m.frames && m.frames_tracked && *m.frames > 0) {
      tracked = std::min(
          tracked, 100.0 * static_cast<double>(*m.frames_tracked) / static_cast<double>(*m.frames));
    }
    if (!m.ate_rmse_m) continue;
    sum += 100 * *m.ate_rmse_m;
    worst = std::max(worst, 100 * *m.ate_rmse_m);
    ++count;
  }
  if (count == 0) return "-";
  std::string text = fmt::format("{:.2f} ({:.2f})", sum / count, worst);
  if (tracked < 99.95) text += fmt::format(" {:.0f}%", tracked);
  return text;
}

std::string as_text(const Table& table) {
  std::vector<Table::Row> all = {{"", table.columns}};
  all.insert(all.end(), table.rows.begin(), table.rows.end());
  all.insert(all.end(), table.published.begin(), table.published.end());
  const auto aligned = widths(all);
  std::string text = table.title + "\n";
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i == 1 + table.rows.size()) text += fmt::format("{}\n", kPublished);
    text += line(all[i], aligned);
  }
  return text + source_lines(table, "");
}

std::string as_markdown(const Table& table) {
  std::string text = table.title + "\n\n";
  const auto add = [&](const Table::Row& row) {
    text += fmt::format("| {} | {} |\n", row.name, fmt::join(row.cells, " | "));
  };
  add({"", table.columns});
  text += "|";
  for (std::size_t i = 0; i <= table.columns.size(); ++i) text += "---|";
  text += "\n";
  for (const Table::Row& row : table.rows) add(row);
  for (const Table::Row& row : table.published) add(row);
  if (table.published.empty()) return text;
  return text + fmt::format("\nNumbered rows: {}.\n\n", kPublished) + source_lines(table, "- ");
}

}  // namespace sgs::suite

// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sgs/suite/jobs.h"

namespace sgs::suite {

/// Scores of runs over two of their properties; names in order of appearance.
struct Grid {
  std::vector<std::string> rows, columns;
  /// By row and column; what has no scores is left out.
  std::map<std::pair<std::string, std::string>, std::vector<eval::Metrics>> runs;

  std::span<const eval::Metrics> at(const std::string& row, const std::string& column) const;
};

using NameOf = std::function<std::string(const Job&)>;
Grid collect(std::span<const Job> jobs, const NameOf& row, const NameOf& column);

/// Gives a grid the columns `names`, so that what is missing shows. Where these are all sequences
/// of the suite, and anybody published the mean over them, a last column is for that; a row has it
/// when all of its columns have runs.
void complete(const Suite& suite, const std::vector<std::string>& names, Grid& grid);

/// A table to be printed.
struct Table {
  struct Row {
    std::string name;
    std::vector<std::string> cells;  ///< one per column
  };
  std::string title;
  std::vector<std::string> columns;
  std::vector<Row> rows;
  std::vector<Row> published;        ///< of others; the names end in the number of a source
  std::vector<std::string> sources;  ///< of the published rows
};

/// Trajectory errors over seeds.
Table ate_table(const Grid& grid, std::string title);
/// Adds what others published of the table's columns.
void add_publications(const std::vector<Publication>& publications, Table& table);

/// Frames per second with decoding and the 95th percentile of tracking in ms, mean over the runs of
/// one processor: a row for each, as times of different ones are not to be mixed.
Table times_table(const Grid& grid, std::string title);
/// How many runs were made on which processor, as a line; "" where it was one.
std::string processors_line(const Grid& grid);
/// PSNR, SSIM and LPIPS (rule gsicp) and frames per second beside what others published of them: a
/// table for each of which anybody published anything. Published columns are of real recordings.
std::vector<Table> published_tables(const Grid& grid, const std::vector<Publication>& publications);

/// "mean (worst)" of the trajectory error in cm over seeds, with the lowest share of frames with a
/// pose within 1 m of the truth when it is not all of them; "-" without runs.
std::string ate_cell(std::span<const eval::Metrics> runs);

/// Aligned columns for a terminal.
std::string as_text(const Table& table);
/// Markdown, the title and the sources around the table.
std::string as_markdown(const Table& table);

}  // namespace sgs::suite

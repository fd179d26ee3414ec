// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/report_data.h"

#include <algorithm>
#include <cmath>

namespace sgs::eval {

void check_columns(const ReportData& data) {
  const auto check = [](const Column& column, std::size_t size) {
    SGS_CHECK(column.empty() || column.size() == size,
              "a column of the report is not as long as its time");
  };
  const std::size_t frames = data.time_s.size();
  for (const Column* column :
       {&data.error_m, &data.status, &data.mapping_keyframe, &data.track_ms, &data.iterations,
        &data.gaussians, &data.prior_active, &data.condition_number, &data.planarity}) {
    check(*column, frames);
  }
  for (const Column& column : data.weights) check(column, frames);
  for (const Column& column : data.snr) check(column, frames);
  for (const auto& [name, column] : data.stage_ms) check(column, frames);
  check(data.estimate_time_s, data.estimate_m.size());
  check(data.estimate_error_m, data.estimate_m.size());
}

bool has_data(const Column& column) {
  return std::any_of(column.begin(), column.end(), [](double v) { return std::isfinite(v); });
}

const std::string& run_name(const ReportData& data) {
  return data.label.empty() ? data.title : data.label;
}

}  // namespace sgs::eval

// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/frame_record.h"

#include <fmt/format.h>

#include <cmath>

namespace sgs::slam {
namespace {

std::string cell(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : ""; }

template <class Array>
void append_array(std::string& line, const Array& values) {
  for (const double value : values) line += "," + cell(value);
}

std::string record_line(const FrameRecord& r) {
  const tracker::Diagnostics& d = r.diagnostics;
  std::string line = fmt::format("{},{:.9f},{}", r.index, r.timestamp_s,
                                 r.bad ? "bad" : tracker::to_string(r.status));
  if (r.bad) return line;
  line += fmt::format(",{:d},{:d},{:d}", r.tracking_keyframe, r.mapping_keyframe, r.heldout);
  line += "," + cell(r.track_ms);
  line += fmt::format(",{},{}", r.gaussians, r.iterations);
  line += fmt::format(",{},{},{}", d.source_points, d.inliers, d.visual_inliers);
  line += "," + cell(d.overlap) + "," + cell(d.cost) + "," + cell(d.visual_cost) + "," +
          cell(d.readout_s) + fmt::format(",{}", d.iterations);
  line += "," + cell(d.condition_number) + "," + cell(d.planarity);
  line += fmt::format(",{},{:d},{}", tracker::to_string(d.prior_source), d.prior_active,
                      d.degenerate_mask);
  append_array(line, d.eigenvalues);
  append_array(line, d.snr);
  append_array(line, d.weights);
  for (const double ms : {d.ms_points, d.ms_index, d.ms_geometry, d.ms_visual, d.ms_update}) {
    line += "," + cell(ms);
  }
  for (int k = 0; k < 36; ++k) line += d.axes ? fmt::format(",{:.4g}", d.axes->data()[k]) : ",";
  return line;
}

}  // namespace

std::string frames_csv(const std::deque<FrameRecord>& records) {
  std::string text =
      "index,timestamp_s,status,tracking_keyframe,mapping_keyframe,heldout,track_ms,gaussians,"
      "mapping_iterations,source_points,inliers,visual_inliers,overlap,cost,visual_cost,readout_s,"
      "tracking_iterations,"
      "condition_number,planarity,prior_source,prior_active,degenerate_mask";
  for (const char* name : {"eigenvalue", "snr", "weight"}) {
    for (int k = 0; k < 6; ++k) text += fmt::format(",{}_{}", name, k);
  }
  text += ",ms_points,ms_index,ms_geometry,ms_visual,ms_update";
  for (int k = 0; k < 36; ++k) text += fmt::format(",axis_{}_{}", k / 6, k % 6);
  text += "\n";
  for (const FrameRecord& record : records) text += record_line(record) + "\n";
  return text;
}

}  // namespace sgs::slam

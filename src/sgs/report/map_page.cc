// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/map_page.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "sgs/io/atomic_file.h"
#include "sgs/io/splat_check.h"
#include "sgs/io/splat_file.h"
#include "sgs/report/html.h"
#include "sgs/report/page.h"
#include "sgs/report/page_files.h"
#include "sgs/report/plot/canvas.h"

namespace sgs::report {
namespace {

using Json = nlohmann::json;

Json vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// Twelve numbers per camera: position, then the rotation row by row.
Json cameras_json(const std::vector<SE3>& cameras) {
  Json json = Json::array();
  for (const SE3& T : cameras) {
    Json one = Json::array();
    for (int k = 0; k < 3; ++k) one.push_back(T.t[k]);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) one.push_back(T.R(row, column));
    }
    json.push_back(one);
  }
  return json;
}

Json page_json(const MapPage& page) {
  const PinholeCamera& c = page.camera;
  Json json = {{"cameras", cameras_json(page.cameras)}, {"up", vector_json(page.up)}};
  if (c.valid()) {
    json["camera"] = {c.width, c.height, c.fx, c.fy, c.cx, c.cy};
  }
  return json;
}

}  // namespace

std::string map_page_html(const map::SplatMap& map, const MapPage& page) {
  std::string html = page_head(page.title, page_text("map.css"));
  html += "<body><canvas tabindex='0' role='img' aria-label='Map of " + html_escaped(page.title) +
          " in three dimensions; arrow keys turn it, plus and minus zoom, n and p change the "
          "view'></canvas><header><h1>" +
          html_escaped(page.title) + "</h1><small id='status'>" +
          fmt::format("{} Gaussians", map.gaussians.size()) +
          "</small></header><footer><button id='previous'>‹ view</button><button id='next'>view ›"
          "</button><small>drag turns, shift-drag moves, wheel zooms</small></footer>"
          "<script type='application/json' id='page'>" +
          page_json(page).dump() + "</script><script type='text/plain' id='splats'>";
  html += base64(io::splat_records(map.gaussians));
  html += fmt::format("</script><script type='text/plain' id='harmonics' data-degree='{}'>",
                      map.harmonics.degree);
  html += base64(io::harmonic_records(map.harmonics));
  html += "</script>";
  html += script_html({"vec.mjs", "splats.mjs", "splat_shaders.mjs", "map.mjs"});
  return html + "</body></html>\n";
}

Status save_map_page(const std::filesystem::path& path, const map::SplatMap& map,
                     const MapPage& page) {
  SGS_RETURN_IF_ERROR(io::check_splats(path, map.gaussians, map.harmonics));
  return io::write_file(path, map_page_html(map, page));
}

}  // namespace sgs::report

// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Splat PLY: what loads is finite, can be saved in every format, and loads again.
#include <cmath>

#include "harness.h"
#include "sgs/io/ply.h"
#include "sgs/io/splat_file.h"
#include "sgs/io/spz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sgs;
  const fuzz::MemoryFile file({reinterpret_cast<const char*>(data), size});
  const auto splats = io::load_splats(file.path());
  if (!splats) return 0;
  for (const map::Gaussian& g : splats->gaussians) {
    for (const float x : g.mean) fuzz::require(std::isfinite(x), "positions are finite");
  }
  const auto ply = fuzz::scratch_file("a.ply"), spz = fuzz::scratch_file("a.spz");
  const bool saved = io::save_splats(ply, splats->gaussians, splats->harmonics).has_value();
  fuzz::require(saved, "what loads can be saved");
  const auto again = io::load_splats(ply);
  fuzz::require(again && again->gaussians.size() == splats->gaussians.size() &&
                    again->harmonics.size() == splats->harmonics.size(),
                "what was saved loads again");
  if (io::save_spz(spz, splats->gaussians,
                   splats->harmonics)) {  // positions may be too far apart for it
    const auto packed = io::load_spz(spz);
    fuzz::require(packed && packed->gaussians.size() == splats->gaussians.size(),
                  "SPZ loads again");
  }
  const std::string records = io::splat_records(splats->gaussians);
  fuzz::require(io::splats_from_records(records).size() == splats->gaussians.size(),
                "records load again");
  return 0;
}

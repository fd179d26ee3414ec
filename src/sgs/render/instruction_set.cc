// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/render/instruction_set.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sgs/core/simd_targets.h"
// After targets.h, which says what is compiled for.
#include <hwy/highway.h>

#include <array>
#include <utility>

namespace sgs::render {
namespace {

using Named = std::pair<const char*, std::int64_t>;
constexpr std::array<Named, 6> kNames = {{{"avx512", HWY_AVX3},
                                          {"avx2", HWY_AVX2},
                                          {"sse4", HWY_SSE4},
                                          {"neon", HWY_NEON},
                                          {"emulated", HWY_EMU128},
                                          {"scalar", HWY_SCALAR}}};

}  // namespace

std::vector<std::string> instruction_sets() {
  std::vector<std::string> names;
  for (const auto& [name, target] : kNames) {
    if ((hwy::SupportedTargets() & HWY_TARGETS & target) != 0) names.emplace_back(name);
  }
  return names;
}

Status use_instruction_set(const std::string& name) {
  hwy::SetSupportedTargetsForTest(0);
  if (name == "best") return {};
  const auto available = instruction_sets();
  for (const auto& [known, target] : kNames) {
    if (name != known || (hwy::SupportedTargets() & HWY_TARGETS & target) == 0) continue;
    hwy::SetSupportedTargetsForTest(target);
    return {};
  }
  return fail(ErrorCode::kInvalidArgument, fmt::format("no kernels for '{}' here", name),
              fmt::format("choose best or one of {}", fmt::join(available, ", ")));
}

}  // namespace sgs::render

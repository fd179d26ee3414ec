// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

#include "sgs/core/enum_names.h"

namespace sgs::alignment {

/// Why a frame has no pose that can be trusted. Where several things were wrong, the one that was
/// looked at first counts: geometry before the picture, the picture before the motion.
enum class LostReason {
  kNone,
  kNoDepth,
  kTooFewPoints,
  kTooFewMatches,
  kTooFewPixels,
  kPoorPictureFit,
  kUnseenAxis,
  kTooFewFeatures,
  kTooFewFeatureMatches,
  kTooFewFeatureInliers,
  kImplausibleMotion,
  kNotFinite,
  kNoPose,
  kNotInMap,
  kOther,  ///< for trackers of which this list knows nothing
};

/// A reason, its name in frames.csv and one sentence for people.
struct LostReasonEntry {
  LostReason reason;
  std::string_view name, sentence;
};

inline constexpr auto kLostReasons = std::to_array<LostReasonEntry>({
    {LostReason::kNone, "none", "The frame was tracked."},
    {LostReason::kNoDepth, "no_depth", "The depth image has no surface within the depth range."},
    {LostReason::kTooFewPoints, "too_few_points",
     "The depth image gave fewer surface points than tracker.loss.min_points."},
    {LostReason::kTooFewMatches, "too_few_matches",
     "Too few of the frame's points found a counterpart in the map."},
    {LostReason::kTooFewPixels, "too_few_pixels",
     "Geometry leaves an axis open, and too few textured pixels are seen again to fill it."},
    {LostReason::kPoorPictureFit, "poor_picture_fit",
     "Geometry leaves an axis open, and the picture does not fit the keyframes' pictures."},
    {LostReason::kUnseenAxis, "unseen_axis",
     "Neither geometry nor texture shows the motion along one axis."},
    {LostReason::kTooFewFeatures, "too_few_features",
     "The frame has too few features with measured depth."},
    {LostReason::kTooFewFeatureMatches, "too_few_feature_matches",
     "Too few features of the frame match those of the map or of the last frame."},
    {LostReason::kTooFewFeatureInliers, "too_few_feature_inliers",
     "Features match, but too few of them agree on one pose."},
    {LostReason::kImplausibleMotion, "implausible_motion",
     "The pose that was found is farther away than a camera moves within a frame."},
    {LostReason::kNotFinite, "not_finite",
     "The pose or the timestamp that it was predicted for is not a number."},
    {LostReason::kNoPose, "no_pose", "Poses are given, but none for this frame."},
    {LostReason::kNotInMap, "not_in_map",
     "The camera has not found itself in the map that it was given."},
    {LostReason::kOther, "other", "The tracker says no more than that."},
});

constexpr auto enum_names(LostReason) {
  std::array<EnumName<LostReason>, kLostReasons.size()> names{};
  for (std::size_t i = 0; i < names.size(); ++i) {
    names[i] = {kLostReasons[i].reason, kLostReasons[i].name};
  }
  return names;
}

/// The sentence that explains `reason`.
constexpr std::string_view explain(LostReason reason) {
  for (const LostReasonEntry& entry : kLostReasons) {
    if (entry.reason == reason) return entry.sentence;
  }
  return "";
}

}  // namespace sgs::alignment

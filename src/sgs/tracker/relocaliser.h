// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "sgs/alignment/known_view.h"
#include "sgs/alignment/local_past.h"
#include "sgs/features/ferns.h"
#include "sgs/features/orb.h"
#include "sgs/history/view_store.h"
#include "sgs/tracker/tracker_config.h"

namespace sgs::tracker {

/// Finds the camera again after it was lost: among all visual keyframes those that look most alike
/// (features::Ferns), and of these ORB features matched without a prediction. Features are
/// extracted at about 320 pixels of width, only when they are needed, so that a run that is never
/// lost never pays for them; and only then views are read from the disk. A camera with a foreign
/// map may see it from elsewhere than it was made from: of its views more are compared, by more
/// features, of the whole picture.
class Relocaliser {
 public:
  explicit Relocaliser(const RelocaliserConfig& config);

  /// Where frames are remembered from now on; before that in a store of its own.
  void remember_in(std::shared_ptr<history::ViewStore> views) { views_ = std::move(views); }

  /// Remembers a view of a finished map for good; `frame` is what a camera like that of the frames
  /// to come saw there, under the view's index in the path.
  void know(const alignment::KnownView& view, const RgbdFrame& frame);
  /// Remembers a keyframe, its depth corrected by `calibration`; the oldest makes room.
  void add_keyframe(const RgbdFrame& frame, const history::CalibrationPtr& calibration);
  /// Pose of a frame among the remembered keyframes, camera to local; empty when none fits. `past`
  /// tells where those are. `view`: of another map whose frame this is; its code in colour counts.
  std::optional<SE3> relocalise(const RgbdFrame& frame, const alignment::LocalPast& past,
                                const alignment::KnownView* view = nullptr);

  /// How near the last relocalise() came.
  struct Look {
    int matches = 0, inliers = 0;  ///< features alike, and those of them that agree on one pose
    std::int64_t keyframe = 0;     ///< index of the one that is most alike
    bool drawn = false;            ///< whether that is a drawing of the map
  };
  const Look& last_look() const { return last_look_; }

 private:
  struct Keyframe {
    std::int64_t frame;  // its index
    features::FernCode ferns;
    history::StoredViewPtr view;                      // null: of a map, its features are all
    std::optional<features::OrbFrame> features = {};  // once they were needed
    history::CalibrationPtr calibration = {};         // of their depth
    bool drawn = false;                               // nobody's view, but the map's
  };
  /// Views of a map whose codes answer the same questions.
  struct KnownViews {
    std::uint64_t fern_seed;
    features::Ferns ferns;
    std::vector<Keyframe> keyframes;
  };
  /// For pictures of the frames that come.
  features::OrbConfig orb() const;
  std::vector<Keyframe*> most_alike(const RgbdFrame& frame, const alignment::KnownView* view);
  bool extract(Keyframe& keyframe, const history::CalibrationPtr& calibration) const;

  RelocaliserConfig config_;
  std::shared_ptr<history::ViewStore> views_;
  features::Ferns ferns_{0};
  std::deque<Keyframe> keyframes_;
  std::vector<KnownViews> known_;
  Look last_look_;
};

}  // namespace sgs::tracker

// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sgs::tracker {

/// What one alignment says about whether the camera is where it says.
struct Evidence {
  bool trusted = false;  ///< all axes are held by something, and the motion is possible
  bool explained_by_surfaces = false;  ///< so many points fit that it is no accident
  bool surfaces_see_all_axes = false;
  bool picture_holds = false;  ///< enough pixels, and a cost that an alignment may have
  int pixels = 0;              ///< of the picture that were compared
  double cost = 0;             ///< of one of them, in the mean
};

/// When a camera is lost, and when it is found: a machine of three states that knows no images.
///
/// A frame that is followed is doubted where its picture has stopped fitting as pictures lately
/// did. Surfaces that see all axes and explain the frame are not doubted for a picture that is
/// merely worse (exposure, blur, a person walking by), only for one that shows something else.
/// While in doubt nothing is built upon a pose; its picture alone may confirm it, or features find
/// the camera elsewhere; else it is lost. A lost camera is rather held to be lost than put in a
/// wrong place: surfaces are believed against the picture only after a while
/// (docs/decisions/0044-who-is-believed.md).
class LossPolicy {
 public:
  enum class State { kTracking, kDoubting, kLost };

  /// Its numbers; costs are in units of what noise makes usual.
  struct Limits {
    int min_pixels = 40;          ///< fewer are no picture
    int search_interval = 5;      ///< frames between two looks for the camera
    double deceived = 2.5;        ///< times the usual cost: a picture that has stopped fitting
    double strange = 1.8;         ///< times the usual cost: the camera may have been carried off
    double elsewhere = 5;         ///< times the usual cost: a picture of something else
    double explained_cost = 1;    ///< a cost that noise explains is never too high
    double not_strange_cost = 2;  ///< beside surfaces and features: a picture that may be the place
    double clearly_better = 0.5;  ///< of a cost: that of a place which is believed instead
    double enough_pixels = 0.2;   ///< of the usual ones: fewer fit anywhere
    int doubt_frames = 30;        ///< that a picture is held against a pose that is followed
    int patience_frames = 60;     ///< that it is held against the surfaces of a lost camera
    double forget = 0.1;          ///< a frame's share in what is usual
  };

  explicit LossPolicy(const Limits& limits) : limits_(limits) {}

  State state() const { return state_; }
  bool in_doubt() const { return state_ == State::kDoubting; }

  /// What becomes of a frame that is followed: kTracking, it is accepted; kDoubting, that depends
  /// on accepts_doubted(), on searches() and, where neither helped, on loses().
  State follow(const Evidence& e);
  /// Whether a frame would be doubted: its picture does not fit as pictures lately did, so that
  /// surfaces may deceive.
  bool is_doubtful(const Evidence& e) const;
  /// Whether a frame that is accepted is so strange that the camera is looked for elsewhere, now
  /// and then while that lasts: one that was carried off may find surfaces that fit by accident.
  bool wonders(const Evidence& e) const;
  /// Whether a place that features have found is believed instead of the one that is followed.
  bool is_better(const Evidence& found, const Evidence& followed) const;
  /// Whether the picture is worth asking alone: it may confirm the pose.
  bool can_be_confirmed(const Evidence& e) const { return e.trusted && sees_enough(e); }
  /// Whether the camera is looked for among the keyframes.
  bool searches(const Evidence& e) const;
  /// Whether a doubted frame that nothing has confirmed is lost; else surfaces are followed.
  bool loses(const Evidence& e) const;

  /// What becomes of a frame of a lost camera, aligned where it was probably carried on to.
  enum class Finding {
    kAccept,      ///< the camera is there
    kAskPicture,  ///< where the picture alone fits near by
    kLost,
  };
  Finding find(const Evidence& e);
  /// Whether the camera, lost for so many frames, is looked for among the keyframes.
  bool searches_lost(int frames_held) const { return frames_held % limits_.search_interval == 0; }

  /// The picture says on its own that the camera is there.
  bool is_confirmed(const Evidence& e) const;
  /// Whether a place that features have found is right.
  bool is_found(const Evidence& e) const;
  /// The camera was found: nothing is held against it.
  void found();
  /// A frame without a pose.
  void lost() { state_ = State::kLost; }
  /// Learns what is usual from the picture of an accepted frame, and that there is no doubt.
  void learn(const Evidence& e);
  /// Of the last frames; 0: no picture did fit so far.
  double usual_cost() const { return usual_cost_; }

 private:
  bool fits(const Evidence& e, double times_usual) const;
  bool is_strange(const Evidence& e) const;
  bool sees_enough(const Evidence& e) const;

  Limits limits_;
  State state_ = State::kTracking;
  double usual_cost_ = 0, usual_pixels_ = 0;
  int doubted_frames_ = 0;       // in a row, while followed
  int strange_frames_ = 0;       // in a row, while followed
  int contradicted_frames_ = 0;  // in a row, while lost
};

}  // namespace sgs::tracker

// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/history/revision.h"
#include "sgs/tracker/track_result.h"

namespace sgs::slam {

/// Looks at tracked frames one after the other and finds out now and then that the past was
/// different. A pure function of what it is given, in order. What it has found changes the path
/// that it was given last; until a revision made of it comes, it finds nothing else.
class BackEnd {
 public:
  virtual ~BackEnd() = default;
  /// Takes in the next frame, the last one in the path of `revision`; empty where nothing was
  /// found.
  virtual std::optional<history::Update> add(const std::shared_ptr<const RgbdFrame>& frame,
                                             const tracker::TrackResult& result,
                                             const history::Revision& revision) = 0;
  /// No more frames come; empty where nothing more is found.
  virtual std::optional<history::Update> finish(const history::Revision& /*revision*/) {
    return std::nullopt;
  }
  /// What has been found so far, as a number for the records.
  virtual int found() const = 0;
};

}  // namespace sgs::slam

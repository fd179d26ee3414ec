// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "sgs/bag/bag.h"
#include "sgs/core/error.h"
#include "sgs/dataset/bags/bag_order.h"

namespace sgs::dataset {

/// Colour and depth messages of a bag that belong together, in order of time (bag_order.h). Where
/// the clock of the recording was set back, time goes on all the same: the new stretch is moved to
/// follow the old one.
class BagPairs {
 public:
  BagPairs(const bag::Bag& bag, std::size_t color, std::size_t depth, BagClock clock,
           double max_difference_s);

  /// Ends the pairs when this many images in a row have no partner; for looking, not for reading.
  void give_up_after(std::size_t images) { patience_ = images; }

  struct Event {
    enum class Kind {
      kPair,
      kBad,   ///< a damaged stretch, or a colour image whose time runs backwards; `error` says it
      kBack,  ///< the clock was set back; `error` says by how much
      kEnd,
    } kind = Kind::kEnd;
    std::int64_t time_ns = 0;         ///< of colour
    std::int64_t stamp_ns = 0;        ///< the same on the recording's clock, as it stood then
    bool moved = false;               ///< the clock was set back before: both differ
    std::int64_t depth_delay_ns = 0;  ///< by how much later depth was stamped; 0 where none was
    bag::Message color, depth;
    Error error;
  };
  Event next();

  std::size_t color_without_depth() const { return color_unpaired_; }
  std::size_t depth_without_color() const { return depth_unpaired_; }
  std::size_t depth_running_backwards() const { return depth_.out_of_order(); }
  /// Smallest distance in time of colour and depth images that were seen together; empty before.
  std::optional<std::int64_t> nearest_ns() const { return nearest_ns_; }

 private:
  std::optional<Event> problem_before(int stretch, std::int64_t time_ns);
  std::optional<Event> begin_stretch();
  void drop_color(std::size_t count);
  void drop_depth(std::size_t count);
  void drop_earlier_stretch();
  void note_distance();

  MessageOrder color_, depth_;
  BagClock clock_;
  double max_difference_s_;
  std::size_t patience_ = std::numeric_limits<std::size_t>::max();
  std::optional<std::int64_t> nearest_ns_;
  std::size_t color_unpaired_ = 0, depth_unpaired_ = 0;
  int stretch_ = 0;                      ///< of colour, that the events are in
  std::int64_t moved_ns_ = 0;            ///< what is added to the stamps of this stretch
  std::optional<std::int64_t> last_ns_;  ///< of the last colour image, moved
  std::int64_t step_ns_ = 33'333'333;    ///< from image to image
};

}  // namespace sgs::dataset

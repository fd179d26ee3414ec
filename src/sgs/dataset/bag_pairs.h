// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <optional>

#include "sgs/bag/bag.h"
#include "sgs/core/error.h"

namespace sgs::dataset {

/// Whose clock orders the images of a bag.
enum class BagClock {
  kStamp,   ///< header.stamp: when the camera saw it
  kRecord,  ///< when it was recorded; for recordings whose stamps are all zero
};

/// Colour and depth messages of a bag that belong together, in order of time. Both topics are read
/// with cursors of their own, a few messages ahead, so that the order in the file hardly matters
/// and memory stays small.
class BagPairs {
 public:
  BagPairs(const bag::Bag& bag, std::size_t color, std::size_t depth, BagClock clock,
           double max_difference_s);

  /// Ends the pairs when this many images in a row have no partner; for looking, not for reading.
  void give_up_after(std::size_t images) { patience_ = images; }

  struct Event {
    enum class Kind {
      kPair,
      kBad,  ///< a damaged stretch, or a colour image whose time runs backwards; `error` says it
      kEnd,
    } kind = Kind::kEnd;
    std::int64_t time_ns = 0;         ///< of colour
    std::int64_t depth_delay_ns = 0;  ///< by how much later depth was stamped; 0 where none was
    bag::Message color, depth;
    Error error;
  };
  Event next();

  std::size_t color_without_depth() const { return color_.unpaired; }
  std::size_t depth_without_color() const { return depth_.unpaired; }
  std::size_t depth_running_backwards() const { return depth_.backwards; }
  /// Smallest distance in time of colour and depth images that were seen together; empty before.
  std::optional<std::int64_t> nearest_ns() const { return nearest_ns_; }

 private:
  struct Waiting {
    std::int64_t time_ns = 0;
    bag::Message message;
  };
  struct Stream {
    std::unique_ptr<bag::Cursor> cursor;
    bag::Encoding encoding = bag::Encoding::kOther;
    std::deque<Waiting> waiting;          ///< in order of time
    std::optional<std::int64_t> last_ns;  ///< of what has been taken
    bool ended = false;
    std::size_t unpaired = 0, backwards = 0;
  };
  /// Something wrong with colour, and the time after which it was met.
  struct Problem {
    std::int64_t after_ns = 0;
    Error error;
  };

  void fill(Stream& stream, std::deque<Problem>* problems);
  std::optional<Error> take_in(Stream& stream, bag::Message message);
  bool problem_before(std::int64_t time_ns, Event& event);
  static void drop(Stream& stream, std::size_t count);
  static Waiting take(Stream& stream);
  void note_distance();

  Stream color_, depth_;
  std::deque<Problem> problems_;  ///< not yet told
  BagClock clock_;
  double max_difference_s_;
  std::size_t patience_ = std::numeric_limits<std::size_t>::max();
  std::optional<std::int64_t> nearest_ns_;
};

}  // namespace sgs::dataset

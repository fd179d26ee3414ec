// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "sgs/bag/bag.h"
#include "sgs/core/error.h"

namespace sgs::dataset {

/// Whose clock orders the images of a bag.
enum class BagClock {
  kStamp,   ///< header.stamp: when the camera saw it
  kRecord,  ///< when it was recorded; for recordings whose stamps are of no use
};

/// The time of a message on that clock, nanoseconds.
Result<std::int64_t> time_of(const bag::Message& message, bag::Encoding encoding, BagClock clock);

/// The messages of one topic in order of their times, a few read ahead, so that their order in the
/// file hardly matters and memory stays small. One bad time costs one message: a late one, or one
/// that lies far ahead of its neighbours. Where the clock was set back, by a third of a second or
/// more, a new stretch begins with its own times.
class MessageOrder {
 public:
  /// Messages that wait at most; recorders interleave topics within a fraction of a second.
  static constexpr std::size_t kAhead = 8;

  MessageOrder(const bag::Bag& bag, std::size_t channel, BagClock clock);

  struct Waiting {
    std::int64_t time_ns = 0;
    bag::Message message;
  };
  /// Something wrong, and the time after which it was met, in its stretch.
  struct Problem {
    int stretch = 0;
    std::int64_t after_ns = 0;
    Error error;
  };

  /// Reads on until enough messages wait; all of them are of one stretch.
  void fill();
  /// Those that wait, in order of time.
  const std::deque<Waiting>& waiting() const { return waiting_; }
  /// Takes the first of them.
  Waiting take();
  /// Leaves out the first `count` of them.
  void drop(std::size_t count);

  /// Counts how often the clock was set back. Rises in fill(), once all of a stretch is taken.
  int stretch() const { return stretch_; }
  /// Problems that were met and not yet taken, in order.
  std::deque<Problem>& problems() { return problems_; }
  std::size_t out_of_order() const { return out_of_order_; }  ///< messages left out for their time

 private:
  void read_one();
  void put(Waiting next);
  void put_behind(Waiting next);
  bool last_is_stray(std::int64_t time_ns) const;
  bool follows_behind(std::int64_t time_ns) const;
  void give_up_late();
  void begin_stretch();
  void leave_out(std::size_t place, std::int64_t neighbour_ns);
  /// Images at the beginning or the end whose stamps are of another age.
  void leave_out_strays();
  void note(Error error);

  bag::Encoding encoding_;
  BagClock clock_;
  std::unique_ptr<bag::Cursor> cursor_;
  std::deque<Waiting> waiting_;
  std::vector<Waiting> behind_;          ///< late ones, or the beginning of the next stretch
  std::optional<std::int64_t> last_ns_;  ///< of what was taken of this stretch
  bool next_stretch_ = false;            ///< behind_ is one
  bool begun_ = false, ended_ = false;
  int stretch_ = 0;
  std::deque<Problem> problems_;
  std::size_t out_of_order_ = 0;
};

}  // namespace sgs::dataset

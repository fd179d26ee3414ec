// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sgs/bag/chunked_bag.h"

namespace sgs::bag {
namespace {

/// The files of one recording, one after the other.
class JoinedBag : public Bag {
 public:
  JoinedBag(std::vector<std::unique_ptr<Bag>> parts, std::vector<std::string> warnings)
      : parts_(std::move(parts)) {
    format_ = parts_.front()->format();
    warnings_ = std::move(warnings);
    for (const auto& part : parts_) add(*part);
  }
  std::unique_ptr<Cursor> read(const std::vector<std::size_t>& channels) const override;

 private:
  friend class JoinedCursor;
  void add(const Bag& part) {
    std::vector<std::size_t>& map = channel_of_part_.emplace_back();
    for (const Channel& channel : part.channels()) {
      const std::size_t known = channels_.size();
      const std::size_t index = channel_of(channel.topic, channel.type, channel.encoding);
      map.push_back(index);
      auto& count = channels_[index].messages;
      if (index == known) {
        count = channel.messages;
      } else if (count) {
        count = channel.messages ? std::optional(*count + *channel.messages) : std::nullopt;
      }
    }
    warnings_.insert(warnings_.end(), part.warnings().begin(), part.warnings().end());
    if (const auto first = part.first_time_ns()) {
      first_time_ns_ = std::min(first_time_ns_.value_or(*first), *first);
    }
    if (const auto last = part.last_time_ns()) {
      last_time_ns_ = std::max(last_time_ns_.value_or(*last), *last);
    }
  }

  std::vector<std::unique_ptr<Bag>> parts_;
  std::vector<std::vector<std::size_t>> channel_of_part_;  ///< [part][its channel] = ours
};

class JoinedCursor : public Cursor {
 public:
  JoinedCursor(const JoinedBag& bag, std::vector<std::size_t> channels)
      : bag_(bag), channels_(std::move(channels)) {}

  Result<std::optional<Message>> next() override {
    while (part_ < bag_.parts_.size()) {
      const auto& map = bag_.channel_of_part_[part_];
      if (!cursor_) cursor_ = bag_.parts_[part_]->read(wanted(map));
      auto message = cursor_->next();
      if (!message) return message;
      if (*message) {
        (*message)->channel = map[(*message)->channel];
        return message;
      }
      cursor_.reset();
      ++part_;
    }
    return std::nullopt;
  }

 private:
  std::vector<std::size_t> wanted(const std::vector<std::size_t>& map) const {
    std::vector<std::size_t> result;
    for (std::size_t i = 0; i < map.size(); ++i) {
      if (std::find(channels_.begin(), channels_.end(), map[i]) != channels_.end()) {
        result.push_back(i);
      }
    }
    return result;
  }

  const JoinedBag& bag_;
  std::vector<std::size_t> channels_;
  std::size_t part_ = 0;
  std::unique_ptr<Cursor> cursor_;
};

std::unique_ptr<Cursor> JoinedBag::read(const std::vector<std::size_t>& channels) const {
  return std::make_unique<JoinedCursor>(*this, channels);
}

}  // namespace

std::unique_ptr<Bag> join_bags(std::vector<std::unique_ptr<Bag>> parts,
                               std::vector<std::string> warnings) {
  SGS_CHECK(!parts.empty(), "a recording has files");
  if (parts.size() == 1 && warnings.empty()) return std::move(parts.front());
  return std::make_unique<JoinedBag>(std::move(parts), std::move(warnings));
}

}  // namespace sgs::bag

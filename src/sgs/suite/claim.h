// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "sgs/core/error.h"
#include "sgs/suite/claim_record.h"

namespace sgs::suite {

/// One worker's right to do one piece of work, until finish() or the end of the object. A thread of
/// its own gives signs of life meanwhile. Any thread may call.
class Claim {
 public:
  ~Claim();  ///< gives back what is not finished
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;

  /// How many held this work before: what they left belongs to nobody else.
  int generation() const;
  /// Whether another worker has taken over, because no sign of life of this one reached it.
  bool lost() const;
  /// Ends the claim. The error of a state that could not be written; then the claim grows stale.
  Status finish(ClaimState state);

 private:
  friend class ClaimBoard;
  struct Beating;
  explicit Claim(std::unique_ptr<Beating> beating);
  std::unique_ptr<Beating> beating_;
};

/// What workers that share a folder, on one machine or on many, have claimed of their work.
///
/// A claim is a file NAME.G that its holder created exclusively; of several generations the last
/// one counts. Who takes over creates the next generation, which only one can: a claim is never
/// removed and never changes hands, and its old holder sees that it has lost it. A claim is taken
/// over when it was given back, when its process is known to have ended (same machine), or when its
/// file has not changed for `lease` by the clock of the one who watches: clocks are never compared.
/// It takes of the file system that exclusive creation is atomic and that an opened file shows what
/// was written and closed before within less than a lease; NFS since version 3 does both.
class ClaimBoard {
 public:
  using Duration = std::chrono::steady_clock::duration;

  /// Makes `folder` where it is missing.
  static Result<std::unique_ptr<ClaimBoard>> open(const std::filesystem::path& folder,
                                                  Duration lease);

  enum class Answer {
    kTaken,   ///< `claim` is there
    kHeld,    ///< another worker has it; worth asking again
    kFailed,  ///< a worker failed at it since this board was opened
  };
  struct Reply {
    Answer answer = Answer::kHeld;
    std::unique_ptr<Claim> claim;
    std::string holder;  ///< who has it, for people
  };
  /// Tries to claim the work of that name. An error where nothing can be written: a claim of which
  /// only the name found room on the disk is withdrawn.
  Result<Reply> take(const std::string& name);

 private:
  struct Seen {
    std::string text;
    std::chrono::steady_clock::time_point since;
  };
  ClaimBoard(std::filesystem::path folder, Duration lease);
  std::filesystem::path file(const std::string& name, int generation) const;
  bool is_stale(const std::filesystem::path& claim, const std::string& text);

  std::filesystem::path folder_;
  Duration lease_;
  std::set<std::string> failed_before_;  ///< files
  std::mutex mutex_;
  std::map<std::string, Seen> seen_;  ///< by file
};

}  // namespace sgs::suite

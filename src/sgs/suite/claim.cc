// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/suite/claim.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <thread>
#include <utility>

#include "sgs/core/log.h"
#include "sgs/io/atomic_file.h"
#include "sgs/run/machine.h"

namespace sgs::suite {
namespace fs = std::filesystem;
namespace {

using SteadyClock = std::chrono::steady_clock;

/// Signs of life during a lease: some may be late.
constexpr int kBeatsPerLease = 6;

tl::unexpected<Error> cannot_write(const fs::path& file, int reason) {
  return fail(ErrorCode::kIo,
              fmt::format("cannot write {}: {}", file.string(), std::strerror(reason)),
              reason == ENOSPC || reason == EDQUOT ? "free some space and start again"
                                                   : "all workers must be able to write there");
}

bool write_all(int fd, std::string_view bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const auto written =
        ::pwrite(fd, bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    done += static_cast<std::size_t>(written);
  }
  return true;
}

/// Writes a whole record in place; closed, so that other machines see it. Returns 0 or errno.
int write_record(const fs::path& file, int flags, const ClaimRecord& record) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CLOEXEC | flags, 0666);
  if (fd < 0) return errno;
  // On the disk at once: a full one must say so here, not to nobody later.
  int failed = write_all(fd, claim_text(record)) && ::fsync(fd) == 0 ? 0 : errno;
  if (::close(fd) != 0 && failed == 0) failed = errno;
  return failed;
}

bool claim_is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

}  // namespace

struct Claim::Beating {
  Beating(fs::path of, fs::path next_one, int number, ClaimRecord first,
          SteadyClock::duration every)
      : file(std::move(of)),
        next(std::move(next_one)),
        generation(number),
        record(std::move(first)),
        thread([this, every](const std::stop_token& stop) { beat(stop, every); }) {}

  void beat(const std::stop_token& stop, SteadyClock::duration every) {
    std::unique_lock lock(mutex);
    while (!wake.wait_for(lock, stop, every, [] { return false; }) && !stop.stop_requested()) {
      if (claim_is_there(next)) {
        lost = true;
        return;
      }
      ++record.beat;
      // One that cannot be written is a beat that is missing; whether others waited is seen above.
      if (const int failed = write_record(file, 0, record); failed != 0) {
        log().warn("{}: no sign of life could be written: {}", file.string(),
                   std::strerror(failed));
      }
    }
  }

  fs::path file, next;
  int generation;
  ClaimRecord record;
  std::atomic<bool> lost{false};
  bool finished = false;
  std::mutex mutex;
  std::condition_variable_any wake;
  std::jthread thread;  // last: uses the others
};

Claim::Claim(std::unique_ptr<Beating> beating) : beating_(std::move(beating)) {}

Claim::~Claim() {
  if (beating_->finished) return;
  try {
    static_cast<void>(finish(ClaimState::kReleased));
  } catch (...) {  // no memory for the message: the claim runs out by itself
    beating_->thread = {};
  }
}

int Claim::generation() const { return beating_->generation; }

bool Claim::lost() const {
  if (!beating_->lost && claim_is_there(beating_->next)) beating_->lost = true;
  return beating_->lost;
}

Status Claim::finish(ClaimState state) {
  beating_->thread = {};  // stops and joins
  beating_->finished = true;
  beating_->record.state = state;
  const int failed = write_record(beating_->file, 0, beating_->record);
  if (failed != 0) return cannot_write(beating_->file, failed);
  return {};
}

ClaimBoard::ClaimBoard(fs::path folder, Duration lease)
    : folder_(std::move(folder)), lease_(lease) {}

Result<std::unique_ptr<ClaimBoard>> ClaimBoard::open(const fs::path& folder, Duration lease) {
  SGS_RETURN_IF_ERROR(io::make_folder(folder));
  std::unique_ptr<ClaimBoard> board(new ClaimBoard(folder, lease));
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const auto text = io::read_file(it->path(), kClaimRecordBytes);
    if (text && parse_claim(*text).state == ClaimState::kFailed) {
      board->failed_before_.insert(it->path().filename().string());
    }
  }
  if (error) {
    return fail(ErrorCode::kIo, fmt::format("{}: {}", folder.string(), error.message()));
  }
  return board;
}

fs::path ClaimBoard::file(const std::string& name, int generation) const {
  return folder_ / fmt::format("{}.{}", name, generation);
}

bool ClaimBoard::is_stale(const fs::path& claim, const std::string& text) {
  if (has_ended(parse_claim(text).identity)) return true;
  const auto now = SteadyClock::now();
  const std::scoped_lock lock(mutex_);
  Seen& seen = seen_.try_emplace(claim.filename().string(), Seen{text, now}).first->second;
  if (seen.text != text) seen = {text, now};
  return now - seen.since >= lease_;
}

Result<ClaimBoard::Reply> ClaimBoard::take(const std::string& name) {
  int generation = 0;
  while (claim_is_there(file(name, generation))) ++generation;
  if (generation > 0) {
    const fs::path last = file(name, generation - 1);
    SGS_ASSIGN_OR_RETURN(const std::string text, io::read_file(last, kClaimRecordBytes));
    const ClaimRecord record = parse_claim(text);
    const bool old_failure = failed_before_.contains(last.filename().string());
    if (record.state == ClaimState::kFailed && !old_failure) {
      return Reply{Answer::kFailed, nullptr, record.worker};
    }
    if (record.state == ClaimState::kWorking && !is_stale(last, text)) {
      return Reply{Answer::kHeld, nullptr, record.worker};
    }
  }
  ClaimRecord record;
  record.worker = fmt::format("process {} on {}", ::getpid(), run::host_name());
  record.identity = process_identity(::getpid());
  const fs::path mine = file(name, generation);
  const int failed = write_record(mine, O_CREAT | O_EXCL, record);
  if (failed == EEXIST) return Reply{Answer::kHeld, nullptr, "another worker"};
  if (failed != 0) {
    ::unlink(mine.c_str());
    return cannot_write(mine, failed);
  }
  auto beating = std::make_unique<Claim::Beating>(mine, file(name, generation + 1), generation,
                                                  record, lease_ / kBeatsPerLease);
  return Reply{Answer::kTaken, std::unique_ptr<Claim>(new Claim(std::move(beating))), ""};
}

}  // namespace sgs::suite

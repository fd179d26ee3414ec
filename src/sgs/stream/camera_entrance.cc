// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <string_view>

#include "sgs/stream/asio_entrance.h"
#include "sgs/stream/camera_program.h"
#include "sgs/stream/child_process.h"

namespace sgs::stream {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

/// What a program says on its standard error: lines for people ("note: ..."), and why it ended
/// ("error: ...", "remedy: ..."). Other lines are its SDK's.
class SpokenLines {
 public:
  explicit SpokenLines(std::vector<std::string>& notes) : notes_(notes) {}

  void add(std::string_view text) {
    for (const char c : text) {
      if (c == '\n') {
        take(line_);
        line_.clear();
      } else if (line_.size() < kLongestLine) {
        line_ += c;
      }
    }
  }
  const std::string& error() const { return error_; }
  const std::string& remedy() const { return remedy_; }

 private:
  static constexpr std::size_t kLongestLine = 500;

  void take(std::string_view line) {
    constexpr std::string_view kNote = "note: ", kError = "error: ", kRemedy = "remedy: ";
    constexpr int kMostNotes = 50;  // of a program that does not stop talking
    if (line.starts_with(kError)) error_ = line.substr(kError.size());
    if (line.starts_with(kRemedy)) remedy_ = line.substr(kRemedy.size());
    if (!line.starts_with(kNote) || said_++ >= kMostNotes) return;
    notes_.emplace_back(said_ == kMostNotes ? "the camera's program says more; it is left out"
                                            : line.substr(kNote.size()));
  }

  std::vector<std::string>& notes_;
  std::string line_, error_, remedy_;
  int said_ = 0;
};

/// A program that was started for a camera. `notes` lives longer.
class CameraLink final : public PipeLink {
 public:
  CameraLink(asio::io_context& context, ChildProcess child, std::string who,
             std::vector<std::string>& notes)
      : PipeLink(context, child.output.release(), std::move(who)),
        errors_(context, child.errors.release()),
        child_(std::move(child)),
        lines_(notes) {}

  void listen() {
    errors_.async_wait(asio::posix::stream_descriptor::wait_read,
                       [this, self = shared_from_this()](const error_code& error) {
                         if (!error && read_lines()) listen();
                       });
  }
  void answer(const std::string& line) override { child_.tell(line); }
  void close() override {
    PipeLink::close();
    error_code ignored;
    errors_.close(ignored);
  }
  std::optional<Error> failure() override {
    constexpr std::chrono::milliseconds kPatience(2000);
    constexpr int kUsage = 2;
    const auto status = child_.wait_for(kPatience);
    read_lines();
    if (!status) return std::nullopt;
    if (WIFSIGNALED(*status)) {
      return Error{ErrorCode::kIo,
                   fmt::format("the camera's program was ended by signal {}", WTERMSIG(*status)),
                   "its SDK may have crashed: unplug the camera and plug it in again"};
    }
    if (lines_.error().empty()) {
      return Error{ErrorCode::kIo, "the camera's program ended without a word",
                   "start it by itself to see why"};
    }
    return Error{WEXITSTATUS(*status) == kUsage ? ErrorCode::kInvalidArgument : ErrorCode::kIo,
                 lines_.error(), lines_.remedy()};
  }

 private:
  /// Whether more may come.
  bool read_lines() {
    std::array<char, 4096> part{};
    while (errors_.is_open()) {
      const ssize_t bytes = ::read(errors_.native_handle(), part.data(), part.size());
      if (bytes <= 0) return bytes < 0 && (errno == EAGAIN || errno == EINTR);
      lines_.add({part.data(), static_cast<std::size_t>(bytes)});
      if (static_cast<std::size_t>(bytes) < part.size()) return true;
    }
    return false;
  }

  asio::posix::stream_descriptor errors_;
  ChildProcess child_;
  SpokenLines lines_;
};

class CameraEntrance final : public AsioEntrance {
 public:
  CameraEntrance(CameraProgram program, std::vector<std::string> arguments)
      : program_(std::move(program)), arguments_(std::move(arguments)) {}
  ~CameraEntrance() override { guests_.clear(); }

  Status start() {
    SGS_ASSIGN_OR_RETURN(auto child, ChildProcess::start(program_.path, arguments_));
    auto link = std::make_shared<CameraLink>(context_, std::move(child), name(), notes_);
    link->listen();
    link->read_on();
    guests_.push_back(std::move(link));
    return {};
  }

  std::string name() const override { return "camera:" + program_.family; }
  bool ends_with_link() const override { return false; }
  void open_again() override {
    constexpr auto kPeriod = std::chrono::seconds(1);
    again_.expires_after(kPeriod);
    again_.async_wait([this](const error_code& error) {
      if (error) return;
      if (const Status started = start(); !started) {
        notes_.push_back(started.error().text());
        open_again();
      }
    });
  }

 private:
  CameraProgram program_;
  std::vector<std::string> arguments_;
  asio::steady_timer again_{context_};
};

}  // namespace

Result<std::unique_ptr<Entrance>> open_camera(const Address::Camera& camera) {
  SGS_ASSIGN_OR_RETURN(auto chosen, choose_camera(camera));
  std::vector<std::string> arguments = {"--listen"};
  if (!chosen.serial.empty()) arguments.push_back("--serial=" + chosen.serial);
  arguments.insert(arguments.end(), camera.options.begin(), camera.options.end());
  auto entrance = std::make_unique<CameraEntrance>(std::move(chosen.program), std::move(arguments));
  SGS_RETURN_IF_ERROR(entrance->start());
  return entrance;
}

}  // namespace sgs::stream

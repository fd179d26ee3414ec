// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// sgs-video: what `sgs render --video` feeds with pictures. A program of its own, because OpenCV's
// videos bring over a hundred libraries that each start of `sgs` would have to load. What went
// wrong goes to standard output, message and remedy on a line each; `sgs` says it.
#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <string>

#include "sgs/core/print.h"
#include "sgs/run/exit_code.h"
#include "sgs/video/video_file.h"

namespace {

using namespace sgs;

/// Pictures from standard input, RGB, 8 bits, row after row, without anything between them.
struct VideoCommand {
  std::string output;
  int width = 0, height = 0;
  double fps = 30;
  std::int64_t pictures = 0;  ///< as many must come, or there is no video
};

Status make_video(const VideoCommand& command) {
  SGS_ASSIGN_OR_RETURN(auto video, video::VideoFile::create(command.output, command.width,
                                                            command.height, command.fps));
  ColorImage picture(command.width, command.height);
  for (std::int64_t i = 0; i < command.pictures; ++i) {
    if (std::fread(picture.data(), sizeof(*picture.data()), picture.size(), stdin) !=
        picture.size()) {
      return fail(ErrorCode::kInterrupted, "the pictures ended early");
    }
    video.add(picture);
  }
  return video.finish();
}

int tell(const Error& error) {
  print("{}\n{}\n", error.message, error.remedy);
  std::fflush(stdout);
  return error.code == ErrorCode::kInvalidArgument ? run::kExitUsage : run::kExitFailed;
}

}  // namespace

int main(int argc, char** argv) try {
  // Ctrl-C reaches both programs. The one that sends pictures stops; this one then tidies up.
  std::signal(SIGINT, SIG_IGN);
  CLI::App app{"Makes the video of `sgs render --video`"};
  VideoCommand command;
  app.add_option("OUT", command.output)->required();
  app.add_option("WIDTH", command.width)->required()->check(CLI::Range(1, 65535));
  app.add_option("HEIGHT", command.height)->required()->check(CLI::Range(1, 65535));
  app.add_option("FPS", command.fps)->required();
  app.add_option("PICTURES", command.pictures)->required();
  CLI11_PARSE(app, argc, argv);
  const Status status = make_video(command);
  return status ? run::kExitDone : tell(status.error());
} catch (...) {
  return tell(current_error());
}

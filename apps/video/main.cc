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

#include "helper_end.h"
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

}  // namespace

int main(int argc, char** argv) try {
  // Ctrl-C reaches both programs. The one that sends pictures stops; this one then tidies up.
  std::signal(SIGINT, SIG_IGN);
  CLI::App options{"Makes the video of `sgs render --video`"};
  VideoCommand command;
  options.add_option("OUT", command.output)->required();
  options.add_option("WIDTH", command.width)->required()->check(CLI::Range(1, 65535));
  options.add_option("HEIGHT", command.height)->required()->check(CLI::Range(1, 65535));
  options.add_option("FPS", command.fps)->required();
  options.add_option("PICTURES", command.pictures)->required();
  CLI11_PARSE(options, argc, argv);
  return app::end_helper(make_video(command));
} catch (...) {
  return app::end_helper(tl::unexpected(current_error()));
}

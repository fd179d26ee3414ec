// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// feed_frames SEQUENCE OUTPUT: SLAM on a recorded folder; prints the poses, saves trajectory and
// map.
#include <fmt/format.h>
#include <sgs/dataset/open.h>
#include <sgs/io/trajectory_io.h>
#include <sgs/slam/session.h>

sgs::Status run(const char* sequence, const char* output) {
  SGS_ASSIGN_OR_RETURN(const auto input, sgs::dataset::open_sequence(sequence));
  SGS_ASSIGN_OR_RETURN(const auto config, sgs::slam::make_session_config("default"));
  SGS_ASSIGN_OR_RETURN(const auto slam,
                       sgs::slam::Session::create(config, input.frames->camera(), {}));
  sgs::Error error;
  for (;;) {
    const auto frame = std::make_shared<sgs::RgbdFrame>();
    const auto read = input.frames->next(*frame, error);
    if (read == sgs::dataset::FrameRead::kEnd) break;
    if (read == sgs::dataset::FrameRead::kOk) slam->feed(frame);
  }
  slam->finish();
  fmt::print("{}", sgs::io::trajectory_text(slam->trajectory()));
  return slam->save(output);
}

int main(int argc, char** argv) {
  const sgs::Status status =
      argc == 3 ? run(argv[1], argv[2])
                : sgs::fail(sgs::ErrorCode::kInvalidArgument, "feed_frames SEQUENCE OUTPUT");
  if (!status) fmt::print(stderr, "{}\n", status.error().text());
  return status ? 0 : 1;
}

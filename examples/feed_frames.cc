// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// feed_frames INPUT OUTPUT: SLAM on a recorded folder (or synth:room_desk); prints and saves poses.
#include <fmt/format.h>
#include <sgs/input/input.h>
#include <sgs/io/trajectory_io.h>
#include <sgs/run/play.h>
#include <sgs/runfolder/run.h>

sgs::Status run(const char* name, const char* output) {
  const sgs::run::InputSpec spec{.input = name};
  SGS_ASSIGN_OR_RETURN(const auto input, sgs::run::open_input(spec, 2));
  SGS_ASSIGN_OR_RETURN(const auto config, sgs::slam::make_session_config("default"));
  SGS_ASSIGN_OR_RETURN(const auto slam,
                       sgs::slam::Session::create(config, input.source->camera(), {}));
  SGS_RETURN_IF_ERROR(sgs::run::play(*input.source, *slam, {}));
  fmt::print("{}", sgs::io::trajectory_text(slam->trajectory()));
  return sgs::run::save_run(sgs::run::run_of(*slam, input, spec), output);
}

int main(int argc, char** argv) {
  const sgs::Status status =
      argc == 3 ? run(argv[1], argv[2])
                : sgs::fail(sgs::ErrorCode::kInvalidArgument, "feed_frames INPUT OUTPUT");
  if (!status) fmt::print(stderr, "{}\n", status.error().text());
  return status ? 0 : 1;
}

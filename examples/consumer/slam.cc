// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// slam INPUT OUTPUT: SLAM on a recording with libsgs.
#include <sgs/api/sgs.h>

#include <cstdio>

int main(int argc, char** argv) try {
  if (argc != 3) throw sgs::api::Error(sgs::api::ErrorCode::kInvalidArgument, "slam INPUT OUTPUT");
  auto recording = sgs::api::Recording::open(argv[1]);
  sgs::api::Session session(recording.camera());
  while (const auto frame = recording.next()) {
    const auto result = session.feed(*frame);
    std::printf("%.6f %zu weak\n", result.timestamp_s, result.weak_directions().size());
  }
  session.finish();
  session.save(argv[2], &recording);
} catch (const sgs::api::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}

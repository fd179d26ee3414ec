// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// States of runs. The first byte chooses: a whole file as it is, or changes to a state that a
// mapper has written, five bytes each (where, what), as a file with a right checksum could have
// them. What is taken can be gone on with.
#include <cstring>

#include "harness.h"
#include "sgs/mapper/mapper.h"
#include "sgs/runfolder/resume_file.h"

namespace {

using namespace sgs;

const PinholeCamera kCamera{16, 12, 15, 15, 7.5, 5.5};

RgbdFrame frame(std::int64_t index) {
  RgbdFrame out;
  out.index = index;
  out.camera = kCamera;
  out.color = ColorImage(kCamera.width, kCamera.height);
  for (std::size_t i = 0; i < out.color.size(); ++i) {
    out.color.data()[i] = {static_cast<std::uint8_t>(7 * i), static_cast<std::uint8_t>(i), 90};
  }
  out.depth = DepthImage(kCamera.width, kCamera.height, 1.5f);
  return out;
}

mapper::MapperConfig config() {
  mapper::MapperConfig config;
  config.first_keyframe_iterations = 2;
  return config;
}

std::string written_state() {
  mapper::Mapper mapper(config(), kCamera, 1, nullptr);
  for (int i = 0; i < 3; ++i) {
    mapper.add_keyframe(std::make_shared<RgbdFrame>(frame(i)), SE3{});
    mapper.iterate(3);
  }
  ArchiveWriter archive;
  mapper.save(archive);
  return archive.take();
}

void go_on_from(const std::string& state) {
  mapper::Mapper mapper(config(), kCamera, 1, nullptr);
  ArchiveReader archive(state);
  if (!mapper.restore(archive)) return;
  for (auto awaited = mapper.awaited_frame(); awaited; awaited = mapper.awaited_frame()) {
    mapper.restore_keyframe(frame(*awaited));
  }
  mapper.iterate(1);
  fuzz::require(mapper.snapshot() != nullptr, "a state that was taken has a map");
}

void change_state(std::string_view changes) {
  static const std::string original = written_state();
  std::string state = original;
  constexpr std::size_t kChange = 5;
  for (; changes.size() >= kChange; changes.remove_prefix(kChange)) {
    std::uint32_t where = 0;
    std::memcpy(&where, changes.data(), sizeof where);
    state[where % state.size()] = changes[kChange - 1];
  }
  go_on_from(state);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::Choice choice(data, size);
  if (choice.number % 2 == 0) {
    const fuzz::MemoryFile file(choice.rest);
    (void)run::load_resume_file(file.path());
  } else {
    change_state(choice.rest);
  }
  return 0;
}

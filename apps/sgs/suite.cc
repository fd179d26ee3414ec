// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "suite.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>

#include <cstring>

extern char** environ;

namespace sgs::app {

const std::vector<SuiteSequence>& tum_synth_suite() {
  static const std::vector<SuiteSequence> suite = {
      {"nostruct_near", "nostructure_texture_near",
       "rgbd_dataset_freiburg3_nostructure_texture_near_withloop"},
      {"nostruct_far", "nostructure_texture_far", "rgbd_dataset_freiburg3_nostructure_texture_far"},
      {"notex_near", "structure_notexture_near", "rgbd_dataset_freiburg3_structure_notexture_near"},
      {"notex_far", "structure_notexture_far", "rgbd_dataset_freiburg3_structure_notexture_far"},
      {"struct_tex_near", "structure_texture_near",
       "rgbd_dataset_freiburg3_structure_notexture_near"},
      {"room_desk", "room_desk", "rgbd_dataset_freiburg1_desk"},
      {"office", "office", "rgbd_dataset_freiburg3_long_office_household"},
      {"corridor", "corridor", ""},
      {"fold", "fold", ""},
      {"dual", "dual", ""},
  };
  return suite;
}

const std::vector<PublishedRow>& published_results() {
  static const std::vector<PublishedRow> rows = {
      {"SplaTAM",
       {{"nostruct_near", 4.49},
        {"nostruct_far", 9.49},
        {"notex_near", 2.27},
        {"notex_far", 4.54}}},
      {"MonoGS",
       {{"nostruct_near", 11.86},
        {"nostruct_far", 4.10},
        {"notex_near", 26.91},
        {"notex_far", 10.39}}},
      {"Photo-SLAM",
       {{"nostruct_near", 2.27}, {"nostruct_far", 5.36}, {"notex_near", -1}, {"notex_far", -1}}},
      {"GS-ICP SLAM",
       {{"nostruct_near", 194.93},
        {"nostruct_far", 116.16},
        {"notex_near", 1.55},
        {"notex_far", 6.07}}},
      {"Spectral GS-SLAM (paper)",
       {{"nostruct_near", 7.79},
        {"nostruct_far", 16.85},
        {"notex_near", 1.55},
        {"notex_far", 2.19}}},
  };
  return rows;
}

Result<int> run_program(const std::vector<std::string>& arguments, const std::string& log_file) {
  std::vector<std::string> copies = arguments;
  std::vector<char*> argv;
  for (std::string& argument : copies) argv.push_back(argument.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, log_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0644);
  posix_spawn_file_actions_adddup2(&actions, 1, 2);
  pid_t child = 0;
  const int failed = posix_spawn(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) {
    return fail(ErrorCode::kIo, fmt::format("cannot start {}: {}", arguments[0], strerror(failed)));
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace sgs::app

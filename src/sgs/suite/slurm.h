// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace sgs::suite {

/// A suite as Slurm gets it.
struct SlurmSuite {
  std::vector<std::string> words;  ///< program and arguments, without those that share out the runs
  std::filesystem::path working_folder;
  std::filesystem::path output;  ///< of the suite; what the jobs print goes to slurm/ in it
  std::size_t runs = 1;          ///< at least one
  int cpus_per_task = 2;
};

/// A shell script that submits the runs as a job array, each task a shard, and a job that prints
/// the table when the last one has ended. There are at most as many tasks as Slurm takes by
/// default.
std::string slurm_script(const SlurmSuite& suite);

}  // namespace sgs::suite

// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/suite/slurm.h"

#include <fmt/format.h>

#include <algorithm>

#include "sgs/suite/provenance.h"

namespace sgs::suite {
namespace {

std::string quoted(const std::string& word) { return shell_command(std::vector{word}); }

}  // namespace

std::string slurm_script(const SlurmSuite& suite) {
  constexpr std::size_t kMostTasks = 1000;  // below Slurm's default MaxArraySize
  const std::size_t tasks = std::min(suite.runs, kMostTasks);
  const std::string command = shell_command(suite.words);
  const std::string folder = (suite.output / "slurm").string();
  return fmt::format(
      R"(#!/bin/sh
# {runs} runs as an array of {tasks} tasks, and a job that prints the table when all have ended.
# Start it with sh. Partition, account and time limit are taken from SBATCH_PARTITION,
# SBATCH_ACCOUNT and SBATCH_TIMELIMIT. A task that is requeued goes on where it was.
set -eu
cd {working_folder}
mkdir -p {folder}
array=$(sbatch --parsable --job-name=sgs-runs --array=0-{last} --cpus-per-task={cpus} --requeue \
  --open-mode=append --output={task_log} <<'END'
#!/bin/sh
exec {command} --shard "$SLURM_ARRAY_TASK_ID/{tasks}"
END
)
table=$(sbatch --parsable --job-name=sgs-table --dependency="afterany:${{array%%;*}}" \
  --output={table_log} <<'END'
#!/bin/sh
exec {command} --collect
END
)
echo "runs: job ${{array%%;*}}; table: job ${{table%%;*}}, in "{table_log}
)",
      fmt::arg("runs", suite.runs), fmt::arg("tasks", tasks),
      fmt::arg("working_folder", quoted(suite.working_folder.string())),
      fmt::arg("folder", quoted(folder)), fmt::arg("last", tasks - 1),
      fmt::arg("cpus", suite.cpus_per_task), fmt::arg("task_log", quoted(folder + "/run-%a.txt")),
      fmt::arg("table_log", quoted(folder + "/table.txt")), fmt::arg("command", command));
}

}  // namespace sgs::suite

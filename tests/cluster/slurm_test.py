#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""A suite on a real Slurm of two nodes on this machine, of which one loses a worker half way.

Needs root and the packages slurmctld, slurmd, slurm-client and munge; skipped (exit 77) without.
Usage: slurm_test.py SGS
"""

import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

SUITE = """
[[sequence]]
name = "desk"
scene = "room_desk"
[[sequence]]
name = "fold"
scene = "fold"
"""
RUNS = 4
# Slurm 22.05 asks for a cgroup mount even where it uses none.
CGROUP = "CgroupPlugin=cgroup/v1\nCgroupMountpoint={folder}/cgroup\nCgroupAutomount=no\n"
SLURM = """
ClusterName=sgs
SlurmctldHost=localhost
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
SlurmctldPort={ports[0]}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool.%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
SlurmdParameters=config_overrides
ReturnToService=2
SchedulerParameters=sched_interval=2
NodeName=node1 NodeHostname=localhost NodeAddr=127.0.0.1 Port={ports[1]} CPUs=2 RealMemory=1000
NodeName=node2 NodeHostname=localhost NodeAddr=127.0.0.1 Port={ports[2]} CPUs=2 RealMemory=1000
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
"""


def missing():
    """Why there can be no Slurm here, or None."""
    if os.geteuid() != 0:
        return "it must be root"
    for program in ("slurmctld", "slurmd", "sbatch", "munged"):
        if not shutil.which(program, path=os.environ["PATH"] + ":/usr/sbin"):
            return f"{program} is not installed (slurmctld, slurmd, slurm-client, munge)"
    return None


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for s in sockets:
        s.bind(("127.0.0.1", 0))
    ports = [s.getsockname()[1] for s in sockets]
    for s in sockets:
        s.close()
    return ports


class Slurm:
    """munged, slurmctld and two slurmd in a folder, ended with the object."""

    def __init__(self, folder):
        self.folder = folder
        folder.chmod(0o755)
        for name in ("state", "spool.node1", "spool.node2", "cgroup"):
            (folder / name).mkdir()
        (folder / "slurm.conf").write_text(SLURM.format(folder=folder, ports=free_ports(3)))
        (folder / "cgroup.conf").write_text(CGROUP.format(folder=folder))
        key = folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        self.environment = dict(
            os.environ,
            SLURM_CONF=str(folder / "slurm.conf"),
            PATH=os.environ["PATH"] + ":/usr/sbin",
        )
        self.daemons = [
            self.daemon(
                ["munged", "--foreground", "--force", f"--key-file={key}"]
                + [f"--{name}-file={folder}/munged.{name}" for name in ("pid", "log", "seed")]
                + [f"--socket={folder}/munge.socket"]
            )
        ]
        self.wait_for("munge", lambda: (folder / "munge.socket").exists())
        self.daemons.append(self.daemon(["slurmctld", "-D"]))
        self.daemons += [self.daemon(["slurmd", "-D", "-N", node]) for node in ("node1", "node2")]
        self.wait_for("two idle nodes", lambda: self.said("sinfo", "-h", "-o", "%D %t") == "2 idle")

    def daemon(self, words):
        log = (self.folder / f"{words[0]}{words[-1]}.out".replace("/", "_")).open("w")
        return subprocess.Popen(words, env=self.environment, stdout=log, stderr=log)

    def said(self, *words):
        done = subprocess.run(
            words, env=self.environment, capture_output=True, text=True, timeout=60
        )
        return done.stdout.strip()

    def wait_for(self, what, happened, limit_s=300):
        until = time.monotonic() + limit_s
        while not happened():
            if time.monotonic() > until or any(d.poll() is not None for d in self.daemons[1:]):
                logs = [p.read_text()[-2000:] for p in self.folder.glob("slurm*.log")]
                raise AssertionError(f"no {what}: " + "\n".join([self.said("squeue"), *logs]))
            time.sleep(0.1)

    def end(self):
        self.said("scancel", "--user=root")
        for daemon in reversed(self.daemons):
            daemon.terminate()
        for daemon in self.daemons:
            try:
                daemon.wait(20)
            except subprocess.TimeoutExpired:
                daemon.kill()


def task_at_work(suite):
    """Job and worker's process of a task whose run has begun and has not ended."""
    for log in suite.glob("running/*/log.txt"):
        claim = suite / "claims" / log.parent.name
        try:
            worker = int(re.search(r"worker process (\d+)", claim.read_text())[1])
            environment = pathlib.Path(f"/proc/{worker}/environ").read_bytes().split(b"\0")
        except FileNotFoundError:
            continue
        values = dict(v.split(b"=", 1) for v in environment if b"=" in v)
        job = values[b"SLURM_ARRAY_JOB_ID"] + b"_" + values[b"SLURM_ARRAY_TASK_ID"]
        return job.decode(), worker
    return None


def test(sgs, folder, slurm):
    (folder / "mine.toml").write_text(SUITE)
    bench = [sgs, *"bench mine.toml --variants gicp --levels clean --seeds 1,2 --frames 60".split()]
    alone = subprocess.run(
        [*bench, "-o", "alone"], cwd=folder, check=True, capture_output=True, text=True
    )
    script = subprocess.run(
        [*bench, "-o", "suite", "--sbatch"], cwd=folder, check=True, capture_output=True, text=True
    )
    (folder / "suite.sh").write_text(script.stdout)
    subprocess.run(["sh", "suite.sh"], cwd=folder, check=True, env=slurm.environment)

    task = []

    def begun():
        task[:] = task_at_work(folder / "suite") or []
        return task

    slurm.wait_for("run that has begun", begun)
    job, worker = task
    os.kill(worker, signal.SIGKILL)
    slurm.wait_for(
        "task that failed", lambda: "FAILED" in slurm.said("scontrol", "show", "job", job)
    )
    slurm.said("scontrol", "requeue", job)
    slurm.said("scontrol", "update", f"JobId={job}", "StartTime=now")
    slurm.wait_for("end of all jobs", lambda: slurm.said("squeue", "-h") == "", limit_s=600)

    table = (folder / "suite/slurm/table.txt").read_text()
    runs = list((folder / "suite").glob("*/metrics.json"))
    assert len(runs) == RUNS, runs
    assert list((folder / "suite/running").iterdir()) == []
    assert table == alone.stdout, f"{table}\nis not\n{alone.stdout}"
    generations = [claim.suffix for claim in (folder / "suite/claims").iterdir()]
    assert sorted(generations) == [".0"] * RUNS + [".1"], generations
    print(table + f"task {job} was killed and requeued: the same table, each run once")


def main():
    reason = missing()
    if reason:
        print(f"skipped: no Slurm here: {reason}")
        sys.exit(77)
    sgs = str(pathlib.Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        (folder / "slurm").mkdir()
        slurm = Slurm(folder / "slurm")
        try:
            test(sgs, folder, slurm)
        finally:
            slurm.end()


if __name__ == "__main__":
    main()

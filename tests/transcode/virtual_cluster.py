# SPDX-License-Identifier: LGPL-2.1-or-later
"""A real Slurm on this machine: one controller and virtual nodes, in a folder of its own. Needs slurm-wlm and munge."""
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import time

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "sinfo")
CONFIG = """ClusterName=virtual
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/builtin
SlurmdTimeout={timeout}
KillWait=2
MpiDefault=none
JobRequeue=1
MaxArraySize={array}
NodeName=node[1-{nodes}] NodeHostname={host} NodeAddr=127.0.0.1 Port=[{first}-{last}] CPUs={cpus} State=UNKNOWN
PartitionName=video Nodes=node[1-{nodes}] Default=YES MaxTime=INFINITE State=UP
"""


def missing():
    """What of Slurm is not installed."""
    path = os.environ.get("PATH", "") + ":/usr/sbin:/sbin"
    return [name for name in PROGRAMS if not shutil.which(name, path=path)]


def _ports(count):
    """The first of some ports in a row that are free."""
    for first in range(21000, 60000, 50):
        sockets = []
        try:
            for port in range(first, first + count):
                sockets.append(socket.socket())
                sockets[-1].bind(("", port))
            return first
        except OSError:
            continue
        finally:
            for each in sockets:
                each.close()
    raise RuntimeError("no ports are free")


class VirtualCluster:
    """`env`: with which programs of Slurm find it. `timeout`: seconds until a node that does not answer is down."""

    def __init__(self, folder, nodes=4, cpus=2, timeout=10, array=1001):
        self.folder, self.nodes = pathlib.Path(folder), nodes
        self.folder.mkdir(parents=True)
        (self.folder / "state").mkdir()
        first = _ports(nodes + 1)
        user = subprocess.run(["id", "-un"], capture_output=True, text=True, check=True).stdout.strip()
        config = self.folder / "slurm.conf"
        config.write_text(CONFIG.format(host=socket.gethostname().split(".")[0], folder=self.folder, user=user, port=first, first=first + 1,
                                        last=first + nodes, nodes=nodes, cpus=cpus, timeout=timeout, array=array), encoding="ascii")
        self.env = {**os.environ, "SLURM_CONF": str(config), "PATH": os.environ.get("PATH", "") + ":/usr/sbin:/sbin"}
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o600)
        self._run("munged", "--force", f"--key-file={key}", f"--socket={self.folder}/munge.socket", f"--pid-file={self.folder}/munge.pid",
                  f"--log-file={self.folder}/munged.log", f"--seed-file={self.folder}/munge.seed")
        self._run("slurmctld", "-f", config)
        for node in range(1, nodes + 1):
            self.start_node(node)
        end = time.monotonic() + 60
        while self.states().count("idle") < nodes:
            if time.monotonic() > end:
                raise RuntimeError(f"nodes are {self.states()}; see {self.folder}/*.log")
            time.sleep(0.3)

    def _run(self, *words):
        done = subprocess.run(words, env=self.env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        if done.returncode:
            raise RuntimeError(f"{words[0]}: {done.stdout}")
        return done.stdout

    def start_node(self, node):
        self._run("slurmd", "-f", self.folder / "slurm.conf", "-N", f"node{node}")

    def states(self):
        """Of each node."""
        return self._run("sinfo", "-h", "-N", "-o", "%t").split()

    def jobs(self):
        """Lines of squeue: job, state, node, name."""
        return self._run("squeue", "-h", "-r", "-o", "%i %t %N %j").splitlines()

    def wait(self, seconds):
        """Until no job is left. Jobs of a dead node begin at once, not two minutes later."""
        end = time.monotonic() + seconds
        while self.jobs():
            if time.monotonic() > end:
                raise RuntimeError(f"jobs are left: {self.jobs()}")
            for job in self._run("squeue", "-h", "-r", "-t", "PD", "-o", "%i %r").splitlines():
                if job.endswith("BeginTime"):
                    self._run("scontrol", "update", f"JobId={job.split()[0]}", "StartTime=now")
            time.sleep(0.5)

    def kill_node(self, node):
        """As if its power failed: the daemon and all processes of its jobs end at once. Returns how many ended."""
        name, parents, ours = f"node{node}", {}, []
        for folder in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                process = int(folder.name)
                parents[process] = int((folder / "stat").read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()[1])
                environment = (folder / "environ").read_bytes().split(b"\0")
                words = (folder / "cmdline").read_bytes().split(b"\0")
            except OSError:
                continue
            daemon = words[0].endswith(b"slurmd") and name.encode() in words
            if f"SLURM_CONF={self.folder}/slurm.conf".encode() in environment and (daemon or f"SLURMD_NODENAME={name}".encode() in environment):
                ours.append(process)
        # Those that start jobs are their parents.
        daemons = {parents[process] for process in ours} - {1, *ours} | {process for process in ours if parents[process] == 1}
        others = [process for process in ours if process not in daemons]
        # The daemons first, which would tell the controller how the others ended.
        for number, processes in ((signal.SIGSTOP, daemons), (signal.SIGKILL, [*others, *daemons])):
            for process in processes:
                os.kill(process, number)
        return len(daemons) + len(others)

    def close(self):
        for node in range(1, self.nodes + 1):
            self.kill_node(node)
        for name in ("slurmctld", "munge"):
            try:
                os.kill(int((self.folder / f"{name}.pid").read_text(encoding="ascii")), signal.SIGTERM)
            except (OSError, ValueError):
                pass

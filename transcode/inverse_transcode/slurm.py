# SPDX-License-Identifier: LGPL-2.1-or-later
"""Submits the tasks of a batch to Slurm, as job arrays."""
import os
import re
import shlex
import shutil
import subprocess
import time

from inverse_common import files

from .batch import BatchError

ARRAY_SIZE = 1001  # Slurm's default of MaxArraySize


def _array_size():
    """The most tasks that an array of this cluster has."""
    told = subprocess.run(["scontrol", "show", "config"], capture_output=True, text=True, check=False)
    found = re.search(r"MaxArraySize\s*=\s*(\d+)", told.stdout)
    return max(int(found.group(1)) - 1 if found else ARRAY_SIZE - 1, 1)


def _array(batch, name, numbers, words):
    """Submits tasks, several to an element of the array where they are more than an array takes. Returns the number of the job."""
    each = -(-len(numbers) // _array_size())
    lines = [" ".join(map(str, numbers[k:k + each])) for k in range(0, len(numbers), each)]
    # One for each submission: elements of an earlier one read theirs when they start.
    listed = os.path.join(batch.folder, f"slurm-{name}-{time.strftime('%Y%m%d-%H%M%S')}-{os.getpid()}.txt")
    files.write(listed, "\n".join(lines) + "\n")
    script = f'exec {shlex.quote(os.path.join(batch.folder, "run"))} $(sed -n "${{SLURM_ARRAY_TASK_ID}}p" {shlex.quote(listed)})'
    log = os.path.join(batch.folder, "logs").replace("\\", "\\\\").replace("%", "%%") + "/%A_%a.log"
    told = subprocess.run(["sbatch", "--parsable", "--requeue", "--open-mode=append", f"--job-name=inverse-{name}", f"--output={log}",
                           f"--array=1-{len(lines)}", *words, "--wrap", script], capture_output=True, text=True, check=False)
    if told.returncode:
        raise BatchError("; ".join(told.stderr.split("\n")).strip("; ") or f"sbatch ended with status {told.returncode}")
    return told.stdout.strip().split(";")[0]


def submit(batch, options):
    """Submits what is not done: files and chunks, then what joins these. `options`: of sbatch. Returns the numbers of the jobs.
    Throws BatchError."""
    if not shutil.which("sbatch"):
        raise BatchError(f"there is no sbatch on this host. Without Slurm: make -C {shlex.quote(batch.folder)} -j N")
    work, joins = batch.pending()
    jobs, after = [], []
    if work:
        jobs.append(_array(batch, "work", work, options))
        after = [f"--dependency=afterany:{jobs[0]}"]
    if joins:
        jobs.append(_array(batch, "join", joins, [*after, *options]))
    return jobs

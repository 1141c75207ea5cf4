# SPDX-License-Identifier: LGPL-2.1-or-later
"""A batch: a folder with a manifest of tasks and what became of them, for engines that start tasks by their numbers on one host or many.

    manifest.json    settings and tasks; it is not changed (`digest`)
    run              a shell script that works the tasks whose numbers it gets
    Makefile         starts all tasks that are not done
    done/N, failed/N the result of task N, as in a report
    running/N        its lock; not empty: where it was begun last
    parts/N          the encoded streams of a chunk, until they are joined

No times are compared: the hosts' clocks may differ. All hosts see the folder and the files at the same paths."""
import dataclasses
import fcntl
import hashlib
import json
import os
import re
import shlex
import shutil
import socket
import sys

from inverse_common import files
from inverse_common.probe import ProbeError

from . import chunk, formats
from .pipeline import uri_of
from .plan import Settings, Task, is_pattern, numbered, picture
from .run import Runner

FOLDERS = ("done", "failed", "running", "parts", "logs")
RUN_HEAD = "#!/bin/sh\n# Runs tasks of this batch: run NUMBER...\n"
MAKE_HEAD = "# Runs all tasks that are not done: make -C FOLDER -j N. What is there counts, not how old it is."
SAMPLES, SAMPLE_BYTES = 16, 1 << 16
ENVIRONMENT = ("GST_PLUGIN_PATH", "GST_PLUGIN_SYSTEM_PATH", "GST_PRESET_PATH", "GST_REGISTRY", "INVERSE_MODELS", "LD_LIBRARY_PATH",
               "VK_ICD_FILENAMES", "VK_DRIVER_FILES")


class BatchError(Exception):
    """A batch that cannot be made or worked, and why."""


def identity(path):
    """Size and hash by which a changed or replaced input is found: of a file's bytes at most 16 blocks of 64 KiB, evenly spaced; of
    numbered pictures all sizes, and so much of the first, the middle and the last one."""
    files = [picture(path, n) for n in numbered(path)] if is_pattern(path) else [path]
    sizes, digest = [os.path.getsize(name) for name in files], hashlib.sha256()
    digest.update(json.dumps(sizes).encode())
    for k in sorted({0, len(files) // 2, len(files) - 1}):
        with open(files[k], "rb") as read:
            for sample in range(SAMPLES):
                if sizes[k] > SAMPLES * SAMPLE_BYTES:
                    read.seek(sample * (sizes[k] - SAMPLE_BYTES) // (SAMPLES - 1))
                digest.update(read.read(SAMPLE_BYTES))
    return {"size": sum(sizes), "sample_sha256": digest.hexdigest()}


def _digest(manifest):
    content = {key: value for key, value in manifest.items() if key != "digest"}
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _chunks(task, division, warn):
    """Of a task's file, or None if it is done as a whole."""
    if not division["seconds"]:
        return None
    if is_pattern(task.input) or os.path.splitext(task.input)[1][1:].lower() not in chunk.SEEKABLE:
        warn(f"{task.input}: not divided; files that are end in {', '.join(chunk.SEEKABLE)}")
        return None
    if chunk.is_fragmented(task.input):
        warn(f"{task.input}: not divided, since frames of a fragmented MP4 get other times after a seek; copy it to another form first, as by "
             "ffmpeg -i IN.mp4 -c copy OUT.mkv")
        return None
    chunks = chunk.divide(uri_of(task.input), **division)
    return chunks if len(chunks) > 1 else None


def _check_free(folder):
    """Whether a folder has no files of somebody under the names that a batch takes. What an interrupted `make` left is written anew; records of
    tasks would be taken for those of the new ones. Throws BatchError, OSError."""
    starts = {"run": RUN_HEAD, "Makefile": MAKE_HEAD, "tasks": "", "joins": ""}
    for name in (*starts, *FOLDERS):
        path = os.path.join(folder, name)
        if not os.path.lexists(path):
            continue
        if name in FOLDERS:
            free = os.path.isdir(path) and not os.listdir(path)
        else:
            with open(path, "rb") as file:
                free = os.path.isfile(path) and (file.read(len(starts[name])) == starts[name].encode() if starts[name] else
                                                 re.fullmatch(rb"([0-9]+\n)*", file.read()))
        if not free:
            raise BatchError(f"{path} is in the place of a part of the batch: name a new folder")


def make(folder, settings, tasks, division, warn):
    """Writes a batch of planned tasks. `division`: of files in chunks, as chunk.divide has it; `seconds` 0: not. `warn` gets texts. Returns
    the batch. Throws BatchError, OSError."""
    folder = os.path.abspath(folder)
    path = os.path.join(folder, "manifest.json")
    if os.path.exists(path):
        raise BatchError(f"there is a batch in {folder}: go on with it without inputs, or name a new folder")
    _check_free(folder)
    listed, others = [], []
    for task in tasks:
        task = dataclasses.replace(task, input=os.path.abspath(task.input), output=os.path.abspath(task.output))
        base = {"input": task.input, "output": task.output}
        try:
            chunks = None if task.problem or task.done else _chunks(task, division, warn)
            base.update({} if task.problem or task.done else identity(task.input))
        except ProbeError as error:
            task.problem = str(error)
        except OSError as error:
            task.problem = error.strerror
        if task.problem:
            others.append({**base, "status": "failed", "error": task.problem})
        elif task.done:
            others.append({**base, "status": "present"})
        elif chunks:
            first = len(listed)
            listed += [{**base, "output": os.path.join(folder, "parts", str(first + k)), "chunk": dataclasses.asdict(c)}
                       for k, c in enumerate(chunks)]
            listed.append({**base, "parts": list(range(first, len(listed)))})
        else:
            listed.append(base)
    manifest = {"version": formats.version(), "settings": dataclasses.asdict(settings), "tasks": listed, "others": others}
    manifest["digest"] = _digest(manifest)
    for name in FOLDERS:
        os.makedirs(os.path.join(folder, name), exist_ok=True)
    files.write(os.path.join(folder, "run"), _run_script(folder), 0o777)
    files.write(os.path.join(folder, "Makefile"), _makefile(listed))
    for name, numbers in zip(("tasks", "joins"), _lists(listed)):
        files.write(os.path.join(folder, name), "".join(f"{n}\n" for n in numbers))
    files.write(path, json.dumps(manifest, indent=1), 0o444)
    return Batch(folder)


def _run_script(folder):
    kept = "".join(f"export {name}={shlex.quote(os.environ[name])}\n" for name in ENVIRONMENT if os.environ.get(name))
    launcher = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "inverse-transcode")
    return (f"{RUN_HEAD}{kept}exec {shlex.quote(launcher)} --batch {shlex.quote(folder)} "
            '--task "$@"\n')


def _lists(tasks):
    """The numbers of tasks of files and chunks, and of those that join chunks."""
    numbers = range(len(tasks))
    return [n for n in numbers if not tasks[n].get("parts")], [n for n in numbers if tasks[n].get("parts")]


def _makefile(tasks):
    lines = [f"done/{n}: | " + " ".join(f"done/{part}" for part in task["parts"]) for n, task in enumerate(tasks) if task.get("parts")]
    return "\n".join([
        MAKE_HEAD,
        "MAKEFLAGS += --keep-going",
        "all: " + " ".join(f"done/{n}" for n in range(len(tasks))),
        "done/%:", "\t./run $*", *lines, ""])


class Batch:
    """One that was made. Throws BatchError."""

    def __init__(self, folder):
        self.folder = os.path.abspath(folder)
        path = os.path.join(self.folder, "manifest.json")
        try:
            with open(path, encoding="ascii") as read:
                self.manifest = json.load(read)
            same = self.manifest["digest"] == _digest(self.manifest)
            self.settings, self.tasks = Settings(**self.manifest["settings"]), self.manifest["tasks"]
        except OSError as error:
            raise BatchError(f"there is no batch: {path}: {error.strerror}") from error
        except (ValueError, KeyError, TypeError) as error:
            raise BatchError(f"{path} is damaged ({error}): make the batch anew in another folder") from error
        if not same:
            raise BatchError(f"{path} was edited: undo that, or make a batch of what you want in another folder")

    def _path(self, *names):
        return os.path.join(self.folder, *map(str, names))

    def _result(self, number, kind):
        """None if there is none that can be read: a power failure may leave an empty file."""
        try:
            with open(self._path(kind, number), encoding="ascii") as read:
                result = json.load(read)
            return result if isinstance(result, dict) and isinstance(result.get("status"), str) else None
        except (FileNotFoundError, ValueError):
            return None

    def is_done(self, number):
        """Whether its result is there."""
        task = self.tasks[number]
        return bool(self._result(number, "done")) and ("chunk" in task or os.path.exists(task["output"]))

    def state(self, number):
        """What became of a task, as in a report: of `status` also "running", "ended" (without a result) and "waiting"."""
        base = {"task": number, "input": self.tasks[number]["input"], "output": self.tasks[number]["output"]}
        if self.is_done(number):
            return {**base, **self._result(number, "done"), "task": number}
        try:
            with open(self._path("running", number), encoding="ascii") as lock:
                begun = _begun(lock.read())
                if begun:
                    return {**base, "begun": begun, "status": "ended" if _lock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB) else "running"}
        except FileNotFoundError:
            pass
        failed = self._result(number, "failed")
        return {**base, **failed, "task": number} if failed else {**base, "status": "waiting"}

    def report(self):
        """Of all tasks and of the files that were none."""
        files = [self.state(number) for number in range(len(self.tasks))]
        for result in files:
            if result["status"] == "ended":
                job = f", Slurm job {result['begun']['slurm']}" if result["begun"].get("slurm") else ""
                result["error"] = f"its process on {result['begun']['host']}{job} ended without a result: killed, or out of memory or time"
        return files + self.manifest["others"]

    def pending(self):
        """The numbers of tasks that are not done: those of files and chunks, and those that join chunks."""
        return tuple([n for n in numbers if not self.is_done(n)] for numbers in _lists(self.tasks))

    def work(self, numbers, quiet=False, verbose=False):
        """Runs tasks one after the other; returns the exit status."""
        wrong = [n for n in numbers if not 0 <= n < len(self.tasks)]
        if wrong:
            raise BatchError(f"there is no task {wrong[0]}; the batch has {len(self.tasks)}, from 0")
        failed = False
        for number in numbers:
            with open(self._path("running", number), "a+", encoding="ascii") as lock:
                if not _lock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB):
                    print(f"task {number} is being done by another process: waiting for it", file=sys.stderr)
                    _lock(lock, fcntl.LOCK_EX)
                if self.is_done(number):
                    continue
                _begin(lock)
                runner = Runner(self.settings, 1, quiet, verbose)
                result = self._work(number, runner)
                self._end(number, result, lock)
            failed = failed or result["status"] != "done"
            if runner.stopping:
                return 130
        return 1 if failed else 0

    def _work(self, number, runner):
        task = self.tasks[number]
        base = {"input": task["input"], "output": task["output"], "status": "failed"}
        parts = task.get("parts", [])
        waiting = [n for n in parts if not self._result(n, "done")]
        gone = [n for n in parts if n not in waiting and not os.path.isdir(self._path("parts", n))]
        for part in gone:
            os.unlink(self._path("done", part))
        try:
            error = (f"of its {len(parts)} parts, {len(waiting) + len(gone)} are not done, such as task {(waiting + gone)[0]}" if waiting or gone else
                     "it is not the file that the manifest lists: it was changed or replaced"
                     if identity(task["input"]) != {key: task[key] for key in ("size", "sample_sha256")} else "")
        except OSError as problem:
            error = problem.strerror
        todo = Task(task["input"], task["output"], error, chunk=task.get("chunk"), parts=[self._path("parts", n) for n in parts],
                    keep_stopped=False)
        return {**base, **runner.run([todo])[0]}

    def _end(self, number, result, lock):
        kind, other = ("done", "failed") if result["status"] == "done" else ("failed", "done")
        result = {**result, "host": _host()}
        files.write(self._path(kind, number), json.dumps(result))
        if os.path.exists(self._path(other, number)):
            os.unlink(self._path(other, number))
        lock.truncate(0)
        if kind == "done":
            for part in self.tasks[number].get("parts", []):
                shutil.rmtree(self._path("parts", part), ignore_errors=True)


def _begun(text):
    """What `_begin` noted; None if that is nothing that can be read."""
    try:
        begun = json.loads(text or "null")
    except ValueError:
        return None
    return begun if isinstance(begun, dict) and isinstance(begun.get("host"), str) else None


def _lock(file, kind):
    try:
        fcntl.flock(file, kind)
        return True
    except BlockingIOError:
        return False


def _host():
    return os.environ.get("SLURMD_NODENAME") or socket.gethostname()


def _begin(lock):
    """Notes in a lock which process runs the task."""
    slurm = os.environ.get("SLURM_ARRAY_JOB_ID")
    begun = {"host": _host(), "slurm": f"{slurm}_{os.environ.get('SLURM_ARRAY_TASK_ID')}" if slurm else ""}
    lock.seek(0)
    lock.truncate(0)
    lock.write(json.dumps(begun))
    lock.flush()

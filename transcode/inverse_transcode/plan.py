# SPDX-License-Identifier: LGPL-2.1-or-later
"""From what the user names to a list of tasks, one for each file to write."""
import os
from dataclasses import asdict, dataclass, field

VIDEO_ENDINGS = set("mp4 m4v mov mkv webm avi mpg mpeg ts mts m2ts ogv ogg flv wmv 3gp mxf".split())


class PlanError(Exception):
    """What the user asked for cannot be planned."""


@dataclass
class Settings:
    """How every file is transcoded."""

    chain: str  # elements between the decoder and the encoder, as in gst-launch-1.0
    container: str
    video: str = ""  # codec; "": the container's
    audio: str = "copy"  # or a codec, or none
    hardware: bool = False
    video_options: str = ""
    layers: list = field(default_factory=list)  # of intrinsicsplit; []: what the chain shows


@dataclass
class Task:
    """One file. `problem`: why it cannot be done, or ""."""

    input: str
    output: str
    problem: str = ""
    done: bool = False  # there is a result that is newer than the input

    def as_json(self, settings):
        """What a worker is told."""
        return {"input": self.input, "output": self.output, **asdict(settings)}


def _videos(folder):
    for base, folders, names in os.walk(folder):
        folders.sort()
        for name in sorted(names):
            if name.rpartition(".")[2].lower() in VIDEO_ENDINGS:
                yield os.path.join(base, name)


def _problem(path):
    if not os.path.exists(path):
        return "there is no such file"
    if not os.path.isfile(path):
        return "it is no file"
    if not os.access(path, os.R_OK):
        return "it cannot be read"
    return "it is empty" if os.path.getsize(path) == 0 else ""


def plan(inputs, output, folder, ending, again=False):
    """The tasks for files and folders. `output`: the file to write, for one input; else they go to `folder`, as they lie below the
    folders named. Throws PlanError."""
    pairs = []
    for given in inputs:
        given = given.rstrip("/") or "/"
        if os.path.isdir(given):
            found = list(_videos(given))
            if not found:
                raise PlanError(f"there are no videos in {given}; their names end in {', '.join(sorted(VIDEO_ENDINGS))}")
            base = os.path.basename(os.path.realpath(given))
            pairs += [(path, os.path.join(base, os.path.relpath(path, given))) for path in found]
        else:
            pairs.append((given, os.path.basename(given)))
    if output and len(pairs) != 1:
        raise PlanError(f"one output cannot take {len(pairs)} inputs; name a folder by --out")
    tasks, taken = [], {}
    for path, below in pairs:
        target = output or os.path.join(folder, os.path.splitext(below)[0] + "." + ending)
        task = Task(path, target, _problem(path))
        key = os.path.realpath(target)
        if not task.problem and key in taken:
            task.problem = f"its output would replace that of {taken[key]}: {target}"
        elif not task.problem and key == os.path.realpath(path):
            task.problem = "its output would replace it"
        elif not task.problem and os.path.isdir(target):
            task.problem = f"its output is a folder: {target}"
        taken.setdefault(key, path)
        if not task.problem and not again and os.path.exists(target):
            task.done = os.path.getmtime(target) > os.path.getmtime(path)
        tasks.append(task)
    return tasks

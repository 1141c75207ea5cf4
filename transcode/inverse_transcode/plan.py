# SPDX-License-Identifier: LGPL-2.1-or-later
"""From what the user names to a list of tasks, one for each file to write."""
import os
import re
from dataclasses import asdict, dataclass, field

SEQUENCES = ("png", "jpg")  # written to folders
PICTURES = re.compile(r"%0?\d*d")  # in the name of an input: numbered pictures
VIDEO_ENDINGS = set("mp4 m4v mov mkv webm avi mpg mpeg ts mts m2ts ogv ogg flv wmv 3gp mxf".split())


class PlanError(Exception):
    """What the user asked for cannot be planned."""


@dataclass
class Settings:
    """How every file is transcoded."""

    chain: str  # elements between the decoder and the encoder, as in gst-launch-1.0
    container: str
    rate: str = "25/1"  # of numbered pictures that are read
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


def numbered(pattern):
    """The numbers of the pictures that a pattern such as frames/%04d.png names, in order."""
    folder, name = os.path.split(pattern)
    head, tail = PICTURES.split(name, maxsplit=1)
    names = os.listdir(folder or ".") if os.path.isdir(folder or ".") else []
    numbers = (n[len(head):len(n) - len(tail)] for n in names if n.startswith(head) and n.endswith(tail))
    return sorted({int(n) for n in numbers if n.isdigit() and name % int(n) == head + n + tail})


def _problem(path):
    if PICTURES.search(os.path.basename(path)) and not os.path.exists(path):
        numbers = numbered(path)
        if not numbers:
            return "there are no such pictures"
        missing = numbers[-1] - numbers[0] + 1 - len(numbers)
        return f"{missing} of its pictures are missing" if missing else ""
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
        target = output or os.path.join(folder, PICTURES.sub("", os.path.splitext(below)[0]).rstrip("._-") + ("" if ending in SEQUENCES else "." + ending))
        task = Task(path, target, _problem(path))
        key = os.path.realpath(target)
        if not task.problem and key in taken:
            task.problem = f"its output would replace that of {taken[key]}: {target}"
        elif not task.problem and key == os.path.realpath(path):
            task.problem = "its output would replace it"
        elif not task.problem and os.path.exists(target) and os.path.isdir(target) != (ending in SEQUENCES):
            task.problem = f"there is something else at its output: {target}"
        taken.setdefault(key, path)
        if not task.problem and not again and os.path.exists(target):
            newest = path % numbered(path)[-1] if not os.path.exists(path) else path
            task.done = os.path.getmtime(target) > os.path.getmtime(newest)
        tasks.append(task)
    return tasks

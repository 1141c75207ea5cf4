# SPDX-License-Identifier: LGPL-2.1-or-later
"""From what the user names to a list of tasks, one for each file to write."""
import os
import re
from dataclasses import asdict, dataclass, field

from inverse_common import media

from .formats import SEQUENCES, is_element, is_layer
from .part import is_marked

PICTURES = re.compile(r"%0?\d*d")  # in the name of an input: numbered pictures
RESULT = re.compile(r"[0-9]{6,}\.(" + "|".join(SEQUENCES) + ")")  # of such a folder
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
    bits: int = 0  # of PNG, 8 or 16; 0: as the input's
    exposure: float = 0  # stops that EXR is brightened by when it is read, and darkened by when it is written


@dataclass
class Task:
    """One file, or a part of one. `problem`: why it cannot be done, or ""."""

    input: str
    output: str
    problem: str = ""
    done: bool = False  # there is a result that is newer than the input
    chunk: dict | None = None  # as chunk.Chunk: the output is a folder of its encoded streams
    parts: list = field(default_factory=list)  # folders of chunks that the output is joined of
    keep_stopped: bool = True  # what was done of a file that is stopped

    def as_json(self, settings):
        """What a worker is told."""
        return {"input": self.input, "output": self.output, "chunk": self.chunk, "parts": self.parts, "keep_stopped": self.keep_stopped,
                **asdict(settings)}


def is_pattern(path):
    """Whether it names numbered pictures."""
    return bool(PICTURES.search(os.path.basename(path))) and not os.path.exists(path)


def is_exr(path):
    """Whether it names numbered pictures of OpenEXR."""
    return path.lower().endswith(".exr") and is_pattern(path)


def pattern_parts(pattern):
    """Of the name: what is before the number, how many digits that has at least, and what is after it."""
    name = os.path.basename(pattern)
    place = PICTURES.search(name)
    return name[:place.start()], int(place.group()[1:-1] or 0), name[place.end():]


def picture(pattern, number):
    """The name of a numbered picture."""
    head, digits, tail = pattern_parts(pattern)
    return os.path.join(os.path.dirname(pattern), f"{head}{number:0{digits}}{tail}" if digits else f"{head}{number}{tail}")


def _form(pattern):
    head, digits, tail = pattern_parts(pattern)
    return re.compile(re.escape(head) + f"([0-9]{{{max(digits, 1)},}})" + re.escape(tail))


def is_numbered(pattern, name):
    """Whether a pattern such as frames/%04d.png names a picture of that name in its folder."""
    return bool(_form(pattern).fullmatch(name))


def numbered(pattern):
    """The numbers of the pictures that a pattern names, in order."""
    folder = os.path.dirname(pattern) or "."
    names = os.listdir(folder) if os.path.isdir(folder) else []
    return sorted(int(found.group(1)) for found in map(_form(pattern).fullmatch, names) if found)


def _videos(folder, results):
    """Videos below a folder; not what is hidden, a part of a result, or in the folder of results."""
    for base, folders, names in os.walk(folder):
        folders[:] = sorted(f for f in folders if not f.startswith(".") and os.path.realpath(os.path.join(base, f)) != results)
        for name in sorted(names):
            stem, _, ending = name.rpartition(".")
            if ending.lower() in VIDEO_ENDINGS and not name.startswith(".") and not stem.endswith(".partial"):
                yield os.path.join(base, name)


def _problem(path):
    if is_pattern(path):
        numbers = numbered(path)
        if not numbers:
            return "there are no such pictures"
        missing = sorted(set(range(numbers[0], numbers[-1])) - set(numbers))
        return f"{os.path.basename(picture(path, missing[0]))} is missing ({len(missing)} in all)" if missing else ""
    if path.lower().endswith(".exr"):
        return "EXR pictures are named by a pattern, as in shot/%04d.exr"
    if not os.path.exists(path):
        return "there is no such file" + ("; elements go after --" if "=" in path or is_element(path) else "")
    if not os.path.isfile(path):
        return "it is no file"
    if not os.access(path, os.R_OK):
        return "it cannot be read"
    if os.path.getsize(path) == 0:
        return "it is empty"
    return f"it {media.LIST_ADVICE}" if media.is_list(path) else ""


def is_result_folder(folder):
    """Whether a folder has nothing but what this program writes there."""
    for _, folders, names in os.walk(folder):
        if not all(is_layer(f) for f in folders) or not all(RESULT.fullmatch(name) for name in names):
            return False
    return True


def _with_folders(paths):
    """Files and all folders that they lie in."""
    found = set()
    for path in paths:
        while path not in found:
            found.add(path)
            path = os.path.dirname(path)
    return found


def _in_the_way(target, ending, sources):
    """Why a result cannot take its place, or "". `sources`: the inputs, with their folders."""
    place = os.path.realpath(target)
    if place in sources:
        return f"its output would replace an input: {target}"
    if ending not in SEQUENCES:
        return f"there is something at its output that is no file: {target}" if os.path.exists(place) and not os.path.isfile(place) else ""
    if os.path.exists(place) and not (os.path.isdir(place) and is_result_folder(place)):
        return f"there is something at its output that is no folder of numbered pictures alone: {target}"
    return ""


def _below(path, below, ending):
    """Where a result lies below the folder of results."""
    stem = os.path.splitext(below)[0]
    if is_pattern(path):
        stem = PICTURES.sub("", stem).rstrip("._-") or os.path.basename(os.path.dirname(os.path.abspath(path)))
    return stem if ending in SEQUENCES else f"{stem}.{ending}"


def _is_of_somebody(target, ending):
    """Whether a file at an output is not known to be a result."""
    try:
        return ending not in SEQUENCES and os.path.isfile(target) and not is_marked(target)
    except OSError:
        return True


def plan(inputs, output, folder, ending, again=False, overwrite=False):
    """The tasks for files and folders. `output`: the file to write, for one input; else they go to `folder`, as they lie below the
    folders named. Results are replaced by `again` only, other files by `overwrite`; inputs and folders of other files never. Throws PlanError."""
    pairs, seen = [], set()
    for given in inputs:
        given = given.rstrip("/") or "/"
        if os.path.isdir(given):
            found = list(_videos(given, os.path.realpath(folder)))
            if not found:
                raise PlanError(f"there are no videos in {given}; their names end in {', '.join(sorted(VIDEO_ENDINGS))} (numbered pictures: {given}/%04d.png)")
            base = os.path.basename(os.path.realpath(given))
            found = [(path, os.path.join(base, os.path.relpath(path, given))) for path in found]
        else:
            found = [(given, os.path.basename(given))]
        for path, below in found:
            if os.path.realpath(path) not in seen:
                seen.add(os.path.realpath(path))
                pairs.append((path, below))
    if output and len(pairs) != 1:
        raise PlanError(f"one output cannot take {len(pairs)} inputs; name a folder by --out (elements go after --)")
    tasks, taken = [], {}
    sources = [os.path.realpath(picture(path, n)) for path, _ in pairs if is_pattern(path) for n in numbered(path)[:1]]
    sources = _with_folders(sources + [os.path.realpath(path) for path, _ in pairs])
    for path, below in pairs:
        target = output or os.path.join(folder, _below(path, below, ending))
        task = Task(path, target, _problem(path))
        key = os.path.realpath(target)
        if not task.problem and key in taken:
            task.problem = f"its output would replace that of {taken[key]}: {target}"
        taken.setdefault(key, path)
        task.problem = task.problem or _in_the_way(target, ending, sources)
        if not task.problem and _is_of_somebody(target, ending):
            if not overwrite:
                task.problem = f"what is at its output is not known to be a result of this program: {target}; --overwrite replaces it"
        elif not task.problem and not again and os.path.exists(target) and (os.path.isfile(target) or os.listdir(target)):
            newest = picture(path, numbered(path)[-1]) if is_pattern(path) else path
            task.done = os.path.getmtime(target) > os.path.getmtime(newest)
            if not task.done:
                task.problem = f"what is at its output is older than the input: {target}; --again replaces it"
        tasks.append(task)
    return tasks

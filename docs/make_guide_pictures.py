#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The pictures of docs/guides/gallery.md, made by the launch lines that the page shows.

docs/make_gallery.py [--build BUILD] [NAME …]     (default: build, which ./dev build-only build makes, and all pictures)

A picture has a row per footage: its frame at 2 s, then what each launch line shows of it. Needs python3-pil.
"""
import argparse
import itertools
import os
import pathlib
import re
import shlex
import sys
import time

import gi
gi.require_version("Gst", "1.0")
from gi.repository import Gst  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "guides" / "gallery.md"
PICTURES = ROOT / "docs" / "images" / "gallery"
WIDTH = 1000  # of a picture, pixels
GAP = 4
SECONDS = 2
TIMEOUT = 120  # s, for a line to come to its frame
SHOWN = "autovideosink"  # which a line of the page ends with
TAKEN = ["videoconvert", "!", "video/x-raw,format=RGB", "!", "appsink", "name=taken", "sync=false", "max-buffers=1"]
# A picture of the page, and the block of launch lines below it.
ENTRY = re.compile(r"!\[[^\]]*\]\((\.\./images/gallery/([\w-]+)\.jpg)\)\n+```\n(.*?)```", re.DOTALL)
SOURCE = re.compile(r"^\| `(/[^`]+)` \| `([\w.-]+)` \|", re.MULTILINE)  # a row of the page's table of footage


class LineError(Exception):
    """A launch line that does not work."""


def read_page():
    """Launch lines, as lists of words without the program's name, by picture."""
    entries = {}
    for _, name, block in ENTRY.findall(PAGE.read_text()):
        lines = [shlex.split(line) for line in block.replace("\\\n", " ").splitlines()]
        for line in lines:
            if line[:1] != ["gst-launch-1.0"] or line.count(SHOWN) != 1:
                raise LineError(f"{name}: not a gst-launch-1.0 line with one {SHOWN}: {shlex.join(line)}")
        entries[name] = [line[1:] for line in lines]
    return entries


def read_sources():
    """Package of each file that is not of this repository."""
    return dict(SOURCE.findall(PAGE.read_text()))


def missing_packages(lines):
    """Packages of files that are named by these lines and are not there."""
    files = [word.partition("=")[2] for line in lines for word in line if word.startswith("location=")]
    packages = read_sources()
    return sorted({packages.get(file, f"the package of {file}") for file in files if not (ROOT / file).exists()})


def source(line):
    """The part of a line in front of the decomposer."""
    return list(itertools.takewhile(lambda word: not re.match("(intrinsic|globalintrinsic)", word), line))[:-1]


def take_frame(words, seconds):
    """(width, height, RGB rows of 4-byte alignment) of the first frame at or after that time that the line shows."""
    try:
        pipeline = Gst.parse_launchv(words)
    except gi.repository.GLib.Error as error:
        raise LineError(f"{error.message}: {shlex.join(words)}") from error
    try:
        pipeline.set_state(Gst.State.PLAYING)
        sink, bus = pipeline.get_by_name("taken"), pipeline.get_bus()
        deadline = time.monotonic() + TIMEOUT
        while time.monotonic() < deadline:
            if sample := sink.emit("try-pull-sample", Gst.SECOND // 10):
                if sample.get_segment().to_running_time(Gst.Format.TIME, sample.get_buffer().pts) >= seconds * Gst.SECOND:
                    caps, buffer = sample.get_caps().get_structure(0), sample.get_buffer()
                    return caps.get_value("width"), caps.get_value("height"), buffer.extract_dup(0, buffer.get_size())
            elif error := bus.pop_filtered(Gst.MessageType.ERROR):
                raise LineError(f"{error.parse_error()[0].message}: {shlex.join(words)}")
            elif sink.props.eos:
                break
        raise LineError(f"no frame at {seconds} s: {shlex.join(words)}")
    finally:
        pipeline.set_state(Gst.State.NULL)


def shown(line, seconds=SECONDS):
    """The frame that a line shows."""
    at = line.index(SHOWN)
    return take_frame(line[:at] + TAKEN + line[at + 1:], seconds)


def footage(line, seconds=SECONDS):
    """The frame that a line decomposes."""
    return take_frame(source(line) + ["!"] + TAKEN, seconds)


def make_picture(lines):
    """The picture of an entry."""
    from PIL import Image
    rows = [[footage(group[0]), *map(shown, group)] for _, part in itertools.groupby(lines, source) if (group := list(part))]
    columns = max(map(len, rows))
    width = (WIDTH - GAP * (columns - 1)) // columns
    heights = [round(width * row[0][1] / row[0][0]) for row in rows]
    picture = Image.new("RGB", (WIDTH, sum(heights) + GAP * (len(rows) - 1)), "white")
    y = 0
    for row, height in zip(rows, heights):
        for column, (frame_width, frame_height, data) in enumerate(row):
            stride = len(data) // frame_height
            panel = Image.frombuffer("RGB", (frame_width, frame_height), data, "raw", "RGB", stride, 1)
            picture.paste(panel.resize((width, height), Image.LANCZOS), (column * (width + GAP), y))
        y += height + GAP
    return picture


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", default="build")
    parser.add_argument("names", nargs="*", metavar="NAME")
    options = parser.parse_args()
    build = ROOT / options.build
    os.environ.update(GST_PLUGIN_PATH=str(build / "gst"), GST_PRESET_PATH=str(ROOT / "gst" / "edit" / "presets"),
                      INVERSE_MODELS=str(build / "models"))
    os.chdir(ROOT)
    Gst.init(None)
    entries = read_page()
    if unknown := set(options.names) - set(entries):
        sys.exit(f"no such picture in {PAGE.name}: {', '.join(sorted(unknown))}; there are {', '.join(entries)}")
    PICTURES.mkdir(exist_ok=True)
    for name in options.names or entries:
        if packages := missing_packages(entries[name]):
            print(f"{name}: skipped; install {', '.join(packages)}")
            continue
        path = PICTURES / f"{name}.jpg"
        make_picture(entries[name]).save(path, quality=80, optimize=True)
        print(f"{name}: {path.stat().st_size // 1000} kB")


if __name__ == "__main__":
    try:
        main()
    except LineError as problem:
        sys.exit(str(problem))

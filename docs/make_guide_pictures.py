#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The pictures of docs/guides/first-steps.md and editing.md, made by the launch lines that the pages show.

docs/make_guide_pictures.py [--build BUILD] [PAGE/NAME …]     (default: build, which ./dev build-only build makes, and all pictures)

Below each picture of a page is a block of launch lines. A line that ends with autovideosink is shown; one that writes a file
belongs to the shown line after it, which reads it.
A picture has a row per footage: its frame at 2 s, then what each shown line has then. Where a picture's text says "click at X, Y",
that is done. Needs python3-pil.
"""
import argparse
import contextlib
import itertools
import os
import pathlib
import re
import shlex
import sys
import tempfile
import time

import gi
gi.require_version("Gst", "1.0")
from gi.repository import Gst  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent
GUIDES = ROOT / "docs" / "guides"
PAGES = ("first-steps", "editing")
PICTURES = ROOT / "docs" / "images"
WIDTH = 1000  # of a picture, pixels
GAP = 4
SECONDS = 2
FRAME_RATE = 25  # of the bundled clip
TIMEOUT = 120  # s, for a line to come to its frame
SHOWN = "autovideosink"  # which a shown line ends with
CAMERA = "v4l2src"  # which the bundled clip stands in for
CLIP = ["filesrc", "location=media/clip.webm", "!", "decodebin"]
TAKEN = ["videoconvert", "!", "video/x-raw,format=RGB", "!", "appsink", "name=taken", "sync=false", "max-buffers=1"]
# A picture of a page, and the block of launch lines below it.
ENTRY = re.compile(r"!\[([^\]]*)\]\(\.\./images/([\w-]+/[\w-]+)\.jpg\)\n+```\n(.*?)```", re.DOTALL)
CLICK = re.compile(r"click at (\d+), (\d+)")
OURS = re.compile("intrinsic|globalintrinsic|limematerial")  # where footage ends


class LineError(Exception):
    """A launch line that does not work."""


class Recipe:
    """A shown line, the lines that go with it, and where to click in what it shows."""

    def __init__(self, shown, writers, click):
        self.shown, self.writers, self.click = shown, writers, click

    @property
    def lines(self):
        """Its lines, the one with footage first."""
        return sorted([*self.writers, self.shown], key=lambda line: not any(map(OURS.match, line)))

    @property
    def source(self):
        """The part of its lines in front of our elements."""
        return list(itertools.takewhile(lambda word: not OURS.match(word), self.lines[0]))[:-1]


def read_page(page):
    """Recipes by picture, which is PAGE/NAME."""
    entries = {}
    for text, name, block in ENTRY.findall((GUIDES / f"{page}.md").read_text()):
        recipes, writers = [], []
        for line in map(shlex.split, block.replace("\\\n", " ").splitlines()):
            if line[:1] != ["gst-launch-1.0"] or line.count(SHOWN) > 1:
                raise LineError(f"{name}: not a gst-launch-1.0 line with at most one {SHOWN}: {shlex.join(line)}")
            words = [part for word in line[1:] for part in (CLIP if word == CAMERA else [word])]
            if SHOWN in words:
                recipes.append(Recipe(words, writers, CLICK.search(text)))
                writers = []
            else:
                writers.append(words)
        entries[name] = recipes
    return entries


def read_pages():
    """Recipes of all pages by picture."""
    return {name: recipes for page in PAGES for name, recipes in read_page(page).items()}


@contextlib.contextmanager
def playing(words):
    """A playing pipeline."""
    try:
        pipeline = Gst.parse_launchv(words)
    except gi.repository.GLib.Error as error:
        raise LineError(f"{error.message}: {shlex.join(words)}") from error
    try:
        pipeline.set_state(Gst.State.PLAYING)
        yield pipeline
    finally:
        pipeline.set_state(Gst.State.NULL)


def click_at(sink, x, y):
    """Sends what a window sends that is clicked on."""
    for event in ("press", "release"):
        structure = Gst.Structure.new_from_string(f"application/x-gst-navigation, event=mouse-button-{event}, button=1, "
                                                  f"pointer_x=(double){x}, pointer_y=(double){y}")
        sink.send_event(Gst.Event.new_navigation(structure))


def take_frame(words, seconds, click=None):
    """(width, height, RGB rows of 4-byte alignment) of the first frame at or after that time that the line shows."""
    with playing(words) as pipeline:
        sink, bus = pipeline.get_by_name("taken"), pipeline.get_bus()
        deadline = time.monotonic() + TIMEOUT
        while time.monotonic() < deadline:
            if sample := sink.emit("try-pull-sample", Gst.SECOND // 10):
                at = sample.get_segment().to_running_time(Gst.Format.TIME, sample.get_buffer().pts)
                if click:
                    click_at(sink, *click.groups())
                    click, seconds = None, seconds + at / Gst.SECOND + .5  # time for it to take effect
                elif at >= seconds * Gst.SECOND:
                    caps, buffer = sample.get_caps().get_structure(0), sample.get_buffer()
                    return caps.get_value("width"), caps.get_value("height"), buffer.extract_dup(0, buffer.get_size())
            elif error := bus.pop_filtered(Gst.MessageType.ERROR):
                raise LineError(f"{error.parse_error()[0].message}: {shlex.join(words)}")
            elif sink.props.eos:
                break
        raise LineError(f"no frame at {seconds} s: {shlex.join(words)}")


def run_to_end(words):
    """Runs a line that ends by itself."""
    with playing(words) as pipeline:
        message = pipeline.get_bus().timed_pop_filtered(TIMEOUT * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
        if not message or message.type == Gst.MessageType.ERROR:
            raise LineError(f"{message.parse_error()[0].message if message else 'no end'}: {shlex.join(words)}")


def shown(recipe, seconds=SECONDS):
    """The frame that a recipe shows. Files are written up to that time, to a folder that has only media/ of this one."""
    before, at = os.getcwd(), recipe.shown.index(SHOWN)
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        os.symlink(ROOT / "media", os.path.join(folder, "media"))
        os.chdir(folder)
        stack.callback(os.chdir, before)
        for line in recipe.writers:
            end = len(recipe.source)
            run_to_end(line[:end] + ["!", "identity", f"eos-after={round(seconds * FRAME_RATE) + 2}"] + line[end:])
        return take_frame(recipe.shown[:at] + TAKEN + recipe.shown[at + 1:], seconds, recipe.click)


def footage(recipe, seconds=SECONDS):
    """The frame that a recipe decomposes."""
    return take_frame(recipe.source + ["!"] + TAKEN, seconds)


def make_picture(recipes):
    """The picture of an entry."""
    from PIL import Image
    rows = [[footage(row[0]), *map(shown, row)]
            for _, part in itertools.groupby(recipes, lambda recipe: recipe.source) if (row := list(part))]
    # Panels of a row are equally high.
    picture_rows = []
    for row in rows:
        shapes = [width / height for width, height, _ in row]
        height = round((WIDTH - GAP * (len(row) - 1)) / sum(shapes))
        panels = []
        for frame_width, frame_height, data in row:
            stride = len(data) // frame_height
            panel = Image.frombuffer("RGB", (frame_width, frame_height), data, "raw", "RGB", stride, 1)
            panels.append(panel.resize((round(height * frame_width / frame_height), height), Image.LANCZOS))
        picture_rows.append(panels)
    picture = Image.new("RGB", (WIDTH, sum(row[0].height + GAP for row in picture_rows) - GAP), "white")
    y = 0
    for panels in picture_rows:
        x = 0
        for panel in panels:
            picture.paste(panel, (x, y))
            x += panel.width + GAP
        y += panels[0].height + GAP
    return picture


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", default="build")
    parser.add_argument("names", nargs="*", metavar="PAGE/NAME")
    options = parser.parse_args()
    build = ROOT / options.build
    os.environ.update(GST_PLUGIN_PATH=str(build / "gst"), GST_PRESET_PATH=str(ROOT / "gst" / "edit" / "presets"),
                      INVERSE_MODELS=str(build / "models"))
    os.chdir(ROOT)
    Gst.init(None)
    entries = read_pages()
    if unknown := set(options.names) - set(entries):
        sys.exit(f"no such picture: {', '.join(sorted(unknown))}; there are {', '.join(entries)}")
    for name in options.names or entries:
        path = PICTURES / f"{name}.jpg"
        path.parent.mkdir(exist_ok=True)
        make_picture(entries[name]).save(path, quality=80, optimize=True)
        print(f"{name}: {path.stat().st_size // 1000} kB")


if __name__ == "__main__":
    try:
        main()
    except LineError as problem:
        sys.exit(str(problem))

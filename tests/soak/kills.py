#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Kills programs at random moments and looks for what is lost or half written:

  kills.py [transcode|player|capture] [COUNT]     (all three, 5 times each)

A result is what was there before, or whole; what is hidden beside it goes with the next run. INVERSE_TEST_SEED chooses the moments.
"""
import glob
import hashlib
import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import gi

gi.require_version("Gst", "1.0")
from gi.repository import Gst  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIPPED, LIMIT = 77, 300
Gst.init(None)


def frames_of(path):
    """How many frames of a video can be read, and whether it can be read to its end."""
    pipeline = Gst.parse_launch("filesrc name=file ! decodebin ! fakesink name=out signal-handoffs=true sync=false")
    pipeline.get_by_name("file").set_property("location", path)
    count = []
    pipeline.get_by_name("out").connect("handoff", lambda *_: count.append(1))
    pipeline.set_state(Gst.State.PLAYING)
    message = pipeline.get_bus().timed_pop_filtered(LIMIT * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
    pipeline.set_state(Gst.State.NULL)
    return len(count), bool(message) and message.type == Gst.MessageType.EOS


def run(words, folder, after=None):
    """Runs a program; kills all of its processes after so many seconds. Returns the seconds that it ran, and its exit status."""
    started = time.monotonic()
    with open(os.path.join(folder, "..", "log"), "wb") as log:
        process = subprocess.Popen(words, cwd=folder, stdout=log, stderr=log, start_new_session=True)
        try:
            process.wait(LIMIT if after is None else after)
        except subprocess.TimeoutExpired:
            # Workers have sessions of their own.
            children = subprocess.run(["pgrep", "-P", str(process.pid)], stdout=subprocess.PIPE, text=True, check=False).stdout.split()
            for child in [process.pid, *map(int, children)]:
                try:
                    os.kill(child, signal.SIGKILL)
                except ProcessLookupError:
                    pass
            process.wait()
    return time.monotonic() - started, process.returncode


def log_of(folder):
    """The end of what the last program said."""
    return (pathlib.Path(folder) / ".." / "log").read_text(errors="replace")[-1000:]


def kill_transcode(folder, chance, count):
    """A video and a folder of pictures, over results of before."""
    made = "videotestsrc num-buffers={} ! video/x-raw,width=64,height=48,framerate=25/1 ! vp8enc deadline=1 ! matroskamux ! filesink location={}"
    subprocess.run(["gst-launch-1.0", "-q", *made.format(30, "clip.mkv").split()], cwd=folder, check=True)
    for kind, output in (("mkv", "out.mkv"), ("png", "out")):
        words = [str(ROOT / "transcode/inverse-transcode"), "clip.mkv", "-o", output, "--to", kind, "--again", "--quiet", "--", "identity"]
        took, status = run(words, folder)
        assert status == 0, log_of(folder)
        for _ in range(count):
            run(words, folder, chance.uniform(0, 1.2 * took))
            path = os.path.join(folder, output)
            if kind == "mkv":
                assert frames_of(path) == (30, True), "the result is not whole"
            else:
                assert len(os.listdir(path)) == 30 and all(os.path.getsize(os.path.join(path, n)) > 100 for n in os.listdir(path))
        assert run(words, folder)[1] == 0, log_of(folder)
        left = [name for name in os.listdir(folder) if name.startswith(".")]
        assert not left, f"there is still {left}"


def kill_player(folder, chance, count):
    """A recording beside one of before, and a project."""
    source = "videotestsrc num-buffers=60 ! video/x-raw,width=64,height=48,framerate=30/1"
    environment = {"XDG_STATE_HOME": folder + "/../state"}
    os.environ.update(environment)
    words = ["xvfb-run", "-a", str(ROOT / "player/inverse-play"), source, "--edit", "intrinsictone", "--record", "new.mkv", "--overwrite", "--close-at-end"]
    took, status = run(words, folder)
    assert status == 0, log_of(folder)
    whole = frames_of(os.path.join(folder, "new.mkv"))
    assert whole[1] and whole[0] > 40, whole
    for _ in range(count):
        run(words, folder, chance.uniform(0, 1.2 * took))
        subprocess.run(["pkill", "-9", "-f", "new.mkv --overwrite --close-at-end"], check=False)
        read = frames_of(os.path.join(folder, "new.mkv"))
        assert read[1] and read[0] > 40, f"the recording of before is lost: {read}"
        for name in glob.glob(os.path.join(folder, "new.part*")):
            if os.path.getsize(name) > 100000:
                assert frames_of(name)[0] > 0, "what was recorded does not play"
        for name in glob.glob(folder + "/../state/**/*.json", recursive=True):
            json.loads(pathlib.Path(name).read_text(encoding="utf-8"))  # unsaved edits


def kill_capture(folder, chance, count):
    """A capture of a light stage over one of before."""
    line = ("lightstagetestsrc is-live=false program=static:4 name=source ! video/x-raw,width=64,height=48 ! stage.sink_0 "
            "lightstagesync name=stage program=static:4 assemble=olat location=capture stage.src_0 ! fakesink")
    words = ["gst-launch-1.0", "-q", *line.split()]
    took, status = run(words, folder)
    assert status == 0, log_of(folder)
    place = os.path.join(folder, "capture")

    def files():
        found = sorted(os.path.relpath(os.path.join(base, n), place) for base, _, names in os.walk(place) for n in names)
        return [(name, hashlib.sha256(pathlib.Path(place, name).read_bytes()).hexdigest()) for name in found if ".new/" not in name]
    pathlib.Path(place, "camera_0").mkdir(parents=True, exist_ok=True)
    pathlib.Path(place, "camera_0", "notes.txt").write_text("of the user", encoding="utf-8")
    before = files()
    assert before, os.listdir(folder)
    for _ in range(count):
        run(words, folder, chance.uniform(0, 1.2 * took))
        assert files() == before, f"{files()} in place of {before}"
        for name in glob.glob(place + "/**/lights.json", recursive=True):
            json.loads(pathlib.Path(name).read_text(encoding="utf-8"))
    assert run(words, folder)[1] == 0, log_of(folder)
    assert not glob.glob(place + "/*.new") and files() == before


def main():
    """Returns the exit status."""
    kinds = {"transcode": kill_transcode, "player": kill_player, "capture": kill_capture}
    words = sys.argv[1:]
    chosen = [words.pop(0)] if words and words[0] in kinds else list(kinds)
    count = int(words[0]) if words else 5
    chance = random.Random(int(os.environ.get("INVERSE_TEST_SEED", "0")))
    for kind in chosen:
        if kind == "player" and not shutil.which("xvfb-run"):
            print("player: skipped, there is no xvfb-run")
            continue
        with tempfile.TemporaryDirectory() as base:
            folder = os.path.join(base, "work")
            os.mkdir(folder)
            kinds[kind](folder, chance, count)
            print(f"{kind}: killed {count} times at random, nothing is lost")
    return 0


if __name__ == "__main__":
    sys.exit(main())

# SPDX-License-Identifier: LGPL-2.1-or-later
"""What tests of inverse-transcode share."""
import glob
import hashlib
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77  # the exit status by which meson knows a skipped test
# Seconds until what has not happened is given up. Kernels are built within it, on a machine with other work to do: 35 s and more.
LIMIT = 300
try:
    import gi

    gi.require_version("Gst", "1.0")
    gi.require_version("GstVideo", "1.0")
    from gi.repository import Gst, GstVideo  # noqa: F401
except (ImportError, ValueError) as problem:
    print(f"GStreamer for Python is missing ({problem}): install python3-gi, gir1.2-gst-plugins-base-1.0")
    sys.exit(SKIPPED)
sys.path[:0] = [str(ROOT / "common"), str(ROOT / "tests")]
from inverse_common.gst import structure_of  # noqa: E402

Gst.init(None)

VIDEO = "videotestsrc num-buffers={frames} ! video/x-raw,format={form},width=160,height=120,framerate=30/1 ! "
SOUND = "audiotestsrc num-buffers={buffers} ! audio/x-raw,rate=48000,channels=2 ! audioconvert ! "


class Stream:
    """A stream of a file: its caps, the hash of its packets, and how many they are."""

    def __init__(self, caps):
        self.caps, self.packets, self.hash = caps, 0, hashlib.sha256()

    @property
    def name(self):
        return structure_of(self.caps).get_name()


def frames_of(path):
    """(caps, bytes) of the decoded frames of a file, in the format that they have in it."""
    pipeline, frames = Gst.parse_launch("filesrc name=in ! decodebin ! fakesink name=out signal-handoffs=true sync=false"), []
    pipeline.get_by_name("in").set_property("location", path)
    pipeline.get_by_name("out").connect("handoff", lambda _, buffer, pad: frames.append(
        (structure_of(pad.get_current_caps()), buffer.extract_dup(0, buffer.get_size()))))
    pipeline.set_state(Gst.State.PLAYING)
    message = pipeline.get_bus().timed_pop_filtered(LIMIT * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
    pipeline.set_state(Gst.State.NULL)
    assert message and message.type == Gst.MessageType.EOS, path
    return frames


def streams_of(path):
    """The streams of a file, which must be whole, and its tags."""
    pipeline = Gst.parse_launch("filesrc name=in ! parsebin name=parse")
    pipeline.get_by_name("in").set_property("location", path)
    streams = []

    def added(_, pad):
        stream = Stream(pad.get_current_caps())
        streams.append(stream)
        sink = Gst.ElementFactory.make("fakesink")
        sink.set_property("sync", False)
        sink.set_property("async", False)  # one thread feeds them all
        sink.set_property("signal-handoffs", True)

        def handoff(_, buffer, sink_pad):
            stream.caps = sink_pad.get_current_caps()
            stream.packets += 1
            stream.hash.update(buffer.extract_dup(0, buffer.get_size()))

        sink.connect("handoff", handoff)
        pipeline.add(sink)
        sink.sync_state_with_parent()
        pad.link(sink.get_static_pad("sink"))

    pipeline.get_by_name("parse").connect("pad-added", added)
    pipeline.set_state(Gst.State.PLAYING)
    tags, bus = {}, pipeline.get_bus()
    while True:
        message = bus.timed_pop_filtered(LIMIT * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR | Gst.MessageType.TAG)
        if message is None or message.type == Gst.MessageType.ERROR:
            raise AssertionError(f"{path}: {message.parse_error()[0].message if message else 'no end'}")
        if message.type == Gst.MessageType.EOS:
            break
        found = message.parse_tag()
        for name in ("title", "image-orientation"):
            known, value = found.get_string(name)
            if known:
                tags.setdefault(name, value)
    pipeline.set_state(Gst.State.NULL)
    return streams, tags


class Case(unittest.TestCase):
    """A folder for each test, clips in it, and the program."""

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def make(self, name, line, **properties):
        """Runs a line; `properties`: of its elements, by their names."""
        os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
        pipeline = Gst.parse_launch(line + " ! filesink name=out")
        pipeline.get_by_name("out").set_property("location", self.path(name))
        for element, values in properties.items():
            for key, value in values.items():
                pipeline.get_by_name(element).set_property(key, value)
        pipeline.set_state(Gst.State.PLAYING)
        message = pipeline.get_bus().timed_pop_filtered(LIMIT * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
        pipeline.set_state(Gst.State.NULL)
        if message is None or message.type == Gst.MessageType.ERROR:
            raise AssertionError(f"{line}: {message.parse_error()[0].message if message else 'no end'}")
        return self.path(name)

    def clip(self, name="clip.mkv", frames=12, sound="", form="I420", codec="vp8enc deadline=1"):
        line = VIDEO.format(frames=frames, form=form) + f"{codec} ! queue ! mux. "
        if sound:
            line += SOUND.format(buffers=max(frames, 12) * 1600 // 1024 + 1) + f"{sound} ! queue ! mux. "
        return self.make(name, line + "matroskamux name=mux")

    def start(self, *words, env=None):
        return subprocess.Popen([ROOT / "transcode" / "inverse-transcode", *words], cwd=self.folder, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, errors="surrogateescape", env=env)

    def run_it(self, *words, status=0, env=None, parts=False):
        """What it says; its exit status must be `status`, and no part may be left but with `parts`."""
        process = self.start(*words, env=env)
        output, errors = process.communicate(timeout=LIMIT)
        self.assertEqual(process.returncode, status, errors)
        self.assertNotIn("Traceback", errors)
        left = [name for _, folders, names in os.walk(self.folder) for name in folders + names if name.endswith(".part")]
        self.assertTrue(parts or not left, left)
        return output + errors

    def need(self, *elements):
        for element in elements:
            if not Gst.ElementFactory.find(element):
                self.skipTest(f"there is no {element}")

    def wait_for_part(self, folder="."):
        end = time.monotonic() + LIMIT
        while time.monotonic() < end:
            parts = glob.glob(os.path.join(self.path(folder), ".*.part"))
            if parts and os.path.getsize(parts[0]) > 4000:
                return
            time.sleep(0.05)
        self.fail("nothing was written")

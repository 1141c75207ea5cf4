# SPDX-License-Identifier: LGPL-2.1-or-later
"""Entries of Cheese's menu of effects: each is found by Cheese and plays, as Cheese plays it."""
import os
import pathlib
import re
import subprocess
import sys
import unittest

import support
from gi.repository import GLib, Gst

FOLDER = support.ROOT / "gst" / "edit" / "cheese"
NAMES = {"Reflectance", "Repaint", "Shading"}
LIST = """
import gi
gi.require_version('Cheese', '3.0')
from gi.repository import Cheese
for effect in Cheese.Effect.load_effects():
    print(effect.get_name(), effect.get_pipeline_desc(), sep=chr(9))
"""


def read_effects():
    """The launch line of each, by name."""
    found = {}
    for path in FOLDER.glob("*.effect"):
        file = GLib.KeyFile()
        file.load_from_file(str(path), GLib.KeyFileFlags.NONE)
        assert file.get_string("Effect", "Comment")
        found[file.get_string("Effect", "Name")] = file.get_string("Effect", "PipelineDescription")
    return found


class Cheese(support.Case):
    def frames_of(self, effect, caps):
        """Ten frames behind the bin that Cheese makes of an effect."""
        bin_ = Gst.parse_bin_from_description(f"videoconvert name=colorspace1 ! {effect} ! videoconvert name=colorspace2", True)
        pipeline = Gst.parse_launch(f"videotestsrc num-buffers=10 ! {caps} ! identity name=in "
                                    "capsfilter name=out caps=video/x-raw,format=RGB ! filesink name=file")
        pipeline.add(bin_)
        self.assertTrue(pipeline.get_by_name("in").link(bin_))
        self.assertTrue(bin_.link(pipeline.get_by_name("out")))
        pipeline.get_by_name("file").props.location = self.path("frames")
        pipeline.set_state(Gst.State.PLAYING)
        message = pipeline.get_bus().timed_pop_filtered(
            support.LIMIT * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR | Gst.MessageType.WARNING)
        pipeline.set_state(Gst.State.NULL)
        self.assertIsNotNone(message, "does not end")
        self.assertEqual(message.type, Gst.MessageType.EOS, message.get_structure() and message.get_structure().get_value("gerror"))
        return pathlib.Path(self.path("frames")).read_bytes()

    def test_each_plays(self):
        effects = read_effects()
        self.assertEqual(set(effects), NAMES)
        for caps in ("video/x-raw,format=YUY2,width=160,height=120", "video/x-raw,format=I420,width=158,height=90"):
            plain = self.frames_of("identity", caps)
            for name, effect in effects.items():
                with self.subTest(effect=name, caps=caps):
                    frames = self.frames_of(effect, caps)
                    self.assertEqual(len(frames), len(plain))
                    self.assertNotEqual(frames[-len(frames) // 10:], plain[-len(plain) // 10:])

    def test_cheese_lists_them(self):
        data = self.path("data")
        os.mkdir(data)
        os.symlink(FOLDER, os.path.join(data, "gnome-video-effects"))
        listed = subprocess.run([sys.executable, "-c", LIST], capture_output=True, text=True,
                                env={**os.environ, "XDG_DATA_DIRS": data, "XDG_DATA_HOME": self.path("none")})
        if re.search("Namespace Cheese not available|No module named", listed.stderr):
            self.skipTest("Cheese is missing: install gir1.2-cheese-3.0")
        self.assertEqual(listed.returncode, 0, listed.stderr)
        self.assertEqual(dict(line.split("\t") for line in listed.stdout.splitlines()), read_effects())


unittest.main(verbosity=2)

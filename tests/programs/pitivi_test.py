# SPDX-License-Identifier: LGPL-2.1-or-later
"""Effects that a video editor offers. Pitivi takes all elements of GStreamer whose class has "Effect" and "Video" in it, and
makes an asset of GStreamer Editing Services of each: so each has to work on frames, alone, as it is."""
import pathlib
import subprocess
import sys
import unittest

import gi

import support
from gi.repository import Gst

try:
    gi.require_version("GES", "1.0")
    from gi.repository import GES
except (ImportError, ValueError) as error:
    support.skip(f"GES is missing ({error}): install gir1.2-ges-1.0")
GES.init()
WHOLE = {"intrinsicdecomp", "intrinsicdecompthesis", "globalintrinsic", "globalintrinsicthesis", "intrinsicedit"}
PARTS = {"intrinsiccompose", "intrinsicdespill", "intrinsicmerge", "intrinsicrecolor", "intrinsicselect", "intrinsicsplit",
         "intrinsicstylize", "intrinsictone"}  # need layers
LIST = """
import sys
sys.path.insert(0, sys.argv[1])
import gi
for name, version in (('Gst', '1.0'), ('GES', '1.0'), ('Gtk', '3.0'), ('GstController', '1.0')):
    gi.require_version(name, version)
from gi.repository import GES, Gst
Gst.init(None)
GES.init()
from pitivi.effects import EffectsManager
manager = EffectsManager()
for factory in manager.video_effects:
    print(manager.get_info(factory.get_name()).bin_description)
"""


def effects_of(plugin):
    """Names of the elements that Pitivi takes for effects."""
    factories = Gst.Registry.get().get_feature_list_by_plugin(plugin)
    return {f.get_name() for f in factories if isinstance(f, Gst.ElementFactory) and
            "Effect" in f.get_metadata("klass") and "Video" in f.get_metadata("klass")}


class Editors(support.Case):
    def play(self, effect, clip):
        """Plays a timeline of one clip with an effect to its end."""
        timeline = GES.Timeline.new()
        timeline.add_track(GES.VideoTrack.new())
        asset = GES.UriClipAsset.request_sync(Gst.filename_to_uri(clip))
        added = timeline.append_layer().add_asset(asset, 0, 0, Gst.SECOND // 2, GES.TrackType.VIDEO)
        self.assertTrue(added.add(effect))
        pipeline = GES.Pipeline.new()
        pipeline.set_timeline(timeline)
        sink = Gst.ElementFactory.make("fakesink")
        frames = []
        sink.get_static_pad("sink").add_probe(
            Gst.PadProbeType.BUFFER, lambda _, info: (frames.append(info.get_buffer().pts), Gst.PadProbeReturn.OK)[1])
        pipeline.preview_set_video_sink(sink)
        pipeline.set_mode(GES.PipelineFlags.VIDEO_PREVIEW)
        pipeline.set_state(Gst.State.PLAYING)
        message = pipeline.get_bus().timed_pop_filtered(support.LIMIT * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
        pipeline.set_state(Gst.State.NULL)
        self.assertIsNotNone(message, "does not end")
        self.assertEqual(message.type, Gst.MessageType.EOS, message.get_structure() and message.get_structure().get_value("gerror"))
        self.assertGreater(len(set(frames)), 3)

    def test_each_effect_is_an_asset_that_plays(self):
        effects = effects_of("inverse")
        self.assertLessEqual(WHOLE, effects)
        clip = self.clip(10)
        for name in effects:
            with self.subTest(name):
                asset = GES.Asset.request(GES.Effect, name)
                self.assertEqual(asset.get_id(), f"video {name}")
                self.play(asset.extract(), clip)
        listed = {asset.get_id() for asset in GES.list_assets(GES.Effect)}
        self.assertLessEqual({f"video {name}" for name in effects}, listed)

    def test_elements_that_need_layers_are_not_offered(self):
        self.assertFalse(PARTS & effects_of("inverse"))
        for name in PARTS:
            self.assertIn("Video", Gst.ElementFactory.find(name).get_metadata("klass"))

    def test_pitivi_lists_them(self):
        folder = next(pathlib.Path("/usr").glob("lib/**/pitivi/python"), None)
        if not folder:
            self.skipTest("Pitivi is missing: install pitivi")
        display = support.Display()
        self.addCleanup(display.close)
        listed = subprocess.run([sys.executable, "-c", LIST, str(folder)], capture_output=True, text=True, timeout=support.LIMIT)
        self.assertEqual(listed.returncode, 0, listed.stderr)
        names = set(listed.stdout.split())
        self.assertLessEqual(WHOLE, names)
        self.assertFalse(PARTS & names)


unittest.main(verbosity=2)

# SPDX-License-Identifier: LGPL-2.1-or-later
"""Playing, exchanging elements, recording, and what goes wrong: with a sink in place of the window."""
import json
import os
import shutil
import struct
import subprocess
import sys
import unittest

import support
from gi.repository import Gst, GstVideo
from inverse_common import media
from inverse_common.gst import structure_of
from inverse_play import autosave, playback, project
from inverse_play.chain import Chain
from inverse_play.project import Project
from inverse_play.session import Session

RED, MAGENTA, YELLOW = (125, 40), (100, 40), (30, 40)  # bars of a test picture of 160 x 120 pixels
SMALL = "video/x-raw,width=160,height=120,framerate=30/1"


class Viewer:
    """A Session, and the times of the frames that it showed."""

    def __init__(self, case, made=None, every_frame=False):
        self.times, self.told, self._every_frame = [], [], every_frame
        self.session = Session(self._sink, lambda: Gst.ElementFactory.make("fakesink", None), made or Project())
        self.session.report = self.told.append
        case.addCleanup(self.session.close)

    def _sink(self):
        sink = Gst.ElementFactory.make("fakesink", None)
        for name, value in (("signal-handoffs", True), ("qos", not self._every_frame)):
            sink.set_property(name, value)
        sink.connect("handoff", lambda _, buffer, pad: self.times.append(buffer.pts))
        return sink

    @property
    def player(self):
        return self.session.playback

    def wait(self, until, seconds=support.LIMIT):
        """Runs until something is true."""
        if not support.pump(seconds, until):
            raise AssertionError(f"waited in vain: {self.player.state}, {self.told}")

    def open(self, text):
        """Opens a source and waits for its first frame."""
        self.session.open(text)
        self.wait(lambda: self.player.width > 0)
        return self

    def pause(self):
        """Pauses, and waits for the frame that stays."""
        self.session.toggle_playing()
        # A bin that goes to PLAYING meanwhile may have none of its elements in the state that it tells.
        self.wait(lambda: self.player.sink.get_state(0)[:2] == (Gst.StateChangeReturn.SUCCESS, Gst.State.PAUSED))

    def ends(self):
        """Waits for the end."""
        self.wait(lambda: self.player.state in (playback.ENDED, playback.FAILED))

    def color(self, at):
        """The color of a pixel of what is shown; None before the first frame."""
        sample = self.player.sink.get_property("last-sample")
        if not sample:
            return None
        sample = GstVideo.video_convert_sample(sample, Gst.Caps.from_string("video/x-raw,format=RGB"), Gst.SECOND)
        buffer = sample.get_buffer()
        return support.color((0, structure_of(sample.get_caps()), buffer.extract_dup(0, buffer.get_size())), *at)

    def is_green(self, at):
        """Whether the pixel was painted green."""
        red, green, blue = self.color(at) or (0, 0, 0)
        return green > red + 60 and green > blue + 60


class Rows(support.Case):
    """Elements of any kind in a Chain: also with threads of their own."""

    def test_no_frame_is_lost_in_a_queue(self):
        frames, times = 600, []
        pipeline = Gst.parse_launch(f"videotestsrc is-live=true num-buffers={frames} ! "
                                    "video/x-raw,width=16,height=16,framerate=200/1 ! queue name=entry fakesink name=end signal-handoffs=true")
        end = pipeline.get_by_name("end")
        end.connect("handoff", lambda _, buffer, pad: times.append(buffer.pts))
        row = Chain(pipeline, pipeline.get_by_name("entry").get_static_pad("src"), end.get_static_pad("sink"))
        small = "queue max-size-buffers=5"
        kinds = (f"{small} ! identity sleep-time=3000 ! {small}", "identity sleep-time=1000", f"{small} ! identity")
        parts = [Gst.parse_bin_from_description(kinds[i % 3], True) for i in range(5)]
        row.set(parts[:2])
        pipeline.set_state(Gst.State.PLAYING)
        self.addCleanup(pipeline.set_state, Gst.State.NULL)
        bus, count = pipeline.get_bus(), 0
        while not (message := bus.pop_filtered(Gst.MessageType.EOS | Gst.MessageType.ERROR)):
            first = count % len(parts)
            row.set((parts + parts)[first:first + count % 4])
            count += 1
            support.pump(0.02)
        failed = message.type == Gst.MessageType.ERROR
        self.assertFalse(failed, failed and message.parse_error())
        self.assertEqual((len(times), times), (frames, sorted(set(times))))
        self.assertGreater(count, 10)


GREEN = {"key": "0xffc00000", "target": "0xff00c000", "tolerance": 0.9}


class Editors(support.Case):
    def test_no_frame_is_lost_while_editors_change(self):
        frames = 100
        viewer = Viewer(self, every_frame=True)
        viewer.open(f"videotestsrc num-buffers={frames} ! {SMALL}")
        session, count = viewer.session, 0
        while viewer.player.state == playback.PLAYING:
            self.change(session, count)
            count += 1
            support.pump(0.03)
        self.assertEqual(len(viewer.times), frames, viewer.told)
        self.assertEqual(viewer.times, sorted(set(viewer.times)))
        self.assertGreater(count, 10)
        self.assertEqual(viewer.told, [])

    @staticmethod
    def change(session, count):
        """Adds, reorders, switches, removes, or undoes."""
        editors = session.project.editors
        if len(editors) < 2 or count % 6 == 0:
            session.add_editor("intrinsicrecolor", GREEN)
        elif len(editors) > 4:
            session.remove_editor(editors[1].name)
        elif count % 6 == 2:
            session.move_editor(editors[-1].name, -1)
        elif count % 6 == 3:
            session.switch_editor(editors[0].name)
        elif count % 6 == 4:
            session.remove_editor(editors[0].name)
        else:
            session.undo()
            session.use_tool(tap="" if count % 4 else None)

    def test_editors_do_what_they_say(self):
        viewer = Viewer(self).open("test")
        viewer.wait(lambda: viewer.color((500, 100)))
        name = viewer.session.add_editor("intrinsicrecolor", GREEN)
        red = (500, 100)
        viewer.wait(lambda: viewer.is_green(red))
        viewer.session.switch_editor(name)
        viewer.wait(lambda: not viewer.is_green(red))
        viewer.session.switch_editor(name)
        viewer.wait(lambda: viewer.is_green(red))
        viewer.session.remove_editor(name)
        viewer.wait(lambda: not viewer.is_green(red))
        viewer.session.undo()
        viewer.wait(lambda: viewer.is_green(red))

    def test_the_order_counts(self):
        viewer = Viewer(self).open("test")
        first = viewer.session.add_editor("intrinsicrecolor", {**GREEN, "target": "0xff0000c0"})
        viewer.session.add_editor("intrinsicrecolor", {**GREEN, "key": "0xff0000c0"})
        red = (500, 100)
        viewer.wait(lambda: viewer.is_green(red))  # red to blue, blue to green
        viewer.session.move_editor(first, 1)
        viewer.wait(lambda: (viewer.color(red) or (0, 0, 0))[2] > 100)
        viewer.session.undo()
        viewer.wait(lambda: viewer.is_green(red))

    def test_another_decomposer(self):
        viewer = Viewer(self).open("test")
        viewer.session.set_decomposer("globalintrinsic")
        viewer.session.show_layer("indirect")
        viewer.wait(lambda: (viewer.color((500, 100)) or (255,))[0] < 128)
        viewer.session.undo()
        viewer.session.undo()
        viewer.wait(lambda: viewer.color((500, 100))[0] > 128)
        self.assertEqual(viewer.told, [])

    def test_a_property_that_needs_a_new_element(self):
        viewer = Viewer(self).open("test")
        before = viewer.player.stage.frames()
        viewer.session.set_property("decomposer", "device", "llvmpipe")
        viewer.wait(lambda: 0 < viewer.player.stage.frames() < before + 1000)
        self.assertEqual(viewer.told, [])

    def test_the_last_of_many_changes_counts(self):
        viewer = Viewer(self).open("test")
        for layer in 10 * ("reflectance", "shading", "input", "difference"):
            viewer.session.show_layer(layer)
            support.pump(0.01)
        self.assertEqual(viewer.session.project.compose.get("show"), "difference")
        viewer.wait(lambda: not viewer.player.stage._to_set)
        self.assertEqual(viewer.player.stage.compose.get_property("show").value_nick, "difference")

    def test_picks_the_reflectance(self):
        viewer = Viewer(self).open("test")
        self.assertIsNone(viewer.session.recolor_everywhere(500, 100))
        viewer.session.use_tool(tap="")
        viewer.wait(lambda: viewer.session.recolor_everywhere(500, 100))
        key = int(viewer.session.project.editors[0].get("key"), 0)
        self.assertGreater(key >> 16 & 255, 100)
        self.assertLess(key & 0xffff, 0x2020)
        blue = viewer.session.playback.stage.color_at(500, 100)  # behind that editor
        viewer.wait(lambda: viewer.session.playback.stage.color_at(500, 100) & 255 > 100)
        self.assertIsNotNone(blue)
        for beyond in ((-9, -9), (10 ** 6, 10 ** 6)):
            self.assertIsNotNone(viewer.session.playback.stage.color_at(*beyond))


class Files(support.Case):
    def test_stays_on_the_last_frame_and_plays_again(self):
        viewer = Viewer(self).open(self.clip(10))
        viewer.ends()
        self.assertAlmostEqual(viewer.player.position, 0.9, delta=0.11)
        self.assertEqual(viewer.player.clock, viewer.player.duration)
        self.assertIsNotNone(viewer.color(RED))
        viewer.session.add_editor("intrinsicrecolor", GREEN)  # edits the frame that stands still
        viewer.wait(lambda: viewer.is_green(RED))
        self.assertEqual(viewer.player.state, playback.ENDED)
        shown = len(viewer.times)
        viewer.session.toggle_playing()
        viewer.wait(lambda: len(viewer.times) > shown + 3)
        viewer.ends()
        self.assertEqual(viewer.told, [])

    def test_a_frame_that_stands_still_is_edited(self):
        viewer = Viewer(self).open(self.clip(60))
        viewer.wait(lambda: viewer.player.seekable)
        viewer.pause()
        at = viewer.player.position
        name = viewer.session.add_editor("intrinsicrecolor", GREEN)
        viewer.wait(lambda: viewer.is_green(RED))
        viewer.session.switch_editor(name)
        viewer.wait(lambda: not viewer.is_green(RED))
        self.assertAlmostEqual(viewer.player.position, at, delta=0.11)
        self.assertEqual(viewer.player.state, playback.PAUSED)

    @staticmethod
    def shown(player):
        """The time and the bytes of the picture."""
        buffer = player.sink.get_property("last-sample").get_buffer()
        return round(player.position, 6), buffer.extract_dup(0, buffer.get_size())

    def test_a_frame_that_stands_still_stays_whatever_is_done_to_it(self):
        # Matroska's times are rounded to milliseconds: frames of 30 a second overlap.
        viewer = Viewer(self).open(self.clip(60, pattern="ball", rate=30))
        session, seen = viewer.session, set()
        for _ in range(4):
            viewer.pause()
            before = self.shown(viewer.player)
            for step in (lambda: session.add_editor("intrinsictone", {"look": "metal"}), session.undo, session.redo, session.undo):
                step()
                viewer.wait(lambda: not viewer.player.waits)
            self.assertEqual(self.shown(viewer.player), before)
            seen.add(before[0])
            session.toggle_playing()
            viewer.wait(lambda: viewer.player.position > before[0] + 0.2)
        self.assertEqual(len(seen), 4)

    def test_colors_are_picked_while_it_stands_still(self):
        viewer = Viewer(self).open(self.clip(60))
        viewer.wait(lambda: viewer.player.seekable)
        viewer.pause()
        viewer.session.use_tool(tap="")
        viewer.wait(lambda: viewer.session.recolor_everywhere(*RED))
        self.assertLess(int(viewer.session.project.editors[0].get("key"), 0) & 0xffff, 0x3030)

    def test_seeks(self):
        viewer = Viewer(self).open(self.clip(80))
        viewer.wait(lambda: viewer.player.seekable)
        self.assertAlmostEqual(viewer.player.duration, 8, delta=0.2)
        viewer.session.toggle_playing()
        for seconds in (1, 7, 3, 99, -5, 5):  # the last one counts
            viewer.player.seek(seconds)
        viewer.wait(lambda: abs(viewer.player.position - 5) < 0.11)
        viewer.player.seek(1)
        for _ in range(3):  # each from where the one before leads
            viewer.player.seek(viewer.player.goal + 1)
        viewer.player.refresh()
        viewer.wait(lambda: abs(viewer.player.position - 4) < 0.11)
        self.assertEqual(viewer.told, [])

    def test_a_file_that_is_cut_off(self):
        path = self.clip(60, pattern="snow")
        with open(path, "r+b") as file:
            file.truncate(os.path.getsize(path) // 2)
        viewer = Viewer(self)
        viewer.session.record_at_start = self.path("out.mkv")
        viewer.open(path).ends()
        viewer.wait(lambda: viewer.session.troubles)
        viewer.wait(lambda: viewer.session.recorder is None)
        self.assertIn("cut off", viewer.session.troubles[0].text + viewer.session.troubles[0].advice)
        times = [frame[0] for frame in support.read_video(self.path("out.mkv"))]
        self.assertGreater(len(times), 20)
        self.assertLess(len(times), 40)

    def test_why_a_flow_ended_is_said(self):
        viewer = Viewer(self)
        viewer.session.open(f"videotestsrc ! {SMALL} ! identity name=last")
        viewer.wait(lambda: viewer.times)
        pad = viewer.player._pipeline.get_by_name("last").get_static_pad("src")
        pad.unlink(pad.get_peer())
        viewer.wait(lambda: viewer.session.troubles)
        self.assertIn("(not-linked)", viewer.session.troubles[0].text)

    def test_a_short_file_that_is_cut_off(self):
        path = self.clip(12, pattern="snow")
        with open(path, "r+b") as file:
            file.truncate(os.path.getsize(path) * 6 // 10)
        viewer = Viewer(self).open(path)
        viewer.ends()
        viewer.wait(lambda: viewer.session.troubles)
        self.assertIn("of 1.2 s: it is cut off", viewer.session.troubles[0].text)
        self.assertLess(viewer.player.clock, 1)  # not the end

    def test_frames_of_a_recording_that_are_left_out_are_no_cut(self):
        viewer = Viewer(self)
        viewer.session.open(f"rgbdsrc location={self.recording()} ! identity drop-probability=1")
        viewer.ends()
        self.assertEqual((viewer.player.duration > 0.1, viewer.session.troubles), (True, []))

    def test_sound_that_ends_after_the_video_is_no_cut(self):
        video = "videotestsrc num-buffers=5 ! video/x-raw,width=160,height=120,framerate=10/1 ! "
        sound = "audiotestsrc num-buffers=200 samplesperbuffer=441 ! audio/x-raw,rate=44100 ! "  # 2 s
        for name, coders, muxer in (("a.mkv", ("vp8enc deadline=1", "vorbisenc"), "matroskamux"),
                                    ("a.mov", ("jpegenc", "mulawenc"), "qtmux")):
            support.run_line(f"{video} {coders[0]} ! mux. {sound} audioconvert ! audioresample ! {coders[1]} ! mux. "
                             f"{muxer} name=mux ! filesink location={self.path(name)}")
            viewer = Viewer(self).open(self.path(name))
            viewer.ends()
            self.assertGreater(viewer.player.duration, 1.9)
            self.assertEqual(viewer.told, [], name)
            self.assertEqual(viewer.player.clock, viewer.player.duration)

    def test_what_is_no_video(self):
        with open(self.path("text.mp4"), "w", encoding="utf-8") as file:
            file.write("this is no video")
        support.run_line("audiotestsrc num-buffers=20 ! vorbisenc ! matroskamux ! "
                         f"filesink location={self.path('a.mkv')}")
        with open(self.path("list.png"), "wb") as file:
            file.write(b"ID3\x04\0\0\0\0\0\0#EXTM3U\n#EXT-X-TARGETDURATION:2\n#EXTINF:2,\nhttp://127.0.0.1:9/x.ts\n")
        for name, advice in (("text.mp4", "another file"), ("a.mkv", "a file that has one"), ("list.png", "if you trust it")):
            viewer = Viewer(self)
            viewer.session.open(self.path(name))
            viewer.wait(lambda viewer=viewer: viewer.told)
            self.assertTrue(viewer.told[0].fatal, viewer.told)
            self.assertIn(advice, viewer.told[0].advice, viewer.told[0])

    def test_a_camera_that_vanishes_and_comes_again(self):
        line = f"videotestsrc is-live=true ! {SMALL} ! identity error-after=%d"
        viewer = Viewer(self).open(line % 20)
        viewer.wait(lambda: viewer.player.state == playback.FAILED and viewer.color(RED))
        self.assertIsNotNone(viewer.color(RED))  # its last picture stays
        self.assertEqual(len(viewer.told), 1)
        self.assertTrue(viewer.told[0].advice)
        viewer.session.add_editor("intrinsicrecolor", GREEN)  # nothing hangs
        viewer.open(line % 100000)
        viewer.wait(lambda: viewer.is_green(RED))


class Recording(support.Case):
    def test_all_frames_without_jumps(self):
        viewer = Viewer(self)
        viewer.session.record_at_start = self.path("out.mkv")
        viewer.open(self.clip(40))
        viewer.wait(lambda: viewer.player.position > 1)
        viewer.session.add_editor("intrinsicrecolor", GREEN)
        viewer.wait(lambda: viewer.player.position > 2)
        viewer.session.toggle_playing()  # a pause leaves no gap
        support.pump(0.5)
        viewer.session.toggle_playing()
        viewer.ends()
        frames = support.read_video(self.path("out.mkv"))
        steps = [later[0] - sooner[0] for sooner, later in zip(frames, frames[1:])]
        self.assertGreaterEqual(len(frames), 40)
        self.assertTrue(all(0.09 < step < 0.111 for step in steps), steps)
        self.assertGreater(support.color(frames[0], *RED)[0], 150)
        self.assertGreater(support.color(frames[-1], *RED)[1], 100)
        self.assertEqual(viewer.session.troubles, [])

    def test_a_size_that_changes(self):
        """In formats and rates that change, too: the recording has the first size, and says so."""
        parts = (("I420", 160, 120, 10), ("NV12", 208, 160, 30), ("I420", 120, 160, 10))
        lines = " ".join(f"videotestsrc num-buffers=12 ! video/x-raw,format={form},width={w},height={h},framerate={rate}/1 ! jpegenc ! c." for form, w, h, rate in parts)
        support.run_line(f"{lines} concat name=c ! multipartmux ! filesink location={self.path('changes.multi')}")
        for ending in ("mkv", "webm", "mp4"):
            with self.subTest(ending):
                viewer = Viewer(self, every_frame=True)
                viewer.session.record_at_start = self.path(f"out.{ending}")
                viewer.open(self.path("changes.multi"))
                viewer.ends()
                self.assertEqual(viewer.session.troubles, [])
                frames = support.read_video(self.path(f"out.{ending}"))
                self.assertEqual(len(frames), len(viewer.times))
                self.assertEqual({(caps.get_value("width"), caps.get_value("height")) for _, caps, _ in frames}, {(160, 120)})
                self.assertTrue(any("changes from 160x120 to 208x160" in told.advice for told in viewer.told), viewer.told)
                viewer.session.close()

    def speaking(self):
        """A clip of four seconds, whose sound is a tone between one and two seconds and from three on."""
        path = self.path("speaking.mkv")
        tones = " ".join(f"audiotestsrc num-buffers=10 samplesperbuffer=4800 volume={volume} ! audio/x-raw,rate=48000 ! c." for volume in (0, 0.5, 0, 0.5))
        support.run_line("videotestsrc num-buffers=40 ! video/x-raw,width=160,height=120,framerate=10/1 ! vp8enc deadline=1 ! queue ! matroskamux name=mux ! "
                         f"filesink location={path} concat name=c ! opusenc ! queue ! mux. {tones}")
        return path

    def assert_loud(self, path, seconds):
        """The sound of a file: whether a tone is to be heard in each half second."""
        heard = support.read_sound(path)
        for at, loud in enumerate(seconds):
            middle = heard[5 * at + 1:5 * at + 4]
            self.assertTrue(min(middle) > 0.2 if loud else max(middle) < 0.1, f"{at / 2} s: {heard}")
        self.assertAlmostEqual(len(heard), 5 * len(seconds), delta=2)

    def test_sound_is_recorded_where_the_video_is(self):
        for ending in ("mkv", "webm", "mp4"):
            with self.subTest(ending):
                out = self.path(f"out.{ending}")
                viewer = Viewer(self, every_frame=True)
                viewer.session.record_at_start = out
                viewer.open(self.speaking())
                viewer.wait(lambda: viewer.player.position > 1)
                viewer.pause()
                support.pump(0.3)
                viewer.session.toggle_playing()
                viewer.ends()
                self.assertEqual(viewer.session.troubles, [])
                self.assert_loud(out, [0, 0, 1, 1, 0, 0, 1, 1])
                viewer.session.close()

    def test_sound_follows_a_seek(self):
        out, viewer = self.path("out.mkv"), Viewer(self, every_frame=True)
        viewer.session.record_at_start = out
        viewer.open(self.speaking())
        viewer.wait(lambda: viewer.player.position > 0.35)
        viewer.pause()
        viewer.player.seek(3.0)
        viewer.wait(lambda: not viewer.player.waits)
        viewer.session.toggle_playing()
        viewer.ends()
        frames, heard = support.read_video(out), support.read_sound(out)
        silent = next(at for at, loud in enumerate(heard) if loud > 0.2)
        self.assertLess(silent, 10, heard)
        self.assertGreater(min(heard[silent + 1:silent + 9]), 0.2, heard)
        self.assertAlmostEqual(len(heard), len(frames), delta=2)

    def test_it_is_turned_as_the_file_says(self):
        if not Gst.ElementFactory.find("openh264enc"):
            self.skipTest("there is no openh264enc")
        clip = self.path("clip.mp4")
        support.run_line("videotestsrc num-buffers=8 ! video/x-raw,width=160,height=120,framerate=10/1 ! openh264enc ! h264parse ! mp4mux ! "
                         f"filesink location={clip}")
        with open(clip, "r+b") as file:
            matrix = file.read().index(b"tkhd") + 4 + 40
            file.seek(matrix)
            file.write(struct.pack(">9i", 0, 1 << 16, 0, -1 << 16, 0, 0, 0, 0, 1 << 30))
        viewer = Viewer(self, every_frame=True).open(clip)
        self.assertEqual((viewer.player.width, viewer.player.height), (120, 160))
        self.assertIn("videoflip", viewer.session.launch_line())

    def test_interlaced_video_plays(self):
        for form in ("I420", "I420_10LE"):
            clip = self.path(f"{form}.mkv")
            support.run_line(f"videotestsrc num-buffers=8 pattern=ball ! video/x-raw,format={form},width=160,height=120,framerate=10/1,"
                             f"interlace-mode=interleaved,field-order=top-field-first ! avenc_ffv1 ! matroskamux ! filesink location={clip}")
            viewer = Viewer(self, every_frame=True).open(clip)
            viewer.ends()
            self.assertEqual(viewer.session.troubles, [])
            self.assertIn("deinterlace", viewer.player.source.line)

    def test_jpeg_keeps_its_colors(self):
        if not Gst.ElementFactory.find("avdec_mjpeg"):
            self.skipTest("there is no avdec_mjpeg")
        media.prefer_decoders()  # as __main__ does
        colors, points = [], [(x, y) for y in range(4, 120, 12) for x in range(4, 160, 12)]
        for ending in ("avenc_ffv1 ! matroskamux", "jpegenc quality=100 ! avimux"):
            clip = self.path(f"{len(colors)}.video")
            support.run_line("videotestsrc num-buffers=3 pattern=colors ! video/x-raw,format=Y444,colorimetry=(string)1:4:0:0,width=160,height=120,"
                             f"framerate=10/1 ! {ending} ! filesink location={clip}")
            viewer = Viewer(self, every_frame=True).open(clip)
            viewer.ends()
            colors.append([viewer.color(at) for at in points])
        differences = [abs(one - other) for pixels in zip(*colors) for one, other in zip(*pixels)]
        self.assertLess(sum(differences) / len(differences), 3)

    def test_the_video_plays_and_not_a_cover_before_it(self):
        clip = self.path("cover.mkv")
        support.run_line("videotestsrc num-buffers=1 ! video/x-raw,width=64,height=48,framerate=1/1 ! jpegenc ! queue ! mux. "
                         "videotestsrc num-buffers=20 ! video/x-raw,format=I420,width=160,height=120,framerate=10/1 ! vp8enc deadline=1 ! queue ! "
                         f"mux. matroskamux name=mux ! filesink location={clip}")
        viewer = Viewer(self, every_frame=True).open(clip)
        viewer.ends()
        self.assertEqual((viewer.player.width, viewer.player.height), (160, 120))
        self.assertEqual(len(viewer.times), 20)
        self.assertEqual(viewer.session.troubles, [])

    def test_a_seek_goes_on_in_the_file(self):
        viewer = Viewer(self).open(self.clip(80))
        viewer.wait(lambda: viewer.player.seekable)
        viewer.session.start_recording(self.path("out.mkv"))
        support.pump(0.5)
        for seconds in (6, 1, 7):
            viewer.player.seek(seconds)
            support.pump(0.5)
        viewer.ends()
        times = [frame[0] for frame in support.read_video(self.path("out.mkv"))]
        self.assertTrue(all(0 < later - sooner < 1.01 for sooner, later in zip(times, times[1:])), times)

    def test_a_window_that_closes_closes_the_file(self):
        for ending in (".mkv", ".webm"):
            viewer = Viewer(self).open("test")
            self.assertTrue(viewer.session.start_recording(self.path("out" + ending)))
            recorder = viewer.session.recorder
            viewer.wait(lambda recorder=recorder: recorder.frames > 3)
            viewer.session.close()
            self.assertEqual(len(support.read_video(self.path("out" + ending))), recorder.frames)

    def test_a_recording_replaces_nothing(self):
        clip = self.clip(60)
        with open(clip, "rb") as file:
            content = file.read()
        other = self.path("other.mkv")
        shutil.copy(clip, other)
        viewer = Viewer(self).open(clip)
        for path in (clip, other):
            self.assertFalse(viewer.session.start_recording(path))
            self.assertIn("exists" if path == other else "is played", viewer.told[-1].text)
        viewer.session.overwrite = True
        self.assertFalse(viewer.session.start_recording(clip))
        os.symlink(clip, self.path("link.mkv"))
        self.assertFalse(viewer.session.start_recording(self.path("link.mkv")))
        self.assertTrue(viewer.session.start_recording(other))
        viewer.wait(lambda: viewer.session.recorder is None or viewer.session.recorder.frames > 3)
        for path in (clip, other):  # until the new one is whole
            with open(path, "rb") as file:
                self.assertEqual(file.read(), content)
        viewer.session.stop_recording()
        self.assertGreater(len(support.read_video(other)), 3)
        self.assertEqual(sorted(os.listdir(self.folder)), ["clip.mkv", "link.mkv", "other.mkv"])

    def test_what_was_recorded_before_a_crash_plays(self):
        for ending in (".mkv", ".mp4"):
            if ending == ".mp4" and not (Gst.ElementFactory.find("openh264enc") or Gst.ElementFactory.find("x264enc")):
                continue
            viewer = Viewer(self).open("test")
            self.assertTrue(viewer.session.start_recording(self.path("out" + ending)))
            viewer.wait(lambda viewer=viewer: viewer.session.recorder.frames > 90)
            support.pump(1)
            shutil.copy(self.path("out.part" + ending), self.path("crashed" + ending))  # as the disk has it then
            viewer.session.close()
            self.assertGreater(support.count_frames(self.path("crashed" + ending)), 20)
            self.assertGreater(support.count_frames(self.path("out" + ending)), 90)

    def test_a_full_disk_and_folders_that_are_missing(self):
        viewer = Viewer(self).open("test")
        self.assertFalse(viewer.session.start_recording(self.path("none/out.mkv")))
        self.assertFalse(viewer.session.start_recording(self.path("out.xyz")))
        self.assertIn("another folder", viewer.told[0].text)
        self.assertIn(".mkv", viewer.told[1].text)
        os.symlink("/dev/full", self.path("full.mkv"))
        viewer.session.start_recording(self.path("full.mkv"))
        viewer.wait(lambda: len(viewer.session.troubles) == 3)
        self.assertIn("disk is full", viewer.session.troubles[-1].text)
        shown = len(viewer.times)
        viewer.wait(lambda: len(viewer.times) > shown + 10)  # the video goes on
        self.assertEqual(viewer.player.state, playback.PLAYING)

    def test_snapshot(self):
        viewer = Viewer(self)
        self.assertFalse(viewer.session.snapshot(self.path("a.png")))
        viewer.open(self.clip(5)).ends()
        self.assertTrue(viewer.session.snapshot(self.path("a.png")))
        self.assertFalse(viewer.session.snapshot(self.path("none/a.png")))
        self.assertIn("another folder", viewer.told[-1].advice)
        frame = support.read_video(self.path("a.png"))[0]
        self.assertEqual((frame[1].get_value("width"), frame[1].get_value("height")), (160, 120))


class Projects(support.Case):
    def test_one_of_somebody_else_runs_and_writes_nothing(self):
        """Until it is allowed, which is remembered."""
        victim = self.path("written")
        writes = f"tee name=t t. ! queue ! identity t. ! queue ! filesink location={victim}"
        for number, data in enumerate((
                {"source": f"videotestsrc num-buffers=3 ! tee name=t t. ! queue ! filesink location={victim} t. ! queue"},
                {"source": "test", "editors": [{"element": "intrinsicedit", "properties": {"effect": writes}}]},
                {"source": "test", "decomposer": {"element": "intrinsicdecomp", "properties": {"scene::location": victim + ".ply"}}},
                {"source": "http://127.0.0.1:9/x.mkv"})):
            with open(self.path("p.json"), "w", encoding="utf-8") as file:
                json.dump({"version": 1, **data}, file)
            viewer, asked = Viewer(self), []
            before = viewer.session.project
            viewer.session.load(self.path("p.json"))
            self.assertEqual((viewer.session.project, viewer.player.state), (before, playback.CLOSED))
            self.assertIn("p.json was not opened: it ", viewer.told[-1].text)
            self.assertEqual(os.path.exists(victim), False)
            if number:
                continue
            for _ in range(2):
                viewer.session.ask = lambda name, demands, asked=asked: asked.append((name, demands)) or True
                viewer.session.load(self.path("p.json"))
                viewer.wait(lambda: os.path.exists(victim))
                viewer.session.close()
                os.unlink(victim)
                viewer = Viewer(self)
            self.assertEqual([name for name, _ in asked], ["p.json"])

    def test_everything_that_was_done_comes_again(self):
        path = self.clip(20)
        viewer = Viewer(self).open(path)
        viewer.session.add_editor("intrinsicrecolor", GREEN)
        viewer.session.set_split(0.25)
        self.assertTrue(viewer.session.save(self.path("p.json")))
        self.assertFalse(viewer.session.save(self.path("none/p.json")))
        other = Viewer(self)
        other.session.load(self.path("p.json"))
        other.wait(lambda: other.is_green(RED))
        self.assertEqual(other.session.project, viewer.session.project)
        with open(self.path("p.json"), "w", encoding="utf-8") as file:
            json.dump({"version": 9}, file)
        before = other.session.project
        other.session.load(self.path("p.json"))
        self.assertEqual(other.session.project, before)
        self.assertIn("version", other.told[-1].text)
        for path, reason in (("none.json", "there is no file"), ("", "is a folder")):
            other.session.load(self.path(path))
            self.assertIn(reason, other.told[-1].text)
            self.assertNotIn("Errno", other.told[-1].text)
        self.assertEqual(other.session.project, before)

    def test_unsaved_edits_outlive_a_crash(self):
        clip = self.clip(20)
        program = ("import os, sys; sys.path[:0] = sys.argv[1:2]; import inverse_play; from gi.repository import Gst; Gst.init(None)\n"
                   "from inverse_play import project, session\n"
                   "made = session.Session(None, None, project.Project(source=sys.argv[2]))\n"
                   "made.add_editor('intrinsicrecolor', {'key': '0xff102030'}); made.add_editor('intrinsictone')\n"
                   "made.undo() if sys.argv[3] == 'undo' else None\n"
                   "made.save(sys.argv[4]) if sys.argv[3] == 'save' else None\n"
                   "os.kill(os.getpid(), 9)")
        for what, editors in (("", 2), ("undo", 1), ("save", None)):
            done = subprocess.run([sys.executable, "-c", program, support.PLAYER, clip, what, self.path("p.json")], check=False)
            self.assertEqual(done.returncode, -9)
            left = autosave.left()
            self.assertEqual(len(left), 0 if editors is None else 1)
            if editors is None:
                continue
            self.assertIn("clip.mkv (", autosave.title(left[0]))
            viewer = Viewer(self)
            viewer.session.load_unsaved(left[0])
            viewer.wait(lambda viewer=viewer: viewer.player.width > 0)
            self.assertEqual((viewer.session.project.source, len(viewer.session.project.editors)), (clip, editors))
            self.assertEqual(autosave.left(), [])  # it is unsaved in this run again
            viewer.session.save(self.path("p.json"))
            viewer.session.close()

    def test_undo_opens_the_source_before(self):
        first, second = self.clip(10, "a.mkv"), self.clip(10, "b.mkv", size=(80, 60))
        viewer = Viewer(self).open(first)
        viewer.open(second)
        viewer.wait(lambda: viewer.player.width == 80)
        viewer.session.undo()
        viewer.wait(lambda: viewer.player.width == 160)
        viewer.session.redo()
        viewer.wait(lambda: viewer.player.width == 80)

    def test_the_split_view_while_playing(self):
        viewer = Viewer(self).open("test")
        for _ in range(10):
            viewer.session.set_split(0.5)
            support.pump(0.1)
            viewer.session.set_split(None)
            support.pump(0.05)
        shown = len(viewer.times)
        viewer.wait(lambda: len(viewer.times) > shown + 5)
        self.assertEqual(viewer.told, [])

    def test_strokes_that_an_element_drew_can_be_undone(self):
        viewer = Viewer(self).open("test")
        viewer.session.use_tool(mouse="shading")
        pad = viewer.player.stage.mouse_pad
        for kind, x in (("mouse-button-press", 100.0), ("mouse-move", 150.0), ("mouse-button-release", 150.0)):
            fields = f'application/x-gst-navigation, event=(string){kind}, button=(int)1, pointer_x=(double){x}, ' \
                     'pointer_y=(double)80.0'
            event = Gst.Event.new_navigation(Gst.Structure.from_string(fields)[0])
            pad.send_event(event)
        viewer.wait(lambda: viewer.session.project.decomposer.get("strokes::list"))
        stroke = json.loads(viewer.session.project.decomposer.get("strokes::list"))
        self.assertIn("shading", str(stroke))
        viewer.session.undo()
        self.assertEqual(project.to_data(viewer.session.project)["decomposer"]["properties"], {})


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: LGPL-2.1-or-later
"""inverse-transcode as it is started: what it writes, what it says, and its exit status."""
import filecmp
import json
import os
import shutil
import signal
import struct
import subprocess
import sys
import unittest

from case import LIMIT, ROOT, VIDEO, Case, Gst, streams_of

sys.path.insert(0, str(ROOT / "transcode"))
from inverse_transcode import matroska  # noqa: E402
from inverse_transcode.plan import Settings, Task  # noqa: E402


class Texts(unittest.TestCase):
    def test_as_gstreamer_escapes_them(self):
        for text in ("Film Ü", 'a "quoted\\ one"', "plain", " ", '"', "two\nlines, 101 %"):
            escaped = Gst.value_serialize(text).encode()
            self.assertEqual(matroska.plain(escaped).decode(), text, escaped)


class Transcode(Case):
    def test_sound_is_copied(self):
        for sound in ("vorbisenc", "opusenc", "flacenc"):
            with self.subTest(sound):
                clip = self.clip(sound=sound)
                self.run_it(clip, "-o", "out.mkv", "--again")
                (video, copy), _ = streams_of(self.path("out.mkv"))
                self.assertEqual(video.packets, 12)
                original = next(s for s in streams_of(clip)[0] if s.name.startswith("audio/"))
                self.assertGreater(copy.packets, 2)
                self.assertEqual(copy.hash.digest(), original.hash.digest())

    def test_sound_that_a_container_does_not_take_is_encoded(self):
        self.clip(sound="flacenc")
        self.assertIn("webm takes no audio/x-flac: it is encoded as opus", self.run_it("clip.mkv", "-o", "out.webm"))
        self.assertEqual([s.name for s in streams_of(self.path("out.webm"))[0]], ["video/x-vp8", "audio/x-opus"])

    def test_a_pipeline_that_stands_still_is_given_up(self):
        task = Task(self.clip(), self.path("out.mkv")).as_json(Settings("valve drop=true", "mkv"))
        program = "import inverse_transcode.worker as w; w.STILL_SECONDS = 2; w.main()"
        worker = subprocess.Popen([sys.executable, "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                                  env={**os.environ, "PYTHONPATH": str(ROOT / "transcode")})
        self.addCleanup(worker.wait)
        worker.stdin.write(json.dumps(task) + "\n")
        worker.stdin.flush()
        self.assertIn("nothing has moved for 2 s, 0 frames out of the elements", worker.stdout.read())
        worker.stdout.close()
        worker.stdin.close()

    def test_no_sound(self):
        self.clip(sound="vorbisenc")
        self.run_it("clip.mkv", "-o", "out.mkv", "--audio", "none")
        self.assertEqual([s.name for s in streams_of(self.path("out.mkv"))[0]], ["video/x-vp8"])

    def test_more_than_8_bits_are_kept(self):
        self.need("vp9enc")
        deep = "vp9enc deadline=1 cpu-used=8"
        self.clip(form="I420_10LE", codec=deep, frames=6)
        self.run_it("clip.mkv", "-o", "out.mkv")
        (video,), _ = streams_of(self.path("out.mkv"))
        self.assertEqual(video.caps.get_structure(0).get_uint("bit-depth-luma").value, 10)

    def test_subtitles_and_title_are_kept(self):
        self.need("capssetter")
        with open(self.path("words.srt"), "w", encoding="utf-8") as words:
            words.write("1\n00:00:00,100 --> 00:00:00,300\n<i>Words</i> & more\n")
        self.make("clip.mkv", VIDEO.format(frames=12, form="I420") + "vp8enc deadline=1 ! taginject name=tags ! queue ! mux. "
                  f"filesrc location={self.path('words.srt')} ! subparse ! queue ! mux. matroskamux name=mux", tags={"tags": 'title="Film Ü, 2"'})
        matroska.mend_tags(self.path("clip.mkv"))
        self.run_it("clip.mkv", "-o", "out.mkv")
        streams, tags = streams_of(self.path("out.mkv"))
        self.assertEqual([s.name for s in streams], ["video/x-vp8", "text/x-raw"])
        self.assertEqual(streams[1].packets, 1)
        self.assertEqual(tags["title"], "Film Ü, 2")

    def test_an_odd_size_that_is_cut_is_told_of(self):
        self.need("openh264enc", "mp4mux")
        self.make("clip.mkv", "videotestsrc num-buffers=6 ! video/x-raw,width=161,height=121 ! vp8enc deadline=1 ! matroskamux")
        self.assertIn("h264 has 160x120 pixels of 161x121", self.run_it("clip.mkv", "-o", "out.mp4", "--", "identity"))
        self.assertNotIn("pixels of", self.run_it("clip.mkv", "-o", "out.webm", "--", "identity"))

    def test_rotation(self):
        self.need("openh264enc", "mp4mux")
        clip = self.make("clip.mp4", VIDEO.format(frames=6, form="I420") + "openh264enc ! h264parse ! mp4mux")
        with open(clip, "rb") as file:
            whole = file.read()
        matrix = whole.index(b"tkhd") + 4 + 40
        turned = struct.pack(">9i", 0, 1 << 16, 0, -1 << 16, 0, 0, 0, 0, 1 << 30)
        with open(clip, "wb") as file:
            file.write(whole[:matrix] + turned + whole[matrix + len(turned):])
        self.assertEqual(streams_of(clip)[1]["image-orientation"], "rotate-90")
        self.run_it("clip.mp4", "-o", "out.mkv", "--", "identity")
        (video,), tags = streams_of(self.path("out.mkv"))
        size = video.caps.get_structure(0)
        self.assertEqual((size.get_int("width").value, size.get_int("height").value), (120, 160))
        self.assertIn(tags.get("image-orientation", "rotate-0"), "rotate-0")

    def test_layers_are_streams(self):
        self.clip(sound="vorbisenc")
        self.run_it("clip.mkv", "-o", "out.mkv", "--layers", "input,reflectance,shading", "--", "intrinsicdecomp")
        streams, _ = streams_of(self.path("out.mkv"))
        self.assertEqual([s.packets for s in streams[:3]], [12, 12, 12])
        self.assertEqual(len({s.hash.digest() for s in streams[:3]}), 3)
        self.assertEqual(streams[3].name, "audio/x-vorbis")
        with open(self.path("out.mkv"), "rb") as file:
            tags = file.read()[-600:]
        for title in (b"input", b"reflectance", b"shading"):
            self.assertIn(title, tags)

    def test_layers_where_the_muxer_waits_for_each_stream(self):
        self.need("openh264enc", "mp4mux", "qtmux")
        self.clip(frames=40)
        for words in (["out.mp4"], ["out.mov", "--video", "mjpeg"]):
            with self.subTest(words):
                self.run_it("clip.mkv", "-o", *words, "--layers", "reflectance,shading", "--", "intrinsicdecomp")
                self.assertEqual([s.packets for s in streams_of(self.path(words[0]))[0]], [40, 40])

    def test_numbered_pictures(self):
        self.clip(sound="vorbisenc")
        self.assertIn("png takes no audio/x-vorbis: it is left out", self.run_it("clip.mkv", "-o", "frames", "--to", "png"))
        self.assertEqual(sorted(os.listdir(self.path("frames"))), [f"{n:06}.png" for n in range(12)])
        self.run_it("frames/%06d.png", "-o", "back.mkv", "--rate", "24000/1001", "--", "identity")
        (video,), _ = streams_of(self.path("back.mkv"))
        self.assertEqual(video.packets, 12)
        rate = video.caps.get_structure(0).get_fraction("framerate")
        self.assertEqual((rate.value_numerator, rate.value_denominator), (24000, 1001))
        # Into the folder that is there, only if asked.
        words = ["clip.mkv", "-o", "frames", "--to", "jpg", "--layers", "reflectance,shading"]
        self.run_it(*words, "--", "intrinsicdecomp")
        self.assertIn("000000.png", os.listdir(self.path("frames")))
        self.run_it(*words, "--again", "--", "intrinsicdecomp")
        self.assertEqual(sorted(os.listdir(self.path("frames"))), ["reflectance", "shading"])
        self.assertEqual(len(os.listdir(self.path("frames/shading"))), 12)
        self.run_it("clip.mkv", "-o", "alone", "--to", "jpg", "--layers", "reflectance", "--", "intrinsicdecomp")
        self.assertTrue(filecmp.cmp(self.path("frames/reflectance/000000.jpg"), self.path("alone/reflectance/000000.jpg"), shallow=False))
        os.mkdir(self.path("50% of it"))
        shutil.copytree(self.path("frames/shading"), self.path("50% of it/frames"))
        for said in ("done", "present"):  # named after their folder
            self.assertIn(f"{said}", self.run_it("50% of it/frames/%06d.jpg", "--out", "results", "--", "identity"))
        self.assertEqual(os.listdir(self.path("results")), ["frames.mkv"])
        os.unlink(self.path("frames/shading/000004.jpg"))
        self.assertIn("is missing (1 in all)", self.run_it("frames/shading/%06d.jpg", status=1))
        self.assertIn("there are no such pictures", self.run_it("frames/%03d.png", status=1))

    def test_version_is_that_of_the_elements(self):
        wanted = (ROOT / "VERSION").read_text(encoding="utf-8").strip()
        self.assertEqual(self.run_it("--version"), f"inverse-transcode {wanted}\n")

    def test_a_cut_file_is_a_warning(self):
        self.clip(frames=120, codec="jpegenc")
        with open(self.path("clip.mkv"), "r+b") as file:
            file.truncate(os.path.getsize(self.path("clip.mkv")) // 2)
        self.assertIn("it may be damaged", self.run_it("clip.mkv", "-o", "out.mkv", "--", "identity"))

    def test_any_names(self):
        name = "a clip, 100 % \u00fc & #1?\nof two lines.mkv"
        shown = name.replace("\n", r"\n")
        self.clip(name)
        self.assertEqual(self.run_it(name, "--dry-run").splitlines(), [f"{shown} -> out/transcode/{shown}"])
        self.run_it(name, "-o", "its paint.mkv")
        self.assertEqual(streams_of(self.path("its paint.mkv"))[0][0].packets, 12)
        odd = os.fsdecode(b"no \xff UTF-8.mkv")
        shutil.copy(self.path(name), self.path(odd))
        self.run_it(odd, "--out", "results", "--dry-run")
        self.run_it(odd, "--out", "results", "--report", "report.json", "--", "identity")
        self.assertEqual(os.listdir(self.path("results")), [odd])

    def test_a_folder_goes_on_where_it_was(self):
        self.clip("day one/a.mkv", sound="vorbisenc")
        self.clip("day one/deep/b.mkv")
        for name, text in (("broken.mp4", "this is no video"), ("empty.mp4", ""), ("notes.txt", "not tried")):
            with open(self.path("day one/" + name), "w", encoding="utf-8") as file:
                file.write(text)
        words = ["--jobs", "2", "--out", "results", "--report", "report.json", "day one"]
        said = self.run_it(*words, status=1)
        self.assertIn("2 done, 0 already there, 2 failed", said)
        self.assertIn("empty.mp4: it is empty", said)
        with open(self.path("report.json"), encoding="utf-8") as file:
            report = json.load(file)
        self.assertEqual(report["counts"], {"done": 2, "failed": 2})
        first = self.path("results/day one/a.mkv")
        before = os.path.getmtime(first)
        os.unlink(self.path("results/day one/deep/b.mkv"))
        os.unlink(self.path("day one/broken.mp4"))
        os.unlink(self.path("day one/empty.mp4"))
        self.assertIn("1 done, 1 already there, 0 failed", self.run_it(*words))
        self.assertEqual(os.path.getmtime(first), before)
        self.assertEqual(streams_of(self.path("results/day one/deep/b.mkv"))[0][0].packets, 12)
        # Results below the folder named are no inputs.
        self.assertEqual(len(self.run_it("day one", "day one", "--dry-run", "--out", "day one/deep").splitlines()), 1)

    def test_two_inputs_of_one_output(self):
        self.clip("in/a.mkv")
        shutil.copy(self.path("in/a.mkv"), self.path("in/a.webm"))
        said = self.run_it("in", "--out", "out", status=1)
        self.assertIn("its output would replace that of in/a.mkv", said)
        self.assertIn("1 done, 0 already there, 1 failed", said)

    def test_what_cannot_be(self):
        self.clip()
        os.mkfifo(self.path("pipe"))
        os.mkdir(self.path("other"))
        with open(self.path("other/notes"), "w", encoding="utf-8") as file:
            file.write("to be kept")
        for words, text, status in (
            (["clip.mkv", "-o", "clip.mkv"], "its output would replace an input", 1),
            (["clip.mkv", "none.mkv", "--dry-run", "--out", "."], "its output would replace an input", 1),
            (["clip.mkv", "-o", ".", "--to", "png", "--again"], "its output would replace an input", 1),
            (["clip.mkv", "-o", "other", "--to", "png", "--again"], "no folder of numbered pictures alone", 1),
            (["clip.mkv", "-o", "pipe", "--to", "png", "--again"], "no folder of numbered pictures alone", 1),
            (["clip.mkv", "-o", "x.mp4", "--to", "mkv"], "does not end in .mkv", 2),
            (["clip.mkv", "--video-options", "nosuch=3"], "--video-options takes properties of the encoder", 2),
            (["clip.mkv", "--video-options", "cq-level=999"], "out of range", 2),
            (["clip.mkv", "-o", "x.mkv", "identity", "silent=true"], "elements go after --", 2),
            (["clip.mkv", "-o", "x.webm", "--audio", "flac"], "webm does not take the audio codec flac; it takes", 2),
            (["clip.mkv", "-o", "x.png"], "to a folder of numbered pictures", 2),
            (["clip.mkv", "--", "videocrop", "left=1000"], "check caps and sizes", 1),
            (["clip.mkv", "-o", "x", "--to", "png", "--video", "vp8"], "--video is for files of video, not for png", 2),
            (["clip.mkv", "-o", "x", "--to", "jpg", "--hardware"], "--hardware is for files of video, not for jpg", 2),
            (["clip.mkv", "-o", "x", "--to", "exr", "--audio", "opus"], "--audio is for files with sound, not for exr", 2),
            (["clip.mkv", "-o", "x.mkv", "--bits", "16"], "--bits is for png, not for mkv", 2),
            (["clip.mkv", "--report", "none/report.json"], "the report cannot be written", 2),
            (["clip.mkv", "-o", "x.webm", "--video", "ffv1"], "webm does not take the video codec ffv1; it takes", 2),
            (["clip.mkv", "-o", "x.mkv", "--overlap", "2"], "--overlap needs --chunk", 2),
            (["intrinsicdecomp", "show=shading"], "elements go after --", 1),
            (["none.mkv"], "there is no such file", 1),
            (["clip.mkv", "-o", "out.txt"], "there is no container 'txt'", 2),
            (["clip.mkv", "--", "nosuchelement"], "nosuchelement", 2),
            (["clip.mkv", "-o", "clip.mkv/out.mkv"], "cannot write to clip.mkv", 1),
            (["clip.mkv", "--layers", "../nosuch", "--", "intrinsicdecomp"], "there is no layer '../nosuch'", 2),
            (["clip.mkv", "--", "intrinsicdecomp", "!", "fakesink"], "fakesink", 2),
            (["clip.mkv", "--", "identity", "error-after=3"], "identity", 1),
        ):
            with self.subTest(words):
                self.assertIn(text, self.run_it(*words, status=status))
        self.assertFalse(os.path.exists(self.path("out/transcode/clip.mkv")))
        self.assertEqual(os.listdir(self.path("other")), ["notes"])

    def test_an_effect_on_a_layer(self):
        self.clip(frames=6)
        self.run_it("clip.mkv", "-o", "out.mkv", "--", 'intrinsicedit layer=shading effect="videobalance contrast=1.2"')
        self.assertEqual(streams_of(self.path("out.mkv"))[0][0].packets, 6)

    def test_dry_run_writes_nothing(self):
        self.clip()
        self.assertIn("clip.mkv -> out/transcode/clip.mkv", self.run_it("clip.mkv", "--dry-run"))
        self.assertFalse(os.path.exists(self.path("out")))

    def test_a_stop_leaves_a_whole_file(self):
        self.clip(frames=600, sound="vorbisenc")
        process = self.start("clip.mkv", "-o", "out.mkv")
        self.wait_for_part()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=LIMIT)
        self.assertEqual(process.returncode, 130, errors)
        self.assertIn("is in ", errors)
        self.assertFalse(os.path.exists(self.path("out.mkv")))
        video, sound = streams_of(self.path("out.partial.mkv"))[0]
        self.assertTrue(0 < video.packets < 600, video.packets)
        original = next(s for s in streams_of(self.path("clip.mkv"))[0] if s.name.startswith("audio/"))
        self.assertAlmostEqual(sound.packets / original.packets, video.packets / 600, delta=0.05)

    def test_a_worker_that_is_killed_leaves_nothing(self):
        self.clip(frames=600)
        process = self.start("clip.mkv", "-o", "out.mkv")
        self.wait_for_part()
        workers = subprocess.run(["pgrep", "-P", str(process.pid), "-f", "worker"], stdout=subprocess.PIPE, text=True, check=True)
        os.kill(int(workers.stdout.split()[0]), signal.SIGKILL)
        _, errors = process.communicate(timeout=LIMIT)
        self.assertEqual(process.returncode, 1)
        self.assertIn("its process ended (SIGKILL)", errors)
        self.assertFalse(os.path.exists(self.path("out.mkv")))
        self.run_it("clip.mkv", "-o", "out.mkv", "--", "identity")  # what was left is removed
        self.assertEqual(streams_of(self.path("out.mkv"))[0][0].packets, 600)


if __name__ == "__main__":
    unittest.main(verbosity=2)

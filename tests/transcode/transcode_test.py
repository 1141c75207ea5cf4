# SPDX-License-Identifier: LGPL-2.1-or-later
"""inverse-transcode as it is started: what it writes, what it says, and its exit status."""
import filecmp
import json
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
import zlib

from case import Case, Gst, GstVideo, LIMIT, ROOT, SOUND, VIDEO, frames_of, streams_of, structure_of

sys.path.insert(0, str(ROOT / "transcode"))
from inverse_transcode import formats, marks, matroska  # noqa: E402
from inverse_transcode.gaps import Gaps  # noqa: E402
from inverse_transcode.plan import Settings, Task  # noqa: E402
from lists_in_files import Listed  # noqa: E402


class Texts(unittest.TestCase):
    def test_as_gstreamer_escapes_them(self):
        for text in ("Film Ü", 'a "quoted\\ one"', "plain", " ", '"', "two\nlines, 101 %"):
            escaped = Gst.value_serialize(text).encode()
            self.assertEqual(matroska.plain(escaped).decode(), text, escaped)


    def test_a_size_beyond_the_file_takes_no_memory(self):
        with tempfile.NamedTemporaryFile() as file:
            for name in ("18538067", "1254c367", "7373", "67c8", "4487"):
                file.write(bytes.fromhex(name) + b"\x01\x7f\xff\xff\xff\xff\xff\xff")
            file.write(b'"a\\ b"')
            file.flush()
            with unittest.mock.patch.object(matroska, "muxer_escapes", lambda: True):
                matroska.mend_tags(file.name)
            file.seek(0)
            self.assertTrue(file.read().endswith(b"a b\0\0\0"))


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
        self.assertEqual(structure_of(video.caps).get_uint("bit-depth-luma").value, 10)

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
        size = structure_of(video.caps)
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
        rate = structure_of(video.caps).get_fraction("framerate")
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

    def test_damaged_pictures_are_named_and_the_others_kept(self):
        head = struct.pack(">II", 60000, 60000)
        for ending, encoder in (("png", "pngenc"), ("jpg", "jpegenc")):
            self.make("x", VIDEO.format(frames=1, form="RGB") + f"videoconvert ! {encoder}")
            with open(self.path("x"), "rb") as file:
                whole = file.read()
            middle = len(whole) // 2
            large = whole[:16] + head + whole[24:29] + struct.pack(">I", zlib.crc32(whole[12:16] + head + whole[24:29])) + whole[33:]
            for wrong, why in ((b"", "it is empty"), (b"text, not a picture", "it is no image/"), (whole[:middle], "it is cut short"),
                               *([(whole[:middle] + bytes(40) + whole[middle + 40:], "its data is damaged"),
                                  (large, "it is 60000x60000")] if ending == "png" else [])):
                with self.subTest((ending, why)):
                    os.makedirs(self.path("in"), exist_ok=True)
                    for k in range(5):
                        with open(self.path(f"in/{k}.{ending}"), "wb") as file:
                            file.write(wrong if k == 2 else whole)
                    said = self.run_it(f"in/%d.{ending}", "-o", "out.mkv", "--again", "--", "identity")
                    self.assertIn(f"in/2.{ending} is left out: {why}", said)
                    self.assertNotIn("came out of", said)
                    self.assertEqual(streams_of(self.path("out.mkv"))[0][0].packets, 4)
            os.truncate(self.path(f"in/3.{ending}"), 20 << 30)
            self.assertRegex(self.run_it(f"in/%d.{ending}", "-o", "out.mkv", "--again", "--", "identity", status=1), f"in/3.{ending}: it has .* it is damaged")

    def test_version_is_that_of_the_elements(self):
        wanted = (ROOT / "VERSION").read_text(encoding="utf-8").strip()
        self.assertEqual(self.run_it("--version"), f"inverse-transcode {wanted}\n")

    def test_a_cut_file_is_a_warning(self):
        """Whatever encodes it: some encoders shift all times."""
        self.clip(frames=120, codec="jpegenc")
        with open(self.path("clip.mkv"), "r+b") as file:
            file.truncate(os.path.getsize(self.path("clip.mkv")) // 2)
        for words in (["out.mkv"], ["out.mp4"], ["out.mov"], ["h264.mkv", "--video", "h264"], ["ffv1.mkv", "--video", "ffv1"], ["vp9.mkv", "--video", "vp9"],
                      ["h265.mp4", "--video", "h265"], ["prores.mov", "--video", "prores"], ["av1.mkv", "--video", "av1"]):
            with self.subTest(words):
                try:
                    formats.video_encoder(words[2] if words[1:] else formats.CONTAINERS[words[0][4:]].video)
                except formats.FormatError:
                    continue  # is not installed
                self.assertIn("it may be damaged", self.run_it("clip.mkv", "-o", *words, "--", "identity"))

    def test_a_file_whose_sound_is_longer_is_not_damaged(self):
        for name, mux in (("tail.mkv", "matroskamux"), ("tail.mov", "qtmux"), ("tail.avi", "avimux")):
            with self.subTest(name):
                self.make(name, VIDEO.format(frames=30, form="I420") + "jpegenc ! queue ! mux. " + SOUND.format(buffers=140) + f"queue ! mux. {mux} name=mux")
                self.assertNotIn("damaged", self.run_it(name, "-o", name + ".mkv", "--", "identity"))

    def test_a_cut_avi_is_told_of(self):
        """The demuxer takes its length from what there is."""
        self.make("clip.avi", VIDEO.format(frames=60, form="I420") + "jpegenc ! avimux")
        os.truncate(self.path("clip.avi"), os.path.getsize(self.path("clip.avi")) * 6 // 10)
        self.assertRegex(self.run_it("clip.avi", "-o", "out.mkv", "--", "identity"), "its pictures end 0.[89] s before they should")

    def test_what_is_missing_in_the_middle_is_told_of(self):
        for name, line in (("clip.mkv", "vp8enc deadline=1 keyframe-max-dist=5 ! matroskamux"), ("clip.avi", "jpegenc ! avimux"),
                           ("clip.ogv", "theoraenc ! oggmux")):
            with self.subTest(name):
                self.make(name, VIDEO.format(frames=90, form="I420") + line)
                self.assertNotIn("damaged", self.run_it(name, "-o", "out.mkv", "--again", "--", "identity"))
                size = os.path.getsize(self.path(name))
                with open(self.path(name), "r+b") as file:
                    file.seek(size // 2)
                    file.write(bytes(size // 8))
                said = self.run_it(name, "-o", "out.mkv", "--again", "--", "identity")
                self.assertRegex(said, r"it has no pictures from 1\.\d+ to [12]\.\d+ s.*it may be damaged")

    def test_pictures_at_any_times_have_no_gaps(self):
        steady, other = Gaps(), Gaps()
        for k in range(100):
            steady.add(k * 33_333_333 + (k > 60) * 300_000_000)
            other.add(k * k * 5_000_000)
        self.assertEqual([round(end - begin, 2) for begin, end in steady.found()], [0.33])
        self.assertEqual((other.found(), Gaps().warning()), ([], ""))

    def test_a_fragmented_file_that_is_cut_is_told_of(self):
        self.need("openh264enc")
        self.make("clip.mp4", VIDEO.format(frames=90, form="I420") + "openh264enc gop-size=15 ! h264parse ! mp4mux fragment-duration=500 streamable=true")
        self.assertNotIn("damaged", self.run_it("clip.mp4", "-o", "out.mkv", "--again", "--", "identity"))
        os.truncate(self.path("clip.mp4"), os.path.getsize(self.path("clip.mp4")) * 6 // 10)
        self.assertIn("it may be damaged", self.run_it("clip.mp4", "-o", "out.mkv", "--again", "--", "identity"))

    def test_the_last_box_of_a_file(self):
        head = struct.pack(">I4s4s4x", 16, b"ftyp", b"isom")
        for rest, cut in ((struct.pack(">I4s", 8, b"free"), False), (struct.pack(">I4s", 9, b"free"), True), (struct.pack(">I4sQ", 1, b"mdat", 0), False),
                          (struct.pack(">I4sQ", 1, b"mdat", 99), True), (struct.pack(">I4s", 0, b"mdat") + bytes(99), False), (b"\0\0\0", True)):
            with open(self.path("a.mp4"), "wb") as file:
                file.write(head + rest)
            self.assertEqual(marks.ends_inside(self.path("a.mp4")), cut, rest)

    def test_a_transport_stream_whose_clock_begins_late_is_whole(self):
        self.need("openh264enc", "mpegtsmux")
        self.make("clip.ts", VIDEO.format(frames=30, form="I420").replace("videotestsrc", "videotestsrc timestamp-offset=1400000000") +
                  "openh264enc ! h264parse ! mpegtsmux")
        self.assertNotIn("damaged", self.run_it("clip.ts", "-o", "out.mkv", "--", "identity"))

    def test_what_hdr_says_of_its_display_is_told_of_where_it_is_lost(self):
        self.make("clip.mkv", VIDEO.format(frames=3, form="I420_10LE") + "capssetter caps=\"video/x-raw,colorimetry=bt2100-pq,"
                  "mastering-display-info=34000:16000:13250:34500:7500:3000:15635:16450:10000000:50\" ! avenc_ffv1 ! matroskamux")
        for words, lost in ((("mov", "--video", "prores"), True), (("mkv", "--video", "ffv1"), False)):
            said = self.run_it("clip.mkv", "-o", f"out.{words[0]}", *words[1:], "--again", "--", "identity")
            self.assertEqual("what HDR says of its display (mastering-display-info) is left out" in said, lost, said)

    def test_the_shape_of_pixels_that_matroska_rounds_is_told_of(self):
        for shape, told in (("16/11", True), ("2/1", False)):
            self.make("clip.mov", VIDEO.format(frames=3, form="I422_10LE") +
                      f"capssetter caps=video/x-raw,pixel-aspect-ratio={shape} ! avenc_prores_ks ! qtmux")
            self.assertEqual("rounded" in self.run_it("clip.mov", "-o", "out.mkv", "--again", "--", "identity"), told, shape)

    def test_a_cut_file_without_lengths_is_told_of(self):
        self.need("theoraenc", "openh264enc", "mpegtsmux")
        for name, line in (("clip.ogv", "theoraenc ! oggmux"), ("clip.ts", "openh264enc ! h264parse ! mpegtsmux"),
                           ("clip.m2ts", "openh264enc ! h264parse ! mpegtsmux m2ts-mode=true")):
            with self.subTest(name):
                self.make(name, VIDEO.format(frames=30, form="I420") + line)
                self.assertNotIn("damaged", self.run_it(name, "-o", "out.mkv", "--again", "--", "identity"))
                os.truncate(self.path(name), os.path.getsize(self.path(name)) * 6 // 10 // 188 * 188 + 100)
                self.assertIn("it has no end: it may be damaged", self.run_it(name, "-o", "out.mkv", "--again", "--", "identity"))

    def pictures(self, *lines, folder="in"):
        """Numbered PNG pictures, one of each line."""
        os.makedirs(self.path(folder))
        for number, line in enumerate(lines):
            self.make(f"{folder}/{number:04}.png", f"videotestsrc num-buffers=1 {line} ! pngenc")
        return f"{folder}/%04d.png"

    def test_pictures_that_change_their_format_or_size(self):
        """Become what the first one is, where a muxer takes one format and size; a folder of pictures keeps them."""
        color, gray = "pattern=smpte ! video/x-raw,format=RGB,width=160,height=120", "pattern=ball ! video/x-raw,format=GRAY8,width=160,height=120"
        large = "pattern=ball ! video/x-raw,format=RGB,width=208,height=160"
        for name, lines in (("gray", (color, gray, color)), ("size", (color, large, color)), ("first", (gray, color))):
            pattern = self.pictures(*lines, folder=name)
            for words in (["mkv"], ["webm"], ["mp4"], ["mkv", "--video", "ffv1"], ["mkv", "--video", "mjpeg"]):
                with self.subTest((name, words)):
                    said = self.run_it(pattern, "-o", f"out.{words[0]}", "--again", *words[1:], "--", "identity")
                    frames = frames_of(self.path(f"out.{words[0]}"))
                    self.assertEqual(len(frames), len(lines))
                    self.assertEqual({(caps.get_value("width"), caps.get_value("height")) for caps, _ in frames}, {(160, 120)})
                    self.assertEqual("change from 160x120 to 208x160" in said, name == "size", said)
        self.run_it("size/%04d.png", "-o", "kept", "--to", "png", "--", "identity")
        (caps, _), = frames_of(self.path("kept/000001.png"))
        self.assertEqual(caps.get_value("width"), 208)

    def test_without_loss_is_without_loss(self):
        """Colors and alpha of RGB pictures through ffv1."""
        self.need("avenc_ffv1")
        for form in ("RGB", "RGBA", "GRAY8"):
            with self.subTest(form):
                line = f"pattern=smpte ! video/x-raw,format={form},width=64,height=48"
                said = self.run_it(self.pictures(line, folder=form), "-o", f"{form}.mkv", "--video", "ffv1", "--", "identity")
                self.assertNotIn("warning", said)
                (before, one), = frames_of(self.path(f"{form}/0000.png"))
                (after, other), = frames_of(self.path(f"{form}.mkv"))
                order, other_order = before.get_value("format"), after.get_value("format")
                if form == "GRAY8":
                    self.assertEqual((other_order, other), ("GRAY8", one))
                    continue
                places = [other_order.index(c) for c in order.replace("x", "")]
                pixels = [tuple(other[4 * k + place] for place in places) for k in range(64 * 48)]
                self.assertEqual(pixels, [tuple(one[len(order) * k:len(order) * (k + 1)]) for k in range(64 * 48)])

    def test_what_a_codec_does_not_hold_is_told(self):
        rgba = self.pictures("! video/x-raw,format=RGBA,width=160,height=120", folder="rgba")
        for words, texts in ((["vp8"], ("transparency is left out, since vp8", "color of 4:2:0, the input 4:4:4 (RGB)")),
                             (["mjpeg"], ("transparency is left out, since mjpeg",))):
            said = self.run_it(rgba, "-o", "out.mkv", "--again", "--video", *words, "--", "identity")
            for text in texts:
                self.assertEqual(said.count(text), 1, said)
        self.clip("deep.mkv", form="I420_10LE", codec="vp9enc deadline=1 cpu-used=8", frames=6)
        self.assertIn("vp8 has 8 bits a sample, the input 10", self.run_it("deep.mkv", "-o", "out.mkv", "--again", "--video", "vp8", "--", "identity"))
        self.clip()
        self.assertNotIn("warning", self.run_it("clip.mkv", "-o", "out.mkv", "--again"))

    def test_interlaced_video_of_more_than_8_bits(self):
        self.need("avenc_ffv1")
        for form, depth in (("I420", 8), ("I420_10LE", 10), ("I422_10LE", 10)):
            with self.subTest(form):
                self.make("fields.mkv", f"videotestsrc num-buffers=6 ! video/x-raw,format={form},width=160,height=120,framerate=25/1,"
                          "interlace-mode=interleaved,field-order=top-field-first ! avenc_ffv1 ! matroskamux")
                self.run_it("fields.mkv", "-o", "out.mkv", "--again", "--video", "ffv1", "--", "intrinsicdecomp", "show=input")
                frames = frames_of(self.path("out.mkv"))
                self.assertEqual(len(frames), 6)
                self.assertEqual(frames[0][0].get_value("interlace-mode"), "progressive")
                self.assertGreaterEqual(GstVideo.VideoFormat.get_info(GstVideo.VideoFormat.from_string(frames[0][0].get_value("format"))).depth[0], depth)

    def test_the_top_field_is_kept_exactly(self):
        try:
            import numpy
            from inverse_transcode import pictures
        except ImportError as problem:
            self.skipTest(str(problem))
        pixels = numpy.arange(5 * 2 * 4, dtype="<u2").reshape(5, 2, 4) * 1600
        for height in (5, 4, 1):
            part = pixels[:height]
            made = numpy.frombuffer(pictures.FieldEncoder.encode(unittest.mock.Mock(mixed=False), part, None), "<u2").reshape(part.shape)
            self.assertTrue((made[0::2] == part[0::2]).all())
            for row in range(1, height, 2):
                below = part[row + 1] if row + 1 < height else part[row - 1]
                self.assertTrue((made[row] == (part[row - 1].astype(int) + below + 1) // 2).all())

    def test_streams_that_nothing_decodes_are_left_out(self):
        clip = self.clip(sound="opusenc")
        with open(clip, "rb") as file:
            content = file.read()
        self.assertEqual(content.count(b"A_OPUS"), 1)
        with open(self.path("odd.mkv"), "wb") as file:
            file.write(content.replace(b"A_OPUS", b"A_ODDS"))
        for words in ([], ["--audio", "none"], ["--audio", "opus"]):
            with self.subTest(words):
                said = self.run_it("odd.mkv", "-o", "out.mkv", "--again", *words, "--", "identity")
                self.assertIn("a stream is left out", said)
                self.assertEqual([s.name for s in streams_of(self.path("out.mkv"))[0]], ["video/x-vp8"])
        with open(self.path("odd.mkv"), "wb") as file:
            file.write(content.replace(b"V_VP8", b"V_ODD"))
        self.assertIn("a plugin is missing", self.run_it("odd.mkv", "-o", "out.mkv", "--again", status=1))

    def test_styled_subtitles_are_copied(self):
        head = b"[Script Info]\nScriptType: v4.00+\n[V4+ Styles]\n[Events]\n"
        pipeline = Gst.parse_launch(VIDEO.format(frames=30, form="I420") + "vp8enc deadline=1 ! queue ! mux. appsrc name=words format=time ! mux.subtitle_0 "
                                    f"matroskamux name=mux ! filesink location={self.path('clip.mkv')}")
        words = pipeline.get_by_name("words")
        caps = Gst.Caps.from_string("application/x-ass")
        caps.set_value("codec_data", Gst.Buffer.new_wrapped(head))
        words.set_property("caps", caps)
        line = Gst.Buffer.new_wrapped(b"0,0,Default,,0,0,0,,{\\i1}Words{\\i0}")
        line.pts, line.duration = 100 * Gst.MSECOND, 200 * Gst.MSECOND
        words.emit("push-buffer", line)
        words.emit("end-of-stream")
        pipeline.set_state(Gst.State.PLAYING)
        pipeline.get_bus().timed_pop_filtered(LIMIT * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
        pipeline.set_state(Gst.State.NULL)
        self.run_it("clip.mkv", "-o", "out.mkv", "--", "identity")
        with open(self.path("out.mkv"), "rb") as file:
            content = file.read()
        for text in (b"S_TEXT/ASS", b"{\\i1}Words", head):
            self.assertIn(text, content)
        self.assertIn("the style and place of subtitles (ASS) is left out", self.run_it("clip.mkv", "-o", "out.mov", "--", "identity"))

    def test_what_a_container_does_not_say_of_pictures_is_told(self):
        self.make("clip.mkv", VIDEO.format(frames=12, form="I420") + "vp8enc deadline=1 ! "
                  "capssetter caps=\"video/x-vp8,multiview-mode=(string)side-by-side\" ! matroskamux")
        for container, told in (("mkv", False), ("mov", True)):
            self.assertEqual("stereo (side-by-side) is left out: mkv keeps it" in self.run_it("clip.mkv", "-o", f"out.{container}", "--", "identity"), told)

    def test_the_mastering_display_is_kept(self):
        self.need("vp9enc")
        self.make("clip.mkv", VIDEO.format(frames=3, form="I420_10LE") + "capssetter caps=\"video/x-raw,colorimetry=bt2100-pq,"
                  "mastering-display-info=34000:16000:13250:34500:7500:3000:15635:16450:10000000:50\" ! vp9enc ! matroskamux")
        matroska.mend_mastering(self.path("clip.mkv"), (1000, 0.005))
        self.run_it("clip.mkv", "-o", "out.mkv", "--", "identity")
        with open(self.path("out.mkv"), "rb") as file:
            content = file.read()
        for name, value in ((b"\x55\xd9", 1000), (b"\x55\xda", 0.005)):
            self.assertIn(name + b"\x88" + struct.pack(">d", value), content)
        self.need("x265enc")
        self.run_it("clip.mkv", "-o", "out.mp4", "--video", "h265", "--", "identity")
        with open(self.path("out.mp4"), "rb") as file:
            self.assertNotIn(b"x265 (build", file.read())  # with HDR this text has bytes that differ from run to run, and broke one in three

    def test_closed_captions_are_told_of(self):
        self.need("openh264enc", "h264parse")
        self.make("plain.h264", VIDEO.format(frames=12, form="I420") + "openh264enc ! h264parse ! video/x-h264,stream-format=byte-stream")
        with open(self.path("plain.h264"), "rb") as file:
            plain = file.read()
        captions = b"\0\0\1\x06\x04\x0e\xb5\0\x31GA94\x03\x41\xff\xfc\x94\x20\xff\x80"  # before the slice of each picture
        with open(self.path("captions.h264"), "wb") as file:
            file.write(re.sub(b"\0\0\1[\x41\x61\x65]", lambda found: captions + found[0], plain))
        for name, told in (("plain", False), ("captions", True)):
            self.assertEqual("closed captions in its pictures are left out" in self.run_it(f"{name}.h264", "-o", f"{name}.mkv", "--", "identity"), told)

    def test_chapters_of_mp4_are_told_of(self):
        def box(name, data):
            return struct.pack(">I4s", 8 + len(data), name) + data

        for moov, told in ((box(b"udta", box(b"chpl", bytes(9))), 1), (box(b"trak", box(b"tref", box(b"chap", bytes(4)))) * 2, 1), (box(b"udta", b""), 0)):
            with open(self.path("x.mp4"), "wb") as file:
                file.write(box(b"ftyp", b"isom\0\0\0\0isom") + box(b"moov", moov))
            self.assertEqual(len(marks.left_out(self.path("x.mp4"))), told)

    def test_the_title_of_a_track_is_not_that_of_the_file(self):
        pipeline = Gst.parse_launch(VIDEO.format(frames=12, form="I420") + "vp8enc deadline=1 ! queue ! mux. " + SOUND.format(buffers=12) +
                                    f"vorbisenc name=sound ! queue ! mux. matroskamux name=mux ! filesink location={self.path('named.mkv')}")
        tags = Gst.TagList.new_empty()
        tags.add_value(Gst.TagMergeMode.REPLACE, Gst.TAG_TITLE, "Comment")
        pipeline.get_by_name("sound").merge_tags(tags, Gst.TagMergeMode.REPLACE)
        pipeline.set_state(Gst.State.PLAYING)
        pipeline.get_bus().timed_pop_filtered(LIMIT * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
        pipeline.set_state(Gst.State.NULL)
        said = self.run_it("named.mkv", "-o", "out.mov", "--", "identity")
        self.assertIn("mov takes no title of a track from GStreamer: 'Comment' is left out", said)
        self.assertNotIn("title", streams_of(self.path("out.mov"))[1])

    def test_attachments_are_told_of(self):
        with open(self.clip(), "rb") as file:
            content = file.read()
        field = lambda name, data: name + struct.pack(">Q", 1 << 56 | len(data)) + data  # noqa: E731 (an element of EBML)
        font = field(b"\x61\xa7", field(b"\x46\x6e", b"letters.ttf") + field(b"\x46\x60", b"font/ttf") + field(b"\x46\x5c", b"no font") +
                     field(b"\x46\xae", b"\x01"))
        place = content.index(b"\x18\x53\x80\x67") + 4
        added = field(b"\x19\x41\xa4\x69", font)
        # Before the first cluster, so that it is read without a seek.
        cluster = content.index(b"\x1f\x43\xb6\x75")
        size = struct.unpack(">Q", content[place:place + 8])[0]
        with open(self.path("fonts.mkv"), "wb") as file:
            file.write(content[:place] + struct.pack(">Q", size + len(added)) + content[place + 8:cluster] + added + content[cluster:])
        self.assertIn("attached is left out, as GStreamer writes none: letters.ttf", self.run_it("fonts.mkv", "-o", "out.mkv", "--", "identity"))

    def test_marks_of_tracks_are_told_of(self):
        field = lambda name, data: bytes.fromhex(name) + struct.pack(">Q", 1 << 56 | len(data)) + data  # noqa: E731 (an element of EBML)
        number = lambda name, value: field(name, bytes([value]))  # noqa: E731
        track = lambda at, kind, *flags: field("ae", number("d7", at) + number("83", kind) + b"".join(flags))  # noqa: E731

        def told(*tracks, before=b""):
            path = self.path("marks.mkv")
            with open(path, "wb") as file:
                file.write(field("1a45dfa3", b"") + field("18538067", before + field("1654ae6b", b"".join(tracks)) + field("1f43b675", b"1" * 99)))
            return marks.left_out(path)

        self.assertEqual(told(track(1, 1), track(2, 2), before=field("ec", b"void")), [])
        self.assertEqual(told(track(1, 1, number("88", 0)), track(2, 2, number("88", 0)), track(3, 2, number("88", 0))), [], "of which none is default")
        (text,) = told(track(1, 1), track(2, 2), track(3, 2, number("88", 0)), track(4, 17, number("55aa", 1), number("55ab", 1)))
        self.assertIn("not default (sound 3), forced (subtitles 4), for the hearing impaired (subtitles 4)", text)
        with open(self.path("marks.mkv"), "rb") as file:
            content = file.read()
        for cut in range(0, len(content), 7):
            with open(self.path("cut.mkv"), "wb") as file:
                file.write(content[:cut])
            marks.left_out(self.path("cut.mkv"))
        self.make("time.mov", VIDEO.format(frames=5, form="I420") + "timecodestamper ! jpegenc ! qtmux")
        self.assertIn("time code is left out", self.run_it("time.mov", "-o", "time.mkv", "--", "identity"))
        self.make("none.mov", VIDEO.format(frames=5, form="I420") + "jpegenc ! qtmux name=mux")
        self.assertNotIn("time code", self.run_it("none.mov", "-o", "none.mkv", "--", "identity"))

    def test_jpeg_pictures_are_turned_as_they_say(self):
        os.makedirs(self.path("in"))
        exif = lambda way: b"Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0" + bytes([way]) + b"\0\0\0\0\0\0"  # noqa: E731
        for number, way in enumerate((6, 6, 1)):
            path = self.make(f"in/{number:04}.jpg", "videotestsrc num-buffers=1 ! video/x-raw,width=96,height=64 ! jpegenc")
            with open(path, "rb") as file:
                content = file.read()
            segment = exif(way)
            with open(path, "wb") as file:
                file.write(content[:2] + b"\xff\xe1" + struct.pack(">H", len(segment) + 2) + segment + content[2:])
        self.assertIn("is to be turned otherwise", self.run_it("in/%04d.jpg", "-o", "out", "--to", "png", "--", "identity", status=1))
        os.unlink(self.path("in/0002.jpg"))
        self.run_it("in/%04d.jpg", "-o", "out", "--to", "png", "--", "identity")
        self.run_it("in/0000.jpg", "-o", "out.mkv", "--", "identity")
        for path in ("out/000001.png", "out.mkv"):
            caps = frames_of(self.path(path))[0][0]
            self.assertEqual((caps.get_value("width"), caps.get_value("height")), (64, 96))

    def test_jpeg_keeps_its_colors(self):
        self.need("avdec_mjpeg", "jpegparse")
        for form in ("Y444", "Y42B"):
            with self.subTest(form):
                raw = f"videotestsrc num-buffers=1 ! video/x-raw,format={form},colorimetry=(string)1:4:0:0,width=160,height=120,framerate=30/1 ! "
                self.make("in/0.jpg", raw + "jpegenc quality=100")
                self.make("as-it-was", raw + "videoconvert ! video/x-raw,format=RGB")
                self.run_it("in/%d.jpg", "-o", "out.mkv", "--video", "ffv1", "--again", "--", "identity")
                self.run_it("in/%d.jpg", "-o", "out", "--to", "png", "--again", "--", "identity")
                self.assertEqual(frames_of(self.path("out.mkv"))[0][0].get_string("format"), form)
                (_, pixels), = frames_of(self.path("out/000000.png"))
                with open(self.path("as-it-was"), "rb") as file:
                    differences = [abs(one - other) for one, other in zip(pixels, file.read())]
                self.assertLess(sum(differences) / len(differences), 3)

    def test_lists_of_streams_are_no_videos(self):
        with open(self.path("list.mkv"), "w", encoding="ascii") as file:
            file.write("#EXTM3U\n#EXT-X-TARGETDURATION:2\n#EXTINF:2,\nhttp://127.0.0.1:9/x.ts\n")
        self.assertIn("it is a list of streams", self.run_it("list.mkv", "-o", "out.mkv", status=1))

    def test_a_list_within_a_file_opens_no_connection(self):
        listed = Listed(self)
        for name in listed.write(self.path("")):
            with self.subTest(name):
                said = self.run_it(name, "-o", "out.mkv", status=1)
                self.assertIn(f"{name}: it is a list of streams", said)
        listed.expect_no_connection(self)

    def test_the_muxer_waits_for_slow_video(self):
        """Raw sound is there at once, its video much later."""
        self.clip(frames=4, sound="audio/x-raw,format=S16LE")
        for _ in range(6):
            self.run_it("clip.mkv", "-o", "out.mkv", "--again", "--", "identity ! queue ! identity sleep-time=50000")
            self.assertEqual(sorted(s.name for s in streams_of(self.path("out.mkv"))[0]), ["audio/x-raw", "video/x-vp8"])

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

    def test_what_is_no_result_or_older_is_not_replaced(self):
        self.clip()
        for words, name in ((["-o", "out.mkv"], "out.mkv"), (["-o", "out.mov"], "out.mov"), ([], "out/transcode/clip.mkv")):
            os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
            with open(self.path(name), "w", encoding="ascii") as file:
                file.write("of somebody")
            for more in ([], ["--again"]):
                self.assertIn("--overwrite replaces it", self.run_it("clip.mkv", *words, *more, "--", "identity", status=1))
            self.assertEqual(os.path.getsize(self.path(name)), 11)
            self.run_it("clip.mkv", *words, "--overwrite", "--", "identity")
            self.assertEqual(streams_of(self.path(name))[0][0].packets, 12)
            self.assertIn("present", self.run_it("clip.mkv", *words, "--", "identity"))
            os.utime(self.path(name), (1, 1))
            self.assertIn("--again replaces it", self.run_it("clip.mkv", *words, "--", "identity", status=1))
            self.run_it("clip.mkv", *words, "--again", "--", "identity")
            self.assertGreater(os.path.getmtime(self.path(name)), 1)

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
            (["clip.mkv", "-o", "x.webm", "--video", "ffv1"], "it takes av1, vp8, vp9; mkv takes it", 2),
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

    def test_a_report_replaces_only_a_report(self):
        self.clip()
        with open(self.path("notes"), "w", encoding="ascii") as file:
            file.write("{}")
        self.make("p/%d.png", "videotestsrc num-buffers=1")  # a name that is no pattern
        os.rename(self.path("p/%d.png"), self.path("p/1.png"))
        before = os.path.getsize(self.path("clip.mkv")), os.path.getsize(self.path("notes"))
        for words, text in ((["clip.mkv", "--report", "clip.mkv"], "would replace an input"),
                            (["clip.mkv", "--report", "./clip.mkv", "--overwrite"], "would replace an input"),
                            (["clip.mkv", "-o", "new.mkv", "--report", "new.mkv"], "in the place of a result"),
                            (["clip.mkv", "--report", "notes"], "is no report"),
                            (["p/%d.png", "--report", "p/2.png"], "would replace an input"), (["clip.mkv", "--report", "."], "it is a folder")):
            with self.subTest(words):
                self.assertIn(text, self.run_it(*words, "--", "identity", status=2))
        self.assertEqual((os.path.getsize(self.path("clip.mkv")), os.path.getsize(self.path("notes")), os.path.exists(self.path("out"))), (*before, False))
        for words in (["report"], ["report"], ["notes", "--overwrite"]):
            self.run_it("clip.mkv", "--report", *words, "--", "identity")
        for name in ("report", "notes"):
            with open(self.path(name), encoding="ascii") as file:
                self.assertEqual(json.load(file)["counts"], {"present": 1})
        self.assertEqual(json.loads(self.run_it("clip.mkv", "--quiet", "--report", "-", "--", "identity"))["counts"], {"present": 1})
        self.run_it("clip.mkv", "--report", "/dev/null", "--", "identity")
        self.assertFalse(os.path.isfile("/dev/null"))

    def test_dry_run_writes_nothing(self):
        self.clip()
        self.assertIn("clip.mkv -> out/transcode/clip.mkv", self.run_it("clip.mkv", "--dry-run"))
        with open(self.path("broken.mp4"), "w", encoding="ascii") as file:
            file.write("this is no video")
        self.assertIn("broken.mp4 -> out/transcode/broken.mkv: ", self.run_it("broken.mp4", "--dry-run", status=1))
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
        # The whole result takes its place.
        self.run_it("clip.mkv", "-o", "out.mkv", "--", "identity")
        self.assertFalse(os.path.exists(self.path("out.partial.mkv")))

    def test_what_is_stopped_is_counted(self):
        for name in ("a.mkv", "b.mkv", "c.mkv"):
            self.clip("in/" + name, frames=600)
        process = self.start("in", "--out", "out", "--jobs", "1")
        self.wait_for_part("out/in")
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=LIMIT)
        self.assertIn("0 done, 0 already there, 0 failed, 1 stopped, 2 not started", errors)

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

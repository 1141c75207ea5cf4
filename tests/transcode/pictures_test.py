# SPDX-License-Identifier: LGPL-2.1-or-later
"""Numbered pictures of inverse-transcode that have more than 8 bits: OpenEXR, and PNG of 16 bits."""
import os
import re
import struct
import sys
import unittest
import zlib

from case import ROOT, SKIPPED, Case, streams_of, structure_of

sys.path.insert(0, str(ROOT / "transcode"))
try:
    import numpy
    from inverse_transcode import formats, pictures

    pictures.openexr()
except (ImportError, formats.FormatError) as problem:
    print(problem)
    sys.exit(SKIPPED)

SIZE = 40, 56  # rows, columns
IDENTITY = ["--", "identity"]


def write_exr(path, channels, data=None, shown=None, aspect=1):
    """`channels`: arrays of half or single floats by name; windows: left, top, width, height. Not compressed."""
    height, width = next(iter(channels.values())).shape
    left, top, wide, high = data or (0, 0, width, height)
    x, y, w, h = shown or (left, top, wide, high)
    listed = b"".join(name.encode() + b"\0" + struct.pack("<iB3xii", 1 if channels[name].dtype == numpy.float16 else 2, 0, 1, 1)
                      for name in sorted(channels)) + b"\0"
    attributes = (("channels", "chlist", listed), ("compression", "compression", b"\0"),
                  ("dataWindow", "box2i", struct.pack("<4i", left, top, left + wide - 1, top + high - 1)),
                  ("displayWindow", "box2i", struct.pack("<4i", x, y, x + w - 1, y + h - 1)), ("lineOrder", "lineOrder", b"\0"),
                  ("pixelAspectRatio", "float", struct.pack("<f", aspect)), ("screenWindowCenter", "v2f", bytes(8)),
                  ("screenWindowWidth", "float", struct.pack("<f", 1)))
    head = struct.pack("<ii", 20000630, 2)
    for name, kind, value in attributes:
        head += name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
    head += b"\0"
    rows = [b"".join(channels[name][row].tobytes() for name in sorted(channels)) for row in range(height)]
    at = len(head) + 8 * height
    offsets, body = b"", b""
    for row, samples in enumerate(rows):
        offsets += struct.pack("<Q", at + len(body))
        body += struct.pack("<ii", top + row, len(samples)) + samples
    with open(path, "wb") as file:
        file.write(head + offsets + body)


def rgb(pixels, kind=numpy.float16):
    return {name: pixels[..., k].astype(kind) for k, name in enumerate("RGB")}


def light(path):
    """Red, green, blue and alpha of an EXR file."""
    return pictures.read_exr(path).view(numpy.float16).astype(float)


def write_png16(path, pixels):
    """Of colors, with or without alpha."""
    rows = b"".join(b"\0" + row.astype(">u2").tobytes() for row in pixels)
    head = struct.pack(">IIBBBBB", pixels.shape[1], pixels.shape[0], 16, {3: 2, 4: 6}[pixels.shape[2]], 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        for kind, data in ((b"IHDR", head), (b"IDAT", zlib.compress(rows)), (b"IEND", b"")):
            file.write(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)))


def read_png(path):
    """Bits of a sample, and the samples of a PNG file as inverse-transcode writes those of 16 bits."""
    with open(path, "rb") as file:
        rest = file.read()[8:]
    chunks = {}
    while rest:
        size, kind = struct.unpack(">I4s", rest[:8])
        assert struct.unpack(">I", rest[8 + size:12 + size])[0] == zlib.crc32(rest[4:8 + size])
        chunks[kind], rest = chunks.get(kind, b"") + rest[8:8 + size], rest[12 + size:]
    width, height, bits, color = struct.unpack(">IIBB", chunks[b"IHDR"][:10])
    if bits == 8:
        return bits, None
    rows = numpy.frombuffer(zlib.decompress(chunks[b"IDAT"]), numpy.uint8).reshape(height, -1)
    assert (rows[:, 0] == 2).all()
    samples = numpy.cumsum(rows[:, 1:], axis=0, dtype=numpy.uint8)
    return bits, samples.reshape(-1).view(">u2").reshape(height, width, {0: 1, 2: 3, 6: 4}[color]).astype(int)


def srgb(linear):
    return numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * numpy.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)


class Pictures(Case):
    def setUp(self):
        super().setUp()
        self.random = numpy.random.default_rng(4)

    def shot(self, count=3, scale=1.0):
        """Writes numbered EXR files from 7 on; returns their pixels, which are above 1 in part."""
        os.makedirs(self.path("shot"), exist_ok=True)
        frames = [numpy.clip(scale * numpy.exp(self.random.normal(-1, 1.5, (*SIZE, 3))), 0, 45 * scale).astype(numpy.float16) for _ in range(count)]
        for number, pixels in enumerate(frames, 7):
            write_exr(self.path(f"shot/{number:04}.exr"), rgb(pixels))
        return frames

    def test_exr_to_exr_is_the_same(self):
        frames = self.shot()
        frames[1][0, :5] = [[-1, 0.5, 60], [numpy.inf, 0, 0], [0, numpy.nan, 0], [-0.0, 6e-8, 49], [0, -numpy.inf, 1]]
        write_exr(self.path("shot/0008.exr"), rgb(frames[1]))
        said = self.run_it("shot/%04d.exr", "--rate", "24", "-o", "out", "--to", "exr", *IDENTITY)
        self.assertIn("2 pixels of its pictures were brighter than 49.3", said)
        self.assertIn("2 pixels of its pictures were negative", said)
        self.assertIn("1 pixels of its pictures were no number", said)
        self.assertEqual(sorted(os.listdir(self.path("out"))), [f"{n:06}.exr" for n in range(3)])
        for number, pixels in enumerate(frames):
            read = light(self.path(f"out/{number:06}.exr"))
            kept = numpy.nan_to_num(pixels.astype(float), nan=0).clip(0, 49.25)
            numpy.testing.assert_array_equal(read[..., :3], kept)
            self.assertTrue((read[..., 3] == 1).all())
        self.assertIn("present out", self.run_it("shot/%04d.exr", "-o", "out", "--to", "exr", *IDENTITY))

    def test_exposure_is_undone(self):
        frames = self.shot(scale=100)
        self.assertGreater(frames[0].max(), 1000)
        self.assertNotIn("warning", self.run_it("shot/%04d.exr", "-o", "out", "--to", "exr", "--exposure", "-7", *IDENTITY))
        for number, pixels in enumerate(frames):
            numpy.testing.assert_array_equal(light(self.path(f"out/{number:06}.exr"))[..., :3], pixels)

    def test_layers_are_light(self):
        frames = self.shot(count=2)
        for folder, *more in (["plain"], ["dark", "--exposure", "-2"]):
            self.run_it("shot/%04d.exr", "-o", folder, "--to", "exr", "--layers", "input,reflectance,shading", *more, "--", "intrinsicdecomp")
            for number, pixels in enumerate(frames):
                layers = {name: light(self.path(f"{folder}/{name}/{number:06}.exr"))[..., :3] for name in ("input", "reflectance", "shading")}
                numpy.testing.assert_allclose(layers["input"], pixels, rtol=1.1e-3)  # a step of a half float
                seen = pixels > 0.01
                error = numpy.log(layers["reflectance"] * layers["shading"] / pixels)[seen]
                self.assertLess(numpy.abs(error).max(), 3e-3)
                self.assertGreater(layers["shading"].max(), 1.5)

    def test_windows_and_channels(self):
        pixels = self.random.uniform(0, 4, (*SIZE, 3)).astype(numpy.float16)
        alpha = {**rgb(pixels), "A": numpy.full(SIZE, 0.5, numpy.float16)}
        gray, single = pixels[..., 0], pixels.astype(numpy.float32) * 1.0002  # between half floats
        for name, channels, windows, expected in (
            ("crop", rgb(pixels), ((3, 2, SIZE[1], SIZE[0]), (5, 6, 20, 10)), pixels[4:14, 2:22]),
            ("alpha", alpha, ((-4, 3, SIZE[1], SIZE[0]), (0, 0, SIZE[1], SIZE[0])), numpy.pad(pixels, ((3, 0), (0, 4), (0, 0)))[:SIZE[0], 4:]),
            ("gray", {"Y": gray}, (), numpy.stack([gray] * 3, -1)),
            ("single", rgb(single, numpy.float32), (), single.astype(numpy.float16)),
        ):
            with self.subTest(name):
                write_exr(self.path(f"{name}1.exr"), channels, *windows)
                self.run_it(f"{name}%d.exr", "-o", name, "--to", "exr", *IDENTITY)
                read = light(self.path(f"{name}/000000.exr"))
                numpy.testing.assert_array_equal(read[..., :3], expected)
                self.assertEqual(numpy.unique(read[..., 3]).round(4).tolist(), [0, 0.5] if name == "alpha" else [1])

    def test_what_exr_cannot_be(self):
        pixels = self.random.uniform(0, 1, (*SIZE, 3)).astype(numpy.float16)
        for name in ("cut1", "cut2", "gap1", "gap3", "size1", "text2"):
            write_exr(self.path(f"{name}.exr"), rgb(pixels))
        write_exr(self.path("size2.exr"), rgb(pixels[:20]))
        write_exr(self.path("depth1.exr"), {"Z": pixels[..., 0], "diffuse.R": pixels[..., 1]})
        os.truncate(self.path("cut2.exr"), 3000)
        with open(self.path("text1.exr"), "w", encoding="ascii") as file:
            file.write("This is no picture.")
        for words, text, status in (
            (["cut%d.exr"], "cut2.exr cannot be read as OpenEXR", 1),
            (["text%d.exr"], "text1.exr cannot be read as OpenEXR", 1),
            (["gap%d.exr"], "is missing (1 in all)", 1),
            (["size%d.exr"], "size2.exr is 56x20; size1.exr is 56x40", 1),
            (["depth%d.exr"], "depth1.exr has no channels R, G and B, or Y, but Z, diffuse.R", 1),
            (["gap1.exr"], "EXR pictures are named by a pattern", 1),
            (["text2.exr", "-o", "x.mkv", "--exposure", "1"], "--exposure is for", 2),
            (["size%d.exr", "--exposure", "30"], "--exposure takes", 2),
            (["gap%d.exr", "-o", "x", "--to", "exr", "--video-options", "a=1"], "--video-options", 2),
        ):
            with self.subTest(words):
                self.assertIn(text, self.run_it(*words, *IDENTITY, status=status))

    def test_pixels_that_are_not_square(self):
        for name, aspect, ratio in (("two", 2, (2, 1)), ("anamorphic", 1.5, (3, 2)), ("tall", 0.6667, (2, 3))):
            os.makedirs(self.path(name))
            write_exr(self.path(f"{name}/1.exr"), rgb(numpy.full((56, 80, 3), 0.5)), aspect=aspect)
            self.run_it(f"{name}/%d.exr", "-o", f"{name}.mkv", *IDENTITY)
            (video,), _ = streams_of(self.path(f"{name}.mkv"))
            known, above, below = structure_of(video.caps).get_fraction("pixel-aspect-ratio")
            self.assertAlmostEqual(above / below if known else 1, ratio[0] / ratio[1], 2)
            self.run_it(f"{name}/%d.exr", "-o", f"{name}-exr", "--to", "exr", *IDENTITY)
            self.assertAlmostEqual(float(pictures.pixel_aspect(self.path(f"{name}-exr/000000.exr"))), ratio[0] / ratio[1], 3)
        self.assertIn("a shape of 2:1", self.run_it("two/%d.exr", "-o", "two-png", "--to", "png", "--", "intrinsicdecomp", "show=input"))

    def test_exr_to_sdr(self):
        frames = self.shot(count=2)
        said = self.run_it("shot/%04d.exr", "-o", "png", "--to", "png", "--", "intrinsicdecomp", "show=input")
        told = re.search("([0-9]+) pixels of input were as bright as frames can be, white, or brighter", said)
        white = [sum(int((pixels > bound).any(-1).sum()) for pixels in frames) for bound in (1.001, 0.999)]
        self.assertTrue(told and white[0] <= int(told.group(1)) <= white[1], said)
        for number, pixels in enumerate(frames):
            bits, samples = read_png(self.path(f"png/{number:06}.png"))
            self.assertEqual(bits, 16)
            self.assertLess(numpy.abs(samples / 65535 - srgb(pixels.astype(float).clip(0, 1))).max(), 2e-4)
        self.run_it("shot/%04d.exr", "-o", "small", "--to", "png", "--bits", "8", "--", "intrinsicdecomp")
        self.assertEqual(read_png(self.path("small/000000.png"))[0], 8)
        self.assertIn("png is not written of HDR", self.run_it("shot/%04d.exr", "-o", "no", "--to", "png", *IDENTITY, status=1))

    def test_exr_to_video(self):
        self.need("vp9enc")
        self.shot(count=2)
        for name, curve, elements in (("sdr", "1:4:7:1", ["intrinsicdecomp"]), ("hdr", "1:4:14:1", ["identity"])):
            self.run_it("shot/%04d.exr", "-o", f"{name}.mkv", "--", *elements)
            (video,), _ = streams_of(self.path(f"{name}.mkv"))
            form = structure_of(video.caps)
            self.assertEqual(form.get_uint("bit-depth-luma").value, 10)
            self.assertEqual(form.get_string("colorimetry").split(":")[2], curve.split(":")[2])

    def test_video_to_exr(self):
        self.clip(frames=2)
        self.run_it("clip.mkv", "-o", "plain", "--to", "exr", *IDENTITY)
        bars = light(self.path("plain/000000.exr"))
        self.assertAlmostEqual(bars[10, 5, 0], 1, delta=0.02)  # white of the test picture
        self.run_it("clip.mkv", "-o", "layers", "--to", "exr", "--layers", "shading", "--", "intrinsicdecomp")
        self.assertGreater(light(self.path("layers/shading/000000.exr")).max(), 1.05)

    def test_png_of_16_bits(self):
        self.need("vp9enc")
        for name, samples in (("color", 3), ("alpha", 4)):
            pixels = self.random.integers(0, 65536, (*SIZE, samples))
            write_png16(self.path(f"{name}1.png"), pixels)
            for elements in (["identity"], ["intrinsicdecomp", "show=input"]):
                with self.subTest(f"{name} {elements}"):
                    self.run_it(f"{name}%d.png", "-o", "out", "--to", "png", "--again", "--", *elements)
                    bits, read = read_png(self.path("out/000000.png"))
                    self.assertEqual((bits, read.shape), (16, pixels.shape))
                    different = numpy.abs(read - pixels)
                    different[-1, -1] = 0  # of which pngdec loses a sample
                    self.assertLessEqual(different.max(), 1)
        self.run_it("color%d.png", "-o", "out.mkv", *IDENTITY)
        (video,), _ = streams_of(self.path("out.mkv"))
        self.assertEqual(structure_of(video.caps).get_uint("bit-depth-luma").value, 10)

    def test_more_bits_of_8(self):
        self.clip(frames=2)
        words = ["clip.mkv", "--to", "png", "--again", "--", "intrinsicdecomp"]
        self.run_it("-o", "deep", "--bits", "16", *words)
        bits, samples = read_png(self.path("deep/000000.png"))
        self.assertEqual(bits, 16)
        self.assertGreater(len(numpy.unique(samples)), 1000)  # more than codes of 8 bits
        self.run_it("-o", "deep", *words)
        self.assertEqual(read_png(self.path("deep/000000.png"))[0], 8)

    def test_small_pictures(self):
        for side in (1, 2, 8):
            write_png16(self.path(f"of{side}_1.png"), self.random.integers(0, 65536, (side, side, 3)))
            self.run_it(f"of{side}_%d.png", "-o", f"of{side}", "--to", "exr")
            self.assertEqual(light(self.path(f"of{side}/000000.exr")).shape, (side, side, 4))
        self.need("openh264enc", "mp4mux")
        said = self.run_it("of8_%d.png", "-o", "out.mp4", "--video", "h264", *IDENTITY, status=1)
        self.assertIn("its pictures are 8x8, which may be too small for h264: enlarge them", said)
        self.run_it("of8_%d.png", "-o", "out.mp4", "--video", "h264", *IDENTITY, "!", "videoscale", "!", "video/x-raw,width=64,height=64")


if __name__ == "__main__":
    unittest.main(verbosity=2)

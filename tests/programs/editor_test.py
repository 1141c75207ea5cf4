# SPDX-License-Identifier: LGPL-2.1-or-later
"""examples/editor: built as its head says against the installed header, and used as an element among others."""
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

import support
from gi.repository import Gst
from inverse_common.gst import structure_of

SIZE = (160, 120)
RED, YELLOW = (125, 30), (34, 30)  # bars of the pattern smpte
SELECT_RED = r"""intrinsicselect strokes::list="[{\"kind\":\"add\",\"points\":[[125,20],[125,60]]}]" """


def setUpModule():
    for program in ("cc", "meson", "ninja", "pkg-config"):
        if not shutil.which(program):
            support.skip(f"{program} is missing")
    folder = pathlib.Path(tempfile.mkdtemp())
    unittest.addModuleCleanup(shutil.rmtree, folder)
    # Headers and pkg-config file, as the package libgstinverse-dev has them, but not in /usr.
    build = pathlib.Path(os.environ["GST_PLUGIN_PATH"].split(":")[0]).parent
    subprocess.run(["meson", "install", "-C", build, "--no-rebuild", "--tags", "devel", "--destdir", folder / "installed"], check=True,
                   stdout=subprocess.DEVNULL)
    [package] = (folder / "installed").rglob("gst-inverse-1.0.pc")
    package.write_text(re.sub("^prefix=", f"prefix={folder}/installed", package.read_text(), flags=re.M))
    source = support.ROOT / "examples" / "editor"
    shutil.copytree(source, folder / "examples" / "editor")
    head = re.search(r"Build:\n(.*?)\n\n", (source / "layersaturation.c").read_text(), re.S)[1]
    for command in head.splitlines():
        subprocess.run(command, shell=True, check=True, cwd=folder,
                       env={**os.environ, "PKG_CONFIG_PATH": str(package.parent), "CFLAGS": "-Werror"})
    Gst.Registry.get().scan_path(str(folder / "build-editor"))


def source(frames=3, size=SIZE, pattern="smpte75"):
    return f"videotestsrc num-buffers={frames} pattern={pattern} ! video/x-raw,format=RGBx,width={size[0]},height={size[1]}"


def play(line, before=None):
    """(time, width, height, RGBx bytes) of the frames at each `OUT` of a line, in order. `before` is called with each frame's number
    before layersaturation gets it."""
    outs = line.count("OUT")
    for k in range(outs):
        line = line.replace("OUT", f"capsfilter caps=video/x-raw,format=RGBx ! fakesink name=out{k} signal-handoffs=true sync=false", 1)
    pipeline = Gst.parse_launch(line)
    frames = [[] for _ in range(outs)]

    def take(_, buffer, pad, got):
        caps = structure_of(pad.get_current_caps())
        got.append((buffer.pts, caps.get_value("width"), caps.get_value("height"), buffer.extract_dup(0, buffer.get_size())))

    for k in range(outs):
        pipeline.get_by_name(f"out{k}").connect("handoff", take, frames[k])
    if before:
        element, count = pipeline.get_by_name("editor"), iter(range(1000))

        def probe(_pad, _info):
            before(element, next(count))
            return Gst.PadProbeReturn.OK

        element.get_static_pad("sink").add_probe(Gst.PadProbeType.BUFFER, probe)
    pipeline.set_state(Gst.State.PLAYING)
    message = pipeline.get_bus().timed_pop_filtered(support.LIMIT * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
    pipeline.set_state(Gst.State.NULL)
    if message is None or message.type == Gst.MessageType.ERROR:
        raise RuntimeError(message.parse_error()[0].message if message else "it does not end")
    return frames if outs > 1 else frames[0]


def at(frame, x, y):
    _, width, _, data = frame
    return tuple(data[4 * (y * width + x):4 * (y * width + x) + 3])


def pixels(frame):
    _, width, height, data = frame
    return [tuple(data[k:k + 3]) for k in range(0, 4 * width * height, 4)]


def linear(code):
    code /= 255
    return code / 12.92 if code <= 0.04045 else ((code + 0.055) / 1.055) ** 2.4


def encoded(light):
    return 255 * (12.92 * light if light <= 0.0031308 else 1.055 * light ** (1 / 2.4) - 0.055)


class Editor(unittest.TestCase):
    def expect_gray(self, color):
        self.assertLessEqual(max(color) - min(color), 1, color)

    def expect_equal(self, a, b):
        self.assertEqual(a[:3], b[:3])
        self.assertTrue(pixels(a) == pixels(b), "they differ")  # a comparison of lists would take minutes to say where

    def test_saturation_of_reflectance(self):
        for decomposer in ("intrinsicdecomp", "globalintrinsic"):
            for saturation in (0, 0.5, 1, 1.5):
                with self.subTest(decomposer=decomposer, saturation=saturation):
                    line = source(2) + f" ! {decomposer} ! layersaturation saturation=%s ! intrinsiccompose show=reflectance ! OUT"
                    before, after = play(line % 1)[-1], play(line % saturation)[-1]
                    checked = 0
                    for old, new in zip(pixels(before), pixels(after)):
                        light = [linear(code) for code in old]
                        gray = 0.2126 * light[0] + 0.7152 * light[1] + 0.0722 * light[2]
                        wanted = [gray + saturation * (c - gray) for c in light]
                        # What is clipped in either picture is not known; codes of darker colors are coarse.
                        if max(*old, *new) == 255 or min(*light, *wanted) < 0.02:
                            continue
                        checked += 1
                        for code, c in zip(new, wanted):
                            self.assertAlmostEqual(code, encoded(c), delta=2, msg=f"{old} became {new}")
                    self.assertGreater(checked, 2000)

    def test_only_what_is_selected(self):
        line = source(3, pattern="smpte") + " ! intrinsicdecomp ! " + SELECT_RED + " ! layersaturation saturation=0 %s ! intrinsiccompose ! OUT"
        [*_, input_] = play(source(3, pattern="smpte") + " ! OUT")
        masked, everywhere = play(line % "")[-1], play(line % "use-mask=false")[-1]
        self.assertEqual(at(masked, *YELLOW), at(input_, *YELLOW))
        self.assertGreater(min(at(everywhere, *YELLOW)), 100)
        for frame in (masked, everywhere):
            red, green, blue = at(frame, *RED)
            self.assertLess(max(red, green, blue) - min(red, green, blue), 40, (red, green, blue))

    def test_editors_before_and_after(self):
        recolor = "intrinsicrecolor target=0xff2040c0"
        line = source() + f" ! intrinsicdecomp ! {SELECT_RED} ! %s ! intrinsictone look=matte ! intrinsiccompose show=reflectance ! OUT"
        gray = "layersaturation saturation=0 use-mask=false"
        last = play(line % f"{recolor} ! {gray}")[-1]
        self.expect_gray(at(last, *RED))
        self.expect_gray(at(last, *YELLOW))
        first = play(line % f"{gray} ! {recolor}")[-1]
        red, green, blue = at(first, *RED)
        self.assertGreater(blue, red + 60, (red, green, blue))
        self.expect_gray(at(first, *YELLOW))

    def test_the_other_branch_of_a_tee(self):
        edited, other, input_ = play(
            source() + " ! tee name=i ! queue ! intrinsicdecomp ! tee name=t ! queue ! layersaturation saturation=0 ! intrinsiccompose ! OUT "
            "t. ! queue ! intrinsiccompose ! OUT i. ! queue ! OUT")
        self.assertEqual([len(edited), len(other)], [3, 3])
        for a, b, c in zip(edited, other, input_):
            self.expect_equal(b, c)
            self.assertEqual(a[0], c[0])
            self.assertFalse(pixels(a) == pixels(c))

    def test_while_it_plays(self):
        line = source(4) + " ! intrinsicdecomp ! layersaturation name=editor ! intrinsiccompose ! OUT"
        plain = play(source(4) + " ! OUT")
        got = play(line, lambda element, number: element.set_property("saturation", 0 if number == 2 else 1))
        for number in (0, 1, 3):
            self.expect_equal(got[number], plain[number])
        self.assertEqual(got[2][:3], plain[2][:3])
        self.assertFalse(pixels(got[2]) == pixels(plain[2]))

    def test_new_sizes(self):
        sizes = [(160, 120), (33, 21), (50, 20)]
        line = " ".join(source(2, size) + " ! c." for size in sizes)
        got = play("concat name=c ! intrinsicdecomp ! layersaturation saturation=0 ! intrinsiccompose show=reflectance ! OUT " + line)
        self.assertEqual([frame[1:3] for frame in got], [size for size in sizes for _ in range(2)])
        for frame in got:
            for color in pixels(frame):
                self.expect_gray(color)

    def test_frames_in_device_memory(self):
        if not Gst.ElementFactory.find("vulkanupload"):
            self.skipTest("vulkanupload is missing: install gstreamer1.0-plugins-bad")
        chain = "intrinsicdecomp ! layersaturation saturation=0 ! intrinsiccompose"
        rgba = source().replace("RGBx", "RGBA")
        here = play(f"{rgba} ! {chain} ! video/x-raw,format=RGBA ! videoconvert ! OUT")
        there = play(f"{rgba} ! vulkanupload ! {chain} ! vulkandownload ! videoconvert ! OUT")
        self.assertEqual(len(there), 3)
        for a, b in zip(here, there):
            self.expect_equal(a, b)

    def test_frames_without_layers(self):
        for line in (source() + " ! layersaturation ! intrinsiccompose ! OUT",
                     source() + " ! intrinsicdecomp ! intrinsiccompose ! layersaturation ! intrinsiccompose ! OUT"):
            with self.assertRaisesRegex(RuntimeError, "insert intrinsicdecomp or globalintrinsic before it"):
                play(line)


unittest.main(verbosity=2)

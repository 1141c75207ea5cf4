# SPDX-License-Identifier: LGPL-2.1-or-later
"""The programs of examples/: built and started as their heads say."""
import os
import re
import shutil
import signal
import subprocess
import sys
import unittest

import support
from inverse_common.gst import structure_of

EXAMPLES = support.ROOT / "examples"
RED, YELLOW = (125, 30), (34, 30)  # bars of the pattern smpte at 160x120
BLUE = "0xff2040c0"


class Example(support.Case):
    def expect_painted(self, before, after):
        """The red bar is blue, and the yellow one as before."""
        (red, green, blue), old, new = support.color(after, *RED), support.color(before, *YELLOW), support.color(after, *YELLOW)
        self.assertGreater(blue, red + 60, (red, green, blue))
        self.assertGreater(blue, green + 30, (red, green, blue))
        for a, b in zip(old, new):
            self.assertAlmostEqual(a, b, delta=12)

    def expect_failure(self, result, text, status=1):
        errors = result.stderr if isinstance(result.stderr, str) else result.stderr.decode()
        self.assertEqual(result.returncode, status, errors)
        self.assertIn(text, errors)
        self.assertNotIn("CRITICAL", errors)
        self.assertNotIn("Traceback", errors)


@unittest.skipUnless(shutil.which("cc") and shutil.which("pkg-config"), "cc or pkg-config is missing")
class C(Example):
    def setUp(self):
        super().setUp()
        shutil.copy(EXAMPLES / "repaint.c", self.folder)
        head = re.search(r"Build:\n(.*?)\n\n", (EXAMPLES / "repaint.c").read_text(), re.S)[1]
        self.assertEqual(len(head.splitlines()), 2, head)
        strict = head.replace("cc ", "cc -std=c11 -Wall -Wextra -Werror ", 1)
        self.assertNotEqual(strict, head)
        for command in (strict, head):
            subprocess.run(command, shell=True, check=True, cwd=self.folder)

    def pictures(self, count, width=160, height=120):
        path = self.path("in.ppm")
        support.run_line(f"videotestsrc num-buffers={count} ! video/x-raw,format=RGB,width={width},height={height} ! pnmenc ! "
                         f"filesink location={path}")
        with open(path, "rb") as file:
            return file.read()

    def run_it(self, data, *words, out=subprocess.PIPE, **environment):
        words = words or (*map(str, RED), BLUE)
        return subprocess.run([self.path("repaint"), *words], input=data, stdout=out, stderr=subprocess.PIPE, timeout=support.LIMIT,
                              env={**os.environ, **environment})

    def read(self, data, width, height):
        """Frames as support.read_video returns them, of PPM pictures of that size."""
        head, rows = b"P6\n%d %d\n255\n" % (width, height), 3 * width * height
        caps = structure_of(support.Gst.Caps.from_string(f"video/x-raw,width={width},height={height}"))
        frames = []
        while data:
            self.assertTrue(data.startswith(head), data[:20])
            frames.append((None, caps, data[len(head):len(head) + rows]))
            self.assertEqual(len(frames[-1][2]), rows)
            data = data[len(head) + rows:]
        return frames

    def test_paints(self):
        pictures = self.pictures(5)
        before, result = self.read(pictures, 160, 120), self.run_it(pictures)
        self.assertEqual(result.returncode, 0, result.stderr)
        after = self.read(result.stdout, 160, 120)
        self.assertEqual(len(after), 5)
        for pair in zip(before, after):
            self.expect_painted(*pair)

    def test_odd_width_and_new_sizes(self):
        first, second = self.pictures(2, 33, 21), self.pictures(2, 50, 20)
        result = self.run_it(first + second, "3", "3", BLUE)
        self.assertEqual(result.returncode, 0, result.stderr)
        cut = len(b"P6\n33 21\n255\n" + bytes(3 * 33 * 21)) * 2
        self.assertEqual([len(self.read(result.stdout[:cut], 33, 21)), len(self.read(result.stdout[cut:], 50, 20))], [2, 2])

    def test_bad_input(self):
        pictures = self.pictures(2)
        self.expect_failure(self.run_it(pictures[:-1]), "picture 1 is no complete PPM")
        self.expect_failure(self.run_it(b"this is no picture"), "picture 0 is no complete PPM")
        self.expect_failure(self.run_it(b"P6 999999 999999 255\n"), "picture 0 is no complete PPM")
        self.expect_failure(self.run_it(pictures, "here", "3", BLUE), "whole numbers", status=2)
        self.expect_failure(self.run_it(pictures, "3"), "usage", status=2)
        self.expect_failure(self.run_it(pictures, GST_PLUGIN_PATH="", GST_REGISTRY=self.path("registry")), "intrinsicdecomp")
        with open("/dev/full", "wb") as full:
            self.expect_failure(self.run_it(pictures, out=full), "cannot write")

    def test_no_pictures(self):
        result = self.run_it(b"")
        self.assertEqual((result.returncode, result.stdout), (0, b""), result.stderr)


class Python(Example):
    def start(self, *words):
        return subprocess.Popen([sys.executable, str(EXAMPLES / "repaint.py"), *map(str, words)], stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True)

    def run_it(self, *words):
        with self.start(*words) as process:
            out, errors = process.communicate(timeout=support.LIMIT)
        return subprocess.CompletedProcess(words, process.returncode, out, errors)

    def test_paints(self):
        clip, out = self.clip(8), self.path("out.mkv")
        result = self.run_it(clip, *RED, BLUE, out)
        self.assertEqual(result.returncode, 0, result.stderr)
        before, after = support.read_video(clip), support.read_video(out)
        self.assertEqual(len(after), 8)
        for a, b in zip(before, after):
            self.assertAlmostEqual(a[0], b[0], delta=0.002)
            self.expect_painted(a, b)

    def test_interrupt_ends_the_file_properly(self):
        out = self.path("out.mkv")
        process = self.start(self.clip(3000, pattern="ball"), *RED, BLUE, out)
        try:
            self.assertTrue(support.pump(support.LIMIT, lambda: os.path.exists(out) and os.path.getsize(out) > 20000))
            process.send_signal(signal.SIGINT)
            _, errors = process.communicate(timeout=support.LIMIT)
        finally:
            process.kill()
        self.assertEqual(process.returncode, 0, errors)
        self.assertIn(len(support.read_video(out)), range(1, 3000))

    def test_bad_input(self):
        out = self.path("out.mkv")
        self.expect_failure(self.run_it("/none.mkv", 1, 1, BLUE, out), "/none.mkv")
        self.assertFalse(os.path.exists(out))
        self.expect_failure(self.run_it(__file__, 1, 1, BLUE, out), "repaint.py:")
        self.expect_failure(self.run_it(self.clip(2), 1, 1, "blue", out), "invalid literal", status=2)
        self.expect_failure(self.run_it(self.clip(2), 1, 1, BLUE, "/none/out.mkv"), "repaint.py:")
        self.expect_failure(self.run_it("one word"), "OUT.mkv", status=2)


unittest.main(verbosity=2)

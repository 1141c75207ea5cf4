# SPDX-License-Identifier: LGPL-2.1-or-later
"""Effects on a clip of GStreamer Editing Services, rendered by ges-launch-1.0."""
import shutil
import subprocess
import unittest

import support

if not shutil.which("ges-launch-1.0"):
    support.skip("ges-launch-1.0 is missing: install ges1.0-tools")


class Ges(support.Case):
    def render(self, clip, *effects):
        out = self.path("out.webm")
        words = [word for effect in effects for word in ("+effect", effect)]
        result = subprocess.run(["ges-launch-1.0", "--track-types=video", "--format=video/webm:video/x-vp8", f"--outputuri={out}",
                                 "--video-caps=video/x-raw,width=160,height=120,framerate=10/1", "+clip", clip, *words],
                                capture_output=True, text=True, timeout=support.LIMIT)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        return support.read_video(out)

    def setUp(self):
        super().setUp()
        self.source = self.clip(10)
        self.plain = self.render(self.source)
        self.assertGreaterEqual(len(self.plain), 9)

    def test_recolor(self):
        frames = self.render(self.source,
                             "intrinsicdecomp ! intrinsicrecolor key=0xffc00000 target=0xff2040c0 tolerance=0.9 ! intrinsiccompose")
        self.assertEqual(len(frames), len(self.plain))
        for frame in frames:
            red, _, blue = support.color(frame, 125, 30)
            self.assertGreater(blue, red + 60, "the red bar is not blue")
            red, _, blue = support.color(frame, 34, 30)
            self.assertGreater(red, blue + 60, "the yellow bar changed")

    def test_two_effects(self):
        frames = self.render(self.source, 'intrinsicedit layer=shading effect="videobalance brightness=-0.3"',
                             "intrinsicdecomp ! intrinsicrecolor key=0xffc00000 target=0xff2040c0 tolerance=0.9 ! intrinsiccompose")
        self.assertEqual(len(frames), len(self.plain))
        for before, after in zip(self.plain, frames):
            self.assertLess(sum(support.color(after, 34, 30)), sum(support.color(before, 34, 30)) - 30, "no darker light")
            red, _, blue = support.color(after, 125, 30)
            self.assertGreater(blue, red + 30, "the red bar is not blue")


unittest.main(verbosity=2)

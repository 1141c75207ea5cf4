# SPDX-License-Identifier: LGPL-2.1-or-later
"""First steps and editing: each launch line shows a picture that differs from its footage, and each editor has a picture."""
import functools
import os
import re
import statistics
import subprocess
import sys
import unittest

import support
from gi.repository import Gst

sys.path.insert(0, str(support.ROOT / "docs"))
import make_guide_pictures as guides  # noqa: E402

NO_EDITORS = {"compose", "decomp", "decompthesis", "split"}
# Our elements that a build without OpenCV or Assimp lacks.
OPTIONAL = {"intrinsictexture", "materialclone"}
OURS = re.compile("intrinsic|globalintrinsic|limematerial|rgbd")


def editors():
    """Editors that have a page."""
    names = {path.stem for path in (support.ROOT / "docs" / "reference" / "elements").glob("intrinsic*.md")}
    return names - {"intrinsic" + name for name in NO_EDITORS}


def missing_elements(recipe):
    """Elements of a recipe, its effects included, that this machine lacks: none of our plugins, unless built without their libraries."""
    words = [word.removeprefix("effect=").split()[0] for line in recipe.lines for word in line]
    names = {word for word in words if re.fullmatch(r"[a-z]\w+", word)} - {guides.SHOWN}
    return sorted(name for name in names if not Gst.ElementFactory.find(name) and (name in OPTIONAL or not OURS.match(name)))


def samples(frame):
    """Each 31st pixel's levels of each channel."""
    return [frame[2][channel::3 * 31] for channel in range(3)]


def variation(frame):
    """Largest standard deviation of a channel, levels of 255; 0 for a frame of one color."""
    return max(map(statistics.pstdev, samples(frame)))


def difference(one, other):
    """Mean absolute difference of two frames, levels of 255; that of other sizes is infinite."""
    if one[:2] != other[:2]:
        return float("inf")
    return statistics.fmean(abs(a - b) for x, y in zip(samples(one), samples(other)) for a, b in zip(x, y))


class Guides(unittest.TestCase):
    def setUp(self):
        os.chdir(support.ROOT)  # from which the pages' lines start

    def test_each_line_shows_a_picture_of_its_own(self):
        @functools.cache
        def footage(source, seconds):
            return guides.take_frame([*source, "!", *guides.TAKEN], seconds)

        ran = 0
        for name, recipes in guides.read_pages().items():
            for number, recipe in enumerate(recipes, 1):
                if lacking := missing_elements(recipe):
                    print(f"{name}, line {number}: skipped; missing: {', '.join(lacking)}")
                    continue
                with self.subTest(name=name, line=number):
                    # What follows a scene, a material or bounced light begins after some frames; the others are quicker to try at once.
                    for seconds in (0, .3, guides.SECONDS):
                        before, after = footage(tuple(recipe.source), seconds), guides.shown(recipe, seconds)
                        if difference(before, after) > .3 and variation(after) > 5:
                            break
                    else:
                        self.fail(f"difference from the footage {difference(before, after):.2f}, variation {variation(after):.2f}")
                    ran += 1
        self.assertGreater(ran, 0)

    def test_the_pages_are_complete(self):
        entries = guides.read_pages()
        for page in guides.PAGES:
            text = (guides.GUIDES / f"{page}.md").read_text()
            names = [name for name in entries if name.startswith(page)]
            self.assertEqual(len(names), text.count("](../images" + "/"), f"{page}: a picture has no launch lines below it")
            self.assertEqual({f"{page}/{path.stem}" for path in (guides.PICTURES / page).iterdir()}, set(names),
                             "pictures: run docs/make_guide_pictures.py")
        words = {word for recipes in entries.values() for recipe in recipes for line in recipe.lines for word in line}
        self.assertEqual(editors() - words, set(), "editors without a picture")

    def test_the_listing_is_what_gst_inspect_prints(self):
        command, listing = re.findall(r"```\n(.*?)```", (guides.GUIDES / "first-steps.md").read_text(), re.DOTALL)[:2]
        self.assertTrue(command.startswith("gst-inspect-1.0 "), command)
        self.assertIn(listing, subprocess.run(command.split(), capture_output=True, text=True, check=True).stdout)

    def test_bad_lines(self):
        frame = guides.TAKEN
        with self.assertRaisesRegex(guides.LineError, "no element"):
            guides.take_frame(["videotestsrc", "!", "nosuchelement", "!", *frame], 0)
        with self.assertRaisesRegex(guides.LineError, "(?s).*filesrc location=/none"):
            guides.take_frame(["filesrc", "location=/none", "!", "decodebin", "!", *frame], 0)
        with self.assertRaisesRegex(guides.LineError, "no frame at 2 s"):
            guides.take_frame(["videotestsrc", "num-buffers=2", "!", *frame], 2)
        with self.assertRaisesRegex(guides.LineError, "filesink location=/none/written"):
            guides.run_to_end(["videotestsrc", "num-buffers=2", "!", "filesink", "location=/none/written"])

    def test_frames_that_are_no_pictures(self):
        bars = guides.take_frame(["videotestsrc", "!", *guides.TAKEN], 0)
        blue = guides.take_frame(["videotestsrc", "pattern=blue", "!", *guides.TAKEN], 0)
        self.assertEqual((variation(blue), difference(bars, bars)), (0, 0))
        self.assertGreater(min(variation(bars), difference(bars, blue)), 20)


unittest.main(verbosity=2)

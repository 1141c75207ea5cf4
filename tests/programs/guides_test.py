# SPDX-License-Identifier: LGPL-2.1-or-later
"""The gallery: each of its launch lines shows a frame that differs from the footage, and each editor has a picture."""
import os
import re
import sys
import unittest

import support
from gi.repository import Gst

sys.path.insert(0, str(support.ROOT / "docs"))
import make_gallery  # noqa: E402

NO_EDITORS = {"compose", "decomp", "decompthesis", "merge", "split"}


def editors():
    """Editors that have a page."""
    names = {path.stem for path in (support.ROOT / "docs" / "reference" / "elements").glob("intrinsic*.md")}
    return names - {"intrinsic" + name for name in NO_EDITORS}


def missing_elements(line):
    """Elements of a line, its effects included, that this machine lacks: none of our plugins, unless built without OpenCV."""
    text = " ".join(line).replace("effect=", "! ")
    names = {part.split()[0] for part in text.split(" ! ") if re.match(r"[a-z]\w+( |$)", part)}
    return sorted(name for name in names if not Gst.ElementFactory.find(name)
                  and (name == "intrinsictexture" or not re.match("intrinsic|globalintrinsic", name)))


class Gallery(unittest.TestCase):
    def setUp(self):
        os.chdir(support.ROOT)  # from which the page's lines start

    def test_each_line_shows_an_edited_frame(self):
        entries, ran = make_gallery.read_page(), 0
        for name, lines in entries.items():
            for number, line in enumerate(lines, 1):
                lacking = make_gallery.missing_packages([line]) + missing_elements(line)
                if lacking:
                    print(f"{name}, line {number}: skipped; missing: {', '.join(lacking)}")
                    continue
                with self.subTest(name=name, line=number):
                    # globalintrinsic has colors of bounced light after some frames; the others are quicker to try at once.
                    for seconds in (0, make_gallery.SECONDS):
                        before, after = make_gallery.footage(line, seconds), make_gallery.shown(line, seconds)
                        self.assertEqual(before[:2], after[:2])
                        if before[2] != after[2]:
                            break
                    self.assertTrue(before[2] != after[2], "the frame is as before")
                    ran += 1
        self.assertGreater(ran, 0)

    def test_the_page_is_complete(self):
        page, entries = make_gallery.PAGE.read_text(), make_gallery.read_page()
        self.assertEqual(len(entries), page.count("]" + "(../images/gallery/"), "a picture has no launch lines below it")
        for name in entries:
            self.assertTrue((make_gallery.PICTURES / f"{name}.jpg").exists(), f"{name}: run docs/make_gallery.py {name}")
        words = {word for lines in entries.values() for line in lines for word in line}
        self.assertEqual(editors() - words, set(), "editors without a picture")
        files = {word.partition("=")[2] for word in words if word.startswith("location=/")}
        self.assertEqual(files, set(make_gallery.read_sources()), "the page's table of footage")

    def test_bad_lines(self):
        frame = make_gallery.TAKEN
        with self.assertRaisesRegex(make_gallery.LineError, "no element"):
            make_gallery.take_frame(["videotestsrc", "!", "nosuchelement", "!", *frame], 0)
        with self.assertRaisesRegex(make_gallery.LineError, "(?s).*filesrc location=/none"):
            make_gallery.take_frame(["filesrc", "location=/none", "!", "decodebin", "!", *frame], 0)
        with self.assertRaisesRegex(make_gallery.LineError, "no frame at 2 s"):
            make_gallery.take_frame(["videotestsrc", "num-buffers=2", "!", *frame], 2)
        self.assertEqual(make_gallery.missing_packages([["filesrc", "location=/none.png"]]), ["the package of /none.png"])


unittest.main(verbosity=2)

#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A file whose size and frame rate change twice, through the programs that take files: each frame arrives, in its size."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import serve_test
import web_test
from gi.repository import Gst

SCRIPTS = serve_test.SCRIPTS
ENCODERS = "x264enc tune=zerolatency", "openh264enc"
PARTS = ((160, 120, 10), (208, 160, 30), (160, 120, 10))
TRANSCODE = SCRIPTS.parent / "transcode" / "inverse-transcode"
FRAMES = 8  # of each part


def run_line(line):
    """Runs a launch line to its end."""
    pipeline = Gst.parse_launch(line)
    pipeline.set_state(Gst.State.PLAYING)
    message = pipeline.get_bus().timed_pop_filtered(serve_test.LIMIT * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
    pipeline.set_state(Gst.State.NULL)
    if message is None or message.type == Gst.MessageType.ERROR:
        raise RuntimeError(f"{line}: {message.parse_error() if message else 'does not end'}")


def sizes_of(folder):
    """Bytes of the files of a folder, in the order of their names."""
    return [path.stat().st_size for path in sorted(pathlib.Path(folder).iterdir())]


class Change(serve_test.Case):
    def setUp(self):
        encoder = next((line for line in ENCODERS if Gst.ElementFactory.find(line.split()[0])), None)
        if not encoder:
            self.skipTest("there is no encoder for H.264")
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.encoder, self.clip = encoder, f"{self.folder}/changes.ts"
        self.make(FRAMES)

    def make(self, frames):
        """The file, with so many frames of each part."""
        parts = " ".join(f"videotestsrc num-buffers={frames} pattern=ball ! video/x-raw,format=I420,width={w},height={h},framerate={rate}/1 ! {self.encoder} ! "
                         "h264parse config-interval=-1 ! video/x-h264,stream-format=byte-stream,alignment=au ! c." for w, h, rate in PARTS)
        run_line(f"{parts} concat name=c ! mpegtsmux ! filesink location={self.clip}")

    def ends(self, *words, **environment):
        """Runs a program to its end; returns what it printed."""
        got = subprocess.run([str(word) for word in words], env={**os.environ, **environment}, capture_output=True, text=True, timeout=serve_test.LIMIT, check=False)
        self.assertEqual(got.returncode, 0, got.stdout + got.stderr)
        return got.stdout + got.stderr

    def made(self, name):
        folder = f"{self.folder}/{name}"
        os.mkdir(folder)
        return folder

    def test_playbin(self):
        folder = self.made("shown")
        self.ends(SCRIPTS / "playbin", self.clip, "reflectance", SINK=f"videoconvert ! video/x-raw,format=GRAY8 ! multifilesink location={folder}/%05d sync=false")
        self.assertEqual(sizes_of(folder), [w * h for w, h, _ in PARTS for _ in range(FRAMES)])

    def test_rtp(self):
        folder = self.made("sent")
        self.ends(SCRIPTS / "rtp-out", self.clip, SINK=f"rtpvp8depay ! vp8dec ! multifilesink location={folder}/%05d")
        self.assertEqual(sizes_of(folder), [w * h * 3 // 2 for w, h, _ in PARTS for _ in range(FRAMES)])

    def test_hls(self):
        out = f"{self.folder}/out"
        self.ends(SCRIPTS / "hls", self.clip, out)
        segments, seen = sorted(pathlib.Path(out).glob("*.ts")), self.made("seen")
        run_line("concat name=c ! h264parse ! avdec_h264 ! video/x-raw,format=I420 ! "
                 f"multifilesink location={seen}/%05d " + " ".join(f"filesrc location={path} ! tsdemux ! c." for path in segments))
        self.assertEqual(sizes_of(seen), [w * h * 3 // 2 for w, h, _ in PARTS for _ in range(FRAMES)])

    def test_rtsp(self):
        server = self.start(SCRIPTS / "rtsp", self.clip, "--port", "0", source="")
        client = serve_test.Client(server.stdout.readline().strip(), "tcp")
        self.addCleanup(client.close)
        self.wait(lambda: len(client.sizes) >= len(PARTS) or server.poll() is not None)
        self.assertEqual(client.sizes, [(w, h) for w, h, _ in PARTS])

    def test_web(self):
        if not shutil.which("chromium"):
            self.skipTest("Chromium is missing: install chromium")
        self.make(80)
        page = web_test.Web(methodName="open")
        self.addCleanup(page.doCleanups)
        server = page.serve(self.clip, source="")
        _, told = page.open(server)
        seen = [told["sizes"]]
        while len(seen) < len(PARTS):
            sizes = json.loads(server.stdout.readline())["sizes"]
            if sizes[0] == sizes[1] and sizes != seen[-1]:
                seen.append(sizes)
        self.assertEqual(seen, [[[w, h], [w, h]] for w, h, _ in PARTS])

    def test_transcode(self):
        """One size for the whole of a file, and a line that says so."""
        for ending in ("mkv", "webm", "mp4", "mov"):
            with self.subTest(ending):
                out, seen = f"{self.folder}/out.{ending}", self.made(f"seen {ending}")
                said = self.ends(TRANSCODE, self.clip, "-o", out, "--", "intrinsicdecomp")
                self.assertIn("change from 160x120 to 208x160", said)
                run_line(f"filesrc location={out} ! decodebin ! videoconvert ! video/x-raw,format=I420 ! multifilesink location=\"{seen}/%05d\"")
                self.assertEqual(sizes_of(seen), [160 * 120 * 3 // 2] * len(PARTS) * FRAMES)


if __name__ == "__main__":
    unittest.main(verbosity=2)

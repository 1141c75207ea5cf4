# SPDX-License-Identifier: LGPL-2.1-or-later
"""The program as it is started: its exit status, what it writes, and how it ends."""
import os
import signal
import subprocess
import sys
import unittest

import support

DISPLAY = support.Display()
unittest.addModuleCleanup(DISPLAY.close)
support.need_gtk()
CLOSE_BUTTON = (1341, 26)  # of a window at its first size, without a window manager


class Program(support.Case):
    def start(self, *words, **environment):
        environment = {**os.environ, "PYTHONPATH": support.PLAYER, **environment}
        process = subprocess.Popen([sys.executable, "-m", "inverse_play", *words], env=environment,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(lambda: (process.kill(), process.communicate()) if process.poll() is None else None)
        return process

    def run_it(self, *words, **environment):
        process = self.start(*words, **environment)
        _, errors = process.communicate(timeout=support.LIMIT)
        self.assertNotIn("Traceback", errors)
        self.assertNotIn("CRITICAL", errors)
        return process.returncode, errors

    def wait_for_file(self, path, size):
        self.assertTrue(support.pump(support.LIMIT, lambda: os.path.exists(path) and os.path.getsize(path) > size), path)

    def test_a_file_to_its_end(self):
        out = self.path("out.mkv")
        status, errors = self.run_it(self.clip(30), "--record", out, "--close-at-end", "--edit",
                                     "intrinsicrecolor key=0xffc00000 target=0xff00c000 tolerance=0.9")
        self.assertEqual(status, 0, errors)
        frames = support.read_video(out)
        self.assertEqual(len(frames), 30)
        red, green, _ = support.color(frames[-1], 125, 40)
        self.assertGreater(green, red + 60)

    def test_a_file_that_is_cut_off(self):
        for frames in (60, 12):
            path, out = self.clip(frames, pattern="snow"), self.path("out.mkv")
            with open(path, "r+b") as file:
                file.truncate(os.path.getsize(path) // 2)
            status, errors = self.run_it(path, "--record", out, "--close-at-end")
            self.assertEqual(status, 1)
            self.assertIn("cut off", errors)
            self.assertGreater(len(support.read_video(out)), frames // 6)

    def test_a_camera_that_vanishes(self):
        out = self.path("out.mkv")
        status, errors = self.run_it("videotestsrc is-live=true ! video/x-raw,width=160,height=120 ! "
                                     "identity error-after=15", "--record", out, "--close-at-end")
        self.assertEqual(status, 1)
        self.assertIn("identity", errors)
        self.assertGreater(len(support.read_video(out)), 1)  # a slow machine leaves out some

    def test_a_disk_that_is_full(self):
        os.symlink("/dev/full", self.path("full.mkv"))
        status, errors = self.run_it(self.clip(20), "--record", self.path("full.mkv"), "--close-at-end")
        self.assertEqual(status, 1)
        self.assertIn("the disk is full", errors)

    def test_a_window_that_closes_while_recording(self):
        for ends, close in enumerate((lambda p: p.send_signal(signal.SIGTERM), lambda p: p.send_signal(signal.SIGINT),
                                      lambda p: self.xdotool("key", "ctrl+q"),
                                      lambda p: self.xdotool("mousemove", *CLOSE_BUTTON, "click", 1))):
            out = self.path(f"out{ends}.mkv")
            process = self.start("videotestsrc is-live=true pattern=snow ! video/x-raw,width=320,height=240",
                                 "--record", out)
            self.wait_for_file(self.path(f"out{ends}.part.mkv"), 200000)
            close(process)
            _, errors = process.communicate(timeout=support.LIMIT)
            self.assertEqual(process.returncode, 0, errors)
            self.assertGreater(len(support.read_video(out)), 3)

    def xdotool(self, *words):
        subprocess.run(["xdotool", "mousemove", "700", "400", *map(str, words)], check=True)

    def test_without_a_display(self):
        status, errors = self.run_it("test", DISPLAY="")
        self.assertEqual(status, 1)
        self.assertIn("no window can be shown", errors)


if __name__ == "__main__":
    unittest.main()

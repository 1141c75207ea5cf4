# SPDX-License-Identifier: LGPL-2.1-or-later
"""Batches of inverse-transcode, and captures of a light stage, under a real Slurm with four virtual nodes, one of which dies."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time
import unittest

import virtual_cluster
from case import ROOT, SKIPPED, Case, streams_of


class Slurm(Case):
    def setUp(self):
        super().setUp()
        self.cluster = virtual_cluster.VirtualCluster(self.path("slurm"), timeout=5, array=11)
        self.addCleanup(self.cluster.close)

    def run_it(self, *words, **options):
        return super().run_it(*words, env=self.cluster.env, parts=True, **options)

    def results(self):
        self.run_it("--batch", "b", "--status", "--report", "report.json", "--quiet")
        with open(self.path("report.json"), encoding="utf-8") as read:
            return json.load(read)["files"]

    def test_a_node_dies(self):
        names = [f"clip {k}.mkv" for k in range(16)]
        self.clip("in/" + names[0], frames=600)
        for name in names[1:]:
            shutil.copy(self.path("in/" + names[0]), self.path("in/" + name))
        said = self.run_it("--batch", "b", "--chunk", "8", "--divide-shots", "--out", "out", "--slurm", "in", "--", "identity", "sleep-time=6000")
        self.assertIn("32 tasks to do, and 16 to join chunks", said)
        # Four to an element, since an array has ten at most.
        self.assertEqual(len([job for job in self.cluster.jobs() if job.endswith("inverse-work")]), 8)
        end = time.monotonic() + 60
        while not any(" R node3 " in job for job in self.cluster.jobs()) or len(os.listdir(self.path("b/done"))) < 2:
            self.assertLess(time.monotonic(), end)
            time.sleep(0.1)
        self.assertGreater(self.cluster.kill_node(3), 1)
        self.assertIn("running", self.run_it("--batch", "b", "--status", status=1))
        self.cluster.wait(200)
        results = self.results()
        self.assertEqual({result["status"] for result in results}, {"done"})
        self.assertNotIn("node3", {result["host"] for result in results if result["output"].endswith("15.mkv")})
        self.assertEqual(sorted(os.listdir(self.path("out/in"))), sorted(names))
        for name in names[::5]:
            self.assertEqual(streams_of(self.path("out/in/" + name))[0][0].packets, 600)
        self.assertEqual([name for _, _, files in os.walk(self.path("out")) for name in files if name.endswith(".part")], [])
        self.assertIn("there is nothing to do", self.run_it("--batch", "b", "--slurm"))

    def test_wrong_options_and_limits(self):
        self.clip(frames=300)
        said = self.run_it("--batch", "b", "--out", "out", "--slurm", "--sbatch", "--partition=none", "clip.mkv", "--", "identity", "sleep-time=200000", status=2)
        self.assertIn("invalid partition", said)
        # Killed for its time, after which it is told of, and done when there is more of it.
        self.run_it("--batch", "b", "--slurm", "--sbatch", "--time=0:01 --signal=B:KILL@59")
        self.cluster.wait(150)
        self.assertRegex(self.run_it("--batch", "b", "--status", status=1), "ended without a result|its process ended")
        self.assertEqual(os.path.exists(self.path("out/clip.mkv")), False)

    def test_captures_of_a_light_stage(self):
        """The lines of the guide, with three recordings, of which one is no video."""
        self.need("lightstagesync", "olatrelight")
        guide = (ROOT / "docs/guides/cluster.md").read_text(encoding="utf-8")
        slurm, others, performances = re.findall("```\n(.*?)```", guide.split("## Captures of a light stage")[1].split("\n## ")[0], re.S)
        recordings, captures = slurm.split("\n\n")
        (pathlib.Path(self.folder) / "pipelines").symlink_to(ROOT / "pipelines")
        for folder in ("recordings", "performances"):
            os.mkdir(self.path(folder))
        # A panorama that is gray all over.
        with open(self.path("map.hdr"), "wb") as file:
            file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16 +X 32\n" + b"\x80" * 2048)
        self.shell("FRAMES=13 pipelines/virtual-stage performance:96 performances/take.mkv 64 48")
        self.shell("pipelines/virtual-stage static:96 recordings/a.mkv 64 48")
        shutil.copy(self.path("recordings/a.mkv"), self.path("recordings/b.mkv"))
        with open(self.path("recordings/c.mkv"), "wb") as file:
            file.write(b"no video")

        states = self.array(recordings)
        self.assertEqual(sorted(states), ["COMPLETED", "COMPLETED", "FAILED"])
        self.assertEqual(sorted(os.listdir(self.path("captures/a/camera_0/olat"))), [f"{k:03d}.exr" for k in range(96)])
        self.assertEqual(os.listdir(self.path("captures/c")), [])
        pictures = [self.path(f"captures/{name}/camera_0/relit.png") for name in "ab"]
        self.assertEqual(self.array(captures), ["COMPLETED"] * 2)
        made = [self.bytes_of(picture) for picture in pictures]
        self.assertTrue(made[0].startswith(b"\x89PNG") and made[0] == made[1])

        parallel, make = others.split("\n", 1)
        if shutil.which("parallel"):
            for picture in pictures:
                os.remove(picture)
            self.shell(parallel)
            self.assertEqual([self.bytes_of(picture) for picture in pictures], made)
        os.remove(pictures[1])
        before = os.stat(pictures[0]).st_mtime_ns
        self.shell(make)
        self.assertEqual(os.stat(pictures[0]).st_mtime_ns, before)
        self.assertEqual(self.bytes_of(pictures[1]), made[1])
        # Neither is a picture of what cannot be read, nor a part of one left.
        shutil.rmtree(self.path("captures/b/camera_0/olat"))
        os.remove(pictures[1])
        self.shell(make, status=2)
        self.assertEqual([name for name in os.listdir(self.path("captures/b/camera_0")) if "relit" in name], [])

        self.shell(performances.replace("inverse-transcode", str(ROOT / "transcode/inverse-transcode")))
        self.run_it("--batch", "jobs", "--slurm")
        self.cluster.wait(120)
        self.assertEqual(streams_of(self.path("relit/performances/take.mkv"))[0][0].packets, 5)

    def bytes_of(self, path):
        with open(path, "rb") as file:
            return file.read()

    def shell(self, text, status=0):
        done = subprocess.run(["bash", "-ec", text], cwd=self.folder, env=self.cluster.env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, timeout=200, check=False)
        self.assertEqual(done.returncode, status, done.stdout)
        return done.stdout

    def array(self, text):
        """States of the tasks of an array, when it is over."""
        number = re.search("Submitted batch job ([0-9]+)", self.shell(text))[1]
        self.cluster.wait(200)
        tasks = re.findall(r"JobState=(\w+)", self.shell(f"scontrol show job {number}"))
        self.assertGreater(len(tasks), 0)
        return tasks


if __name__ == "__main__":
    if virtual_cluster.missing():
        print(f"Slurm is missing ({', '.join(virtual_cluster.missing())}): install slurm-wlm, munge")
        sys.exit(SKIPPED)
    if not os.path.isdir("/sys/devices/system/cpu"):
        print("/sys is not mounted, by which slurmd counts processors")
        sys.exit(SKIPPED)
    unittest.main(verbosity=2)

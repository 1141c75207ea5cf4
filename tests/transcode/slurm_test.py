# SPDX-License-Identifier: LGPL-2.1-or-later
"""Batches of inverse-transcode under a real Slurm with four virtual nodes, one of which dies."""
import json
import os
import shutil
import sys
import time
import unittest

import virtual_cluster
from case import SKIPPED, Case, streams_of


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
        self.assertIn("32 tasks to do, and 16 that join chunks", said)
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
        self.assertRegex(self.run_it("--batch", "b", "--status", status=1), "ended without a word|its process ended")
        self.assertEqual(os.path.exists(self.path("out/clip.mkv")), False)


if __name__ == "__main__":
    if virtual_cluster.missing():
        print(f"Slurm is missing ({', '.join(virtual_cluster.missing())}): install slurm-wlm, munge")
        sys.exit(SKIPPED)
    unittest.main(verbosity=2)

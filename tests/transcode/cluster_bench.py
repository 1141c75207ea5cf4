# SPDX-License-Identifier: LGPL-2.1-or-later
"""Many short clips and one long one, by one process after the other and by a Slurm with four virtual nodes, of which one dies.

    tests/transcode/cluster_bench.py [--clips N] [--frames N] [--chunk SECONDS] [--jobs N] VIDEO [-- ELEMENTS]

In ./dev shell. Short clips are parts of the video, without loss. Prints wall and processor time (of the whole machine) and compares results."""
import argparse
import hashlib
import os
import subprocess
import sys
import tempfile
import time

import virtual_cluster
from case import ROOT
from raw_video import frames, read_raw, write_raw

TOOL = ROOT / "transcode" / "inverse-transcode"


def processor_time():
    """Of all cores since the machine started, in seconds, without waiting."""
    with open("/proc/stat", encoding="ascii") as read:
        user, nice, system = (int(word) for word in read.readline().split()[1:4])
    return (user + nice + system) / os.sysconf("SC_CLK_TCK")


class Timed:
    """Prints what was done, and how long it took."""

    def __init__(self, name):
        self.name = name

    def __enter__(self):
        self.wall, self.processor = time.monotonic(), processor_time()

    def __exit__(self, *_):
        print(f"{self.name:42} wall {time.monotonic() - self.wall:7.1f} s, processor {processor_time() - self.processor:7.1f} s", flush=True)


def make_clips(video, folder, count, length):
    """Cuts a video into clips of some frames, again from its begin when it ends."""
    found = list(read_raw(video, "video/x-raw,format=I420"))
    for clip in range(count):
        write_raw(os.path.join(folder, f"{clip:04}.mkv"), [found[(clip * length + k) % len(found)] for k in range(length)])


def pictures(path):
    """A hash of each frame."""
    return [hashlib.sha256(picture.tobytes()).digest() for _, picture in frames(path, 0)]


def main():
    words, chain = sys.argv[1:], ["intrinsicdecomp", "show=reflectance"]
    if "--" in words:
        words, chain = words[:words.index("--")], words[words.index("--") + 1:]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--clips", type=int, default=200)
    parser.add_argument("--frames", type=int, default=6)
    parser.add_argument("--chunk", default="5")
    parser.add_argument("--jobs", default="2")
    parser.add_argument("video")
    arguments = parser.parse_args(words)
    settings = ["--quiet", "--video", "ffv1", "--audio", "none"]
    with tempfile.TemporaryDirectory() as folder:
        clips, single, many, cluster = (os.path.join(folder, name) for name in ("clips", "single", "many", "cluster"))
        os.mkdir(clips)
        make_clips(arguments.video, clips, arguments.clips, arguments.frames)
        for jobs in ("1", arguments.jobs):
            with Timed(f"{arguments.clips} clips, --jobs {jobs}"):
                subprocess.run([TOOL, *settings, "--again", "--jobs", jobs, "--out", single, clips, "--", *chain], check=True)
        with Timed("long clip, undivided"):
            subprocess.run([TOOL, *settings, "--out", single, arguments.video, "--", *chain], check=True)
        slurm = virtual_cluster.VirtualCluster(cluster, nodes=4, cpus=1, timeout=10)
        try:
            batch = os.path.join(folder, "batch")
            division = ["--chunk", arguments.chunk, "--divide-shots"]
            with Timed("planned"):
                subprocess.run([TOOL, *settings, "--batch", batch, *division, "--out", many, clips, arguments.video, "--", *chain], check=True)
            with Timed("all by Slurm, of four nodes one dies"):
                subprocess.run([TOOL, "--batch", batch, "--slurm"], check=True, env=slurm.env)
                while len(os.listdir(os.path.join(batch, "done"))) < arguments.clips // 2:
                    time.sleep(0.5)
                slurm.kill_node(3)
                slurm.wait(3600)
        finally:
            slurm.close()
        print(subprocess.run([TOOL, "--batch", batch, "--status", "--quiet"], capture_output=True, text=True, check=False).stdout.strip())
        names = [os.path.join("clips", name) for name in sorted(os.listdir(clips))]
        same = sum(pictures(os.path.join(single, name)) == pictures(os.path.join(many, name)) for name in names)
        print(f"short clips with equal frames: {same} of {len(names)}")
        long = os.path.splitext(os.path.basename(arguments.video))[0] + ".mkv"
        one, other = pictures(os.path.join(single, long)), pictures(os.path.join(many, long))
        print(f"long clip: {len(one)} and {len(other)} frames, {sum(a == b for a, b in zip(one, other))} equal")


if __name__ == "__main__":
    main()

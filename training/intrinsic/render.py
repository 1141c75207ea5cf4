#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Renders scenes, many by one Blender, at the lowest priority: render.py --out FOLDER --first 0 --count 300.
Seeds whose sample or rejection exists are skipped, so it may be stopped and started again; the exit status is 0 if none is left."""
import argparse
import concurrent.futures
import os
import pathlib
import subprocess
import threading
import time

import sample

HERE = pathlib.Path(__file__).resolve().parent


def is_done(seed, args):
    return any((args.out / f"{seed}.{end}").exists() for end in ("npz", "rejected"))


def processor_time(pid):
    """Seconds that a process has used."""
    words = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


class Blender:
    """One Blender for some seeds; it is ended if one of them takes more than `timeout` seconds of a core."""

    def __init__(self, seeds, args):
        options = {"seeds": ",".join(map(str, seeds)), **{name: getattr(args, name) for name in ("out", "assets", "kind", "long", "samples", "threads", "views")}}
        command = ["nice", "-n", "19", "blender", "-b", "--factory-startup", "-noaudio", "-P", str(HERE / "scene/build.py"), "--"]
        command += [word for name, value in options.items() if value is not None for word in (f"--{name}", str(value))]
        environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", env=environment)
        self.since, self.timeout, self.late = 0, args.timeout, False
        threading.Thread(target=self.watch, daemon=True).start()

    def watch(self):
        while self.process.poll() is None:
            time.sleep(5)
            try:
                self.late = processor_time(self.process.pid) - self.since > self.timeout
            except OSError:
                return
            if self.late:
                self.process.kill()
                return

    def lines(self):
        for line in self.process.stdout:
            if line.startswith("scene "):
                self.since = processor_time(self.process.pid)
            yield line.rstrip()


def render(seeds, args):
    """Renders those of some scenes that are left, one after the other. A scene that ends Blender is rejected, and another Blender goes on."""
    while True:
        left = [seed for seed in seeds if not is_done(seed, args)]
        if not left:
            return
        blender, last = Blender(left, args), ""
        for line in blender.lines():
            if line.startswith("scene "):
                print(line, flush=True)
            elif "Error" in line:
                last = line
        status = blender.process.wait()
        left = [seed for seed in left if not is_done(seed, args)]
        if not left:
            return
        if status < 0 and not blender.late and -status not in (6, 11):  # but for abort and fault
            print(f"{left[0]} was interrupted by signal {-status}", flush=True)
            return
        print(sample.reject(args.out, left[0], time.process_time(), "too slow" if blender.late else last or f"blender ended with status {status}"), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--assets", type=pathlib.Path, help="folder with textures/ and models/ (README.md); without it all is procedural")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--kind", help="only this kind (KINDS in scene/build.py)")
    parser.add_argument("--views", type=int, default=2, help="cameras in a scene, at most")
    parser.add_argument("--long", type=int, default=352, help="pixels of the long side; the short one has 3/4 of them")
    parser.add_argument("--samples", type=int, default=5, help="a pixel, of each of the two renderings of a round, outdoors; indoors 2.5 times as many")
    parser.add_argument("--threads", type=int, default=1, help="of each Blender")
    parser.add_argument("--jobs", type=int, default=1, help="Blenders at a time")
    parser.add_argument("--batch", type=int, default=10, help="scenes that one Blender renders")
    parser.add_argument("--timeout", type=int, default=600, help="seconds of a core for one scene")
    args = parser.parse_args()
    os.nice(19 - os.nice(0))
    args.out.mkdir(parents=True, exist_ok=True)
    last = args.first + args.count
    batches = [range(first, min(first + args.batch, last)) for first in range(args.first, last, args.batch)]
    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        list(pool.map(lambda seeds: render(seeds, args), batches))
    left = sum(not is_done(seed, args) for seed in range(args.first, last))
    if left:
        raise SystemExit(f"{left} scenes were interrupted; start it again")


if __name__ == "__main__":
    main()

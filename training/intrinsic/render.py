#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Renders scenes, one Blender each, at the lowest priority: render.py --out FOLDER --first 0 --count 300.
Seeds whose sample or rejection exists are skipped, so it may be stopped and started again; the exit status is 0 if none is left."""
import argparse
import concurrent.futures
import json
import os
import pathlib
import subprocess
import tempfile
import time

import sample

HERE = pathlib.Path(__file__).resolve().parent


def take(folder, out, start):
    """The sample of one camera's renderings to OUT/NUMBER.npz, or OUT/NUMBER.rejected with the reason. Returns what happened."""
    number = json.loads((folder / "scene.json").read_text())["seed"]
    try:
        result = sample.from_renderings(folder)
        meta = result["meta"]
        meta["seconds"] = round(time.time() - start, 1)  # since the scene's start
        sample.write(out / f"{number}.npz", result)
        return f"{number} {meta['kind']} {meta['seconds']} s, noise {' '.join('%s %.3f' % (g['kind'], g['noise']) for g in meta['groups'])}"
    except (sample.Rejected, ValueError) as error:
        return reject(out, number, start, error)


def reject(out, number, start, error):
    (out / f"{number}.rejected").write_text(json.dumps({"seed": number, "reason": str(error)}))
    return f"{number} rejected after {time.time() - start:.0f} s: {error}"


def is_done(seed, args):
    return any((args.out / f"{seed}.{end}").exists() for end in ("npz", "rejected"))


def render(seed, args):
    """Renders a scene and takes its samples. Returns what happened, or None if there was nothing to do."""
    if is_done(seed, args):
        return None
    start = time.time()
    with tempfile.TemporaryDirectory() as folder:
        options = {"seed": seed, "out": folder, **{name: getattr(args, name) for name in ("assets", "kind", "long", "samples", "threads", "views")}}
        command = ["nice", "-n", "19", "blender", "-b", "--factory-startup", "-noaudio", "-P", str(HERE / "scene/build.py"), "--"]
        command += [word for name, value in options.items() if value is not None for word in (f"--{name}", str(value))]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=args.timeout, env={**os.environ, "OMP_NUM_THREADS": "1"})
        except subprocess.TimeoutExpired as error:
            return reject(args.out, seed, start, error)
        if done.returncode < 0:
            return f"{seed} was interrupted by signal {-done.returncode}"
        views = sorted(path.parent for path in pathlib.Path(folder).glob("*/scene.json"))
        if not views:
            lines = [l for l in (done.stdout + done.stderr).splitlines() if "Error" in l or "rejected" in l]
            return reject(args.out, seed, start, lines[-1] if lines else f"blender ended with status {done.returncode}")
        return "\n".join(take(view, args.out, start) for view in views[::-1])  # the first last: it says that the scene is done


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--assets", type=pathlib.Path, help="folder with textures/ and models/ (README.md); without it all is procedural")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--kind", help="only this kind (KINDS in scene/build.py)")
    parser.add_argument("--views", type=int, default=2, help="cameras in a scene, at most")
    parser.add_argument("--long", type=int, default=352, help="pixels of the long side; the short one has 3/4 of them")
    parser.add_argument("--samples", type=int, default=14, help="a pixel, of each of the two renderings, outdoors; indoors 2.5 times as many")
    parser.add_argument("--threads", type=int, default=1, help="of each Blender")
    parser.add_argument("--jobs", type=int, default=1, help="Blenders at a time")
    parser.add_argument("--timeout", type=int, default=1800, help="seconds for one scene, beside other work")
    args = parser.parse_args()
    os.nice(19 - os.nice(0))
    args.out.mkdir(parents=True, exist_ok=True)
    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        for text in pool.map(lambda seed: render(seed, args), range(args.first, args.first + args.count)):
            if text:
                print(text, flush=True)
    left = sum(not is_done(seed, args) for seed in range(args.first, args.first + args.count))
    if left:
        raise SystemExit(f"{left} scenes were interrupted; start it again")


if __name__ == "__main__":
    main()

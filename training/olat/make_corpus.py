#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Renders subjects to disk: make_corpus.py --subjects 300 [--threads 2]. Goes on where it was stopped. On many hosts each takes a part:
sbatch --array=0-49 --wrap 'training/olat/make_corpus.py --part $SLURM_ARRAY_TASK_ID/50'.

OUT/corpus/train: subjects under stages of 96 to 331 lights, whose gradients are of all lights, with --keep of their OLATs:
those of the wide-baseline input, and random ones. OUT/corpus/validation and OUT/corpus/test: held-out shapes under the geodesic
stage of 331 lights; all OLATs of a test subject are kept. Sample i of a seed is the same on any machine.
"""
import argparse
import concurrent.futures
import pathlib
import time

import numpy as np

from olat import corpus


def stage_of(random, index):
    """What it is, directions and share of the sphere of a light, of a stage for training. Every seventh has no lights behind."""
    stage, directions, share = whole_stage_of(random)
    if index % 7 == 6:
        stage["behind"] = float(random.uniform(-0.4, 0.2))
        directions = directions[directions[:, 2] > stage["behind"]]
        stage["lights"] = len(directions)
    return stage, directions, share


def whole_stage_of(random):
    kind = random.random()
    if kind < 0.45:
        return {"kind": "geodesic", "lights": 331, "share": 1 / 362}, corpus.geodesic(), 1 / 362
    count = 331 if kind < 0.65 else int(random.integers(96, 250))
    directions = corpus.fibonacci(count, corpus.rotation(random))
    return {"kind": "fibonacci", "lights": count, "share": 1 / count}, directions, 1 / count


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=corpus.ROOT / "out/olat")
    parser.add_argument("--subjects", type=int, default=300, help="for training")
    parser.add_argument("--tests", type=int, default=4, help="held out for scores, 331 OLATs each")
    parser.add_argument("--validations", type=int, default=6, help="held out for curves, 24 OLATs each")
    parser.add_argument("--keep", type=int, default=64, help="OLATs kept of a subject for training")
    parser.add_argument("--samples", type=int, default=4, help="rays a pixel")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--heads", default=corpus.HEADS, help="folder of ICT FaceKit; '' for busts only")
    parser.add_argument("--part", default="0/1", help="N/M: every Mth subject from the Nth, from 0")
    args = parser.parse_args()
    part, parts = (int(n) for n in args.part.split("/"))
    if not 0 <= part < parts:
        parser.error(f"--part takes N/M with N below M, not {args.part}")
    library = corpus.Corpus(args.heads)
    print("heads of ICT FaceKit and procedural busts" if library.has_heads else "procedural busts only", flush=True)
    folder = args.out / "corpus"

    def one(job):
        split, index = job
        path = folder / split / f"{index:04d}.npz"
        if path.exists():
            return
        random = np.random.default_rng((args.seed, {"train": 0, "validation": 1, "test": 2}[split], index))
        if split == "train":
            stage, directions, share = stage_of(random, index)
            chosen = np.concatenate([corpus.wide_baseline(directions), random.permutation(len(directions))])
            first = np.sort(np.unique(chosen, return_index=True)[1])[:args.keep]
            keep, flags, samples = np.sort(chosen[first]), 0, args.samples
        else:
            stage, directions, share = {"kind": "geodesic", "lights": 331, "share": 1 / 362}, corpus.geodesic(), 1 / 362
            keep = np.arange(331)[slice(None) if split == "test" else slice(index % 14, None, 14)]
            flags, samples = corpus.TEST | corpus.CALM, 9 if split == "test" else 4
        # Test and validation subjects are different ones of the test split.
        sample = library.render(args.seed + 1000 * (split == "validation"), index, directions, share, keep, flags,
                                samples=samples)
        if (sample["alpha"] > 0.5).mean() < 0.05:
            return
        corpus.store(path.parent, path.stem, corpus.exposed(sample), directions[keep], stage)

    jobs = [("validation", i) for i in range(args.validations)] + [("train", i) for i in range(min(40, args.subjects))]
    jobs += [("test", i) for i in range(args.tests)] + [("train", i) for i in range(40, args.subjects)]
    jobs = jobs[part::parts]
    started = time.monotonic()
    with concurrent.futures.ThreadPoolExecutor(args.threads) as pool:
        for n, _ in enumerate(pool.map(one, jobs), 1):
            if n % 10 == 0:
                print(f"{n} of {len(jobs)} subjects, {(time.monotonic() - started) / n:.1f} s each", flush=True)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Mixes path-traced samples (../intrinsic) into files that fit_edge_prior and check_edge_prior read (scene_files.hpp).
Writes OUT/fit and OUT/held-out: every fifth seed is held out. Every second photograph of a sample has other paint."""
import argparse
import pathlib
import sys

import numpy as np

TRAINING = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TRAINING), str(TRAINING / "intrinsic")]
import mix
import sample
import scene_file


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--samples", type=pathlib.Path, required=True, help="folder of SEED.npz")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--mixes", type=int, default=4, help="photographs of each sample")
    parser.add_argument("--size", type=int, default=2, help="divides the resolution: 1, 2 or 4")
    args = parser.parse_args()
    for path in sorted(args.samples.glob("*.npz"), key=lambda p: int(p.stem)):
        folder = args.out / ("held-out" if sample.held_out(path) else "fit")
        folder.mkdir(parents=True, exist_ok=True)
        for seed in range(args.mixes):
            out = folder / f"{int(path.stem):06d}-{seed}.scene"
            if out.exists():
                continue
            scene = sample.read(path)
            if seed % 2:
                scene = mix.repaint(scene, np.random.default_rng([seed, int(path.stem)]))
            m = mix.mix(scene, seed, args.size)
            scene_file.write(out, m["I"], m["R"], m["E"], m["mask"])


if __name__ == "__main__":
    main()

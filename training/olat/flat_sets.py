#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Held-out subjects of make_corpus.py as flat dumps that the benchmarks of relighting read: flat_sets.py [--out out/olat].

Writes OUT/sets/NAME.f32 of every subject of OUT/corpus/test (tests/lightstage/bench/olat_set.hpp: pictures under both gradients, the
mask three times, the lights; in the scale in which gradients are sums over lights).
"""
import argparse
import pathlib

import numpy as np

from olat import corpus, datasets

SHARE = 1 / 362  # of the sphere: a light of the geodesic stage, which lacks the floor's 31


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=corpus.ROOT / "out/olat")
    args = parser.parse_args()
    folder = args.out / "sets"
    folder.mkdir(parents=True, exist_ok=True)
    for item in datasets.held_out(args.out / "corpus/test"):
        mask = np.broadcast_to(item.alpha, item.a.shape)
        frames = np.stack([item.a, item.b, mask, *(SHARE * item.olats)]).transpose(0, 2, 3, 1)
        words = " ".join(f"{c:.9g}" for c in item.directions.ravel())
        path = folder / (item.name.replace(" ", "-") + ".f32")
        with open(path, "wb") as file:
            file.write(f"F32 {frames.shape[2]} {frames.shape[1]} 3 {len(frames)} {words}\n".encode())
            file.write(np.ascontiguousarray(frames, "<f4").tobytes())
        print(path)


main()

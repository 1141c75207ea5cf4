#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Couples as files for training/edges (couples.hpp): scenes.py FOLDER OUT writes SEED.light.scene and SEED.paint.scene of each SEED.npz."""
import pathlib
import sys

TRAINING = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TRAINING), str(TRAINING / "intrinsic")]
import mix
import numpy as np
import scene_file

MIN_LIGHT, MIN_PAINT = 0.08, 0.01  # spread of the ln ratio of light; mean size of that of paint


def couples_of(path):
    """(what was added, picture before, picture after, ratio of light, mask) of each couple of a file; linear light."""
    triple = np.load(path)
    pictures, usable, base = mix.linear(triple["pictures"] / 255), triple["usable"], int(triple["on_lit"])
    light = triple["light"].astype(np.float32)
    if light.mean(-1).std() > MIN_LIGHT:
        yield "light", pictures[0], pictures[1], np.exp(light), usable[0] & usable[1]
    if np.abs(triple["paint"].astype(np.float32)).mean() > MIN_PAINT:
        yield "paint", pictures[base], pictures[2], np.ones_like(light), usable[2] & usable[base]


def main(folder, out):
    out = pathlib.Path(out)
    out.mkdir(parents=True, exist_ok=True)
    for path in sorted(pathlib.Path(folder).glob("*.npz")):
        for added, before, after, ratio, mask in couples_of(path):
            scene_file.write(out / f"{path.stem}.{added}.scene", after, before, ratio, mask)


if __name__ == "__main__":
    main(*sys.argv[1:])

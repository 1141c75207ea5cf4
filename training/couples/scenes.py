#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Couples as files for training/edges (couples.hpp): scenes.py FOLDER OUT writes SEED.light.scene and SEED.paint.scene of each SEED.npz."""
import pathlib
import sys
import typing

TRAINING = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TRAINING), str(TRAINING / "intrinsic")]
import mix
import numpy as np
import scene_file

MIN_LIGHT, MIN_PAINT = 0.08, 0.01  # spread of the ln ratio of light; mean size of that of paint


class Triple(typing.NamedTuple):
    """pictures: three, linear light; light: ratio; usable: of the picture before any couple, and of both of each; base: that of the paint."""

    pictures: np.ndarray
    light: np.ndarray
    usable: tuple
    base: int
    has_light: bool
    has_paint: bool


def read(path):
    data = np.load(path)
    usable, base, light = data["usable"], int(data["on_lit"]), data["light"].astype(np.float32)
    return Triple(mix.linear(data["pictures"] / 255), np.exp(light), (usable[0], usable[0] & usable[1], usable[base] & usable[2]), base,
                  bool(light.mean(-1).std() > MIN_LIGHT), bool(np.abs(data["paint"].astype(np.float32)).mean() > MIN_PAINT))


def couples_of(path):
    """(what was added, picture before, picture after, ratio of light, mask) of each couple of a file; linear light."""
    triple = read(path)
    if triple.has_light:
        yield "light", triple.pictures[0], triple.pictures[1], triple.light, triple.usable[1]
    if triple.has_paint:
        yield "paint", triple.pictures[triple.base], triple.pictures[2], np.ones_like(triple.light), triple.usable[2]


def main(folder, out):
    out = pathlib.Path(out)
    out.mkdir(parents=True, exist_ok=True)
    for path in sorted(pathlib.Path(folder).glob("*.npz")):
        for added, before, after, ratio, mask in couples_of(path):
            scene_file.write(out / f"{path.stem}.{added}.scene", after, before, ratio, mask)


if __name__ == "__main__":
    main(*sys.argv[1:])

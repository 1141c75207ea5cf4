#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Pictures of the corpus to look at, and its statistics beside those of the evaluation set: contact_sheet.py.

Rows of image, mask, D, specular layer and mirror image, written to OUT/contact-{train,painted,everyday,whole,test,materials}.png.
"""
import argparse
import pathlib

import numpy as np
import torch
from PIL import Image

from lime import corpus, datasets, encoding


def srgb(linear):
    return encoding.to_srgb(torch.from_numpy(np.ascontiguousarray(linear, np.float32))).numpy()


def strip(item):
    """What the set knows of an item, 3 × h × w pictures side by side."""
    linear = ((item.shading, 0.6), (item.layer, 1), (item.mirror, 0.5))
    parts = [item.image, item.mask, *(srgb(x * gain) for x, gain in linear if x is not None)]
    return np.concatenate([np.broadcast_to(x, item.image.shape) for x in parts], 2)


def sheet(items, path):
    rows = [strip(i) for i in items]
    half = len(rows) // 2
    picture = np.concatenate([np.concatenate(rows[:half], 1), np.concatenate(rows[half:2 * half], 1)], 2)
    Image.fromarray((picture.transpose(1, 2, 0) * 255 + 0.5).astype(np.uint8)).save(path)


def statistics(name, items):
    """Of items with an object."""
    items = [i for i in items if i.mask.any()]
    inside = [i.mask[0] > 0.5 for i in items]
    rows = {"sRGB inside": np.concatenate([i.image[:, m].mean(0) for i, m in zip(items, inside)]),
            "share clipped": [float((i.image[:, m] >= 1).any(0).mean()) for i, m in zip(items, inside)],
            "share of picture": [m.mean() for m in inside]}
    if items[0].layer is not None:
        rows.update({"mean D": [i.shading[:, m].mean() for i, m in zip(items, inside)],
                     "specular share": [i.layer[0][m].mean() / max(i.image_linear[:, m].mean(), 1e-6)
                                        for i, m in zip(items, inside)],
                     "layer, 99 %": [np.percentile(i.layer[0][m], 99) for i, m in zip(items, inside)],
                     "mirror, 99 %": [np.percentile(i.mirror[0][m], 99) for i, m in zip(items, inside)]})
    if items[0].shininess is not None:
        rows.update({"md": np.array([i.diffuse for i in items]).ravel(), "alpha": [i.alpha for i in items],
                     "log10 s": np.log10([i.shininess for i in items])})
    print(f"{name} ({len(items)}): percentiles 5, 25, 50, 75, 95")
    for label, x in rows.items():
        print(f"  {label:17} " + " ".join(f"{q:7.3f}" for q in np.percentile(x, (5, 25, 50, 75, 95))))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=corpus.ROOT / "out/lime")
    parser.add_argument("--data", type=pathlib.Path, default=datasets.DATA)
    parser.add_argument("--hdri", default=None)
    parser.add_argument("--count", type=int, default=200)
    args = parser.parse_args()
    samples = corpus.Corpus(args.hdri)
    sets = {name: datasets.synthetic(samples, 5, args.count, flag) for name, flag in (
        ("train", 0), ("painted", corpus.MAY_BE_PAINTED), ("everyday", corpus.EVERYDAY), ("whole", corpus.WHOLE_FRAME), ("test", corpus.TEST))}
    if (args.data / "materials").is_dir():
        sets["materials"] = datasets.materials(args.data / "materials")
    for name, items in sets.items():
        sheet(items[:24], args.out / f"contact-{name}.png")
        statistics(name, items)


main()

#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Scores a checkpoint, or exported networks: evaluate.py [--checkpoint out/lime/checkpoint.pt | models/lime]. Prints Markdown and writes it with --report.

Sets: held-out samples of the corpus, of a seed of their own (but with --seed); the rendered evaluation set `materials` and its
path-traced GGX part; MIT's real objects with measured specular images. The mask is the predicted one, but for the layers of the path-traced and the real
objects, which lie on black. Pictures of predictions are written to OUT/predictions-*.png.
"""
import argparse
import functools
import pathlib
import re

import numpy as np
from PIL import Image

from lime import corpus, datasets, scores
from lime.networks import load_checkpoint
from lime.tables import table

THESIS = {"bin_exact": 0.4507, "bin_adjacent": 0.8519, "diffuse_mse": 0.0674, "alpha_mse": 0.2158,
          "log_shininess_mse": 0.3073, "mask_iou": 0.9983}


def picture(items, predictions, path):
    """Input, predicted mask, true and predicted specular layer, true and predicted mirror image, predicted diffuse image."""
    rows = []
    for item, p in list(zip(items, predictions))[:16]:
        def gray(x):
            return np.broadcast_to(datasets.to_srgb8(np.zeros_like(item.mask) if x is None else x), item.image.shape)

        diffuse = datasets.to_srgb8((item.image_linear - p["layer"]) * item.mask)
        rows.append(np.concatenate([item.image, np.broadcast_to(p["found"], item.image.shape), gray(item.layer),
                                    gray(p["layer"]), gray(item.mirror), gray(p["mirror"]), diffuse], 2))
    half = (len(rows) + 1) // 2
    rows += [np.zeros_like(rows[0])] * (2 * half - len(rows))
    whole = np.concatenate([np.concatenate(rows[:half], 1), np.concatenate(rows[half:], 1)], 2)
    Image.fromarray((whole.transpose(1, 2, 0) * 255 + 0.5).astype(np.uint8)).save(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=corpus.ROOT / "out/lime")
    parser.add_argument("--checkpoint", type=pathlib.Path, help="of train.py, or a folder of exported networks: models/lime")
    parser.add_argument("--data", type=pathlib.Path, default=datasets.DATA)
    parser.add_argument("--hdri", default=None)
    parser.add_argument("--count", type=int, default=4000, help="held-out samples of the corpus")
    parser.add_argument("--seed", type=int, default=datasets.REPORT, help="of the held-out samples")
    parser.add_argument("--only", default="", help="regular expression: of the sets whose titles have it")
    parser.add_argument("--report", type=pathlib.Path)
    args = parser.parse_args()
    networks = load_checkpoint(args.checkpoint or args.out / "checkpoint.pt")
    samples = corpus.Corpus(args.hdri)

    @functools.lru_cache(1)
    def held_out(count, flags=0):
        return datasets.synthetic(samples, args.seed, count, corpus.TEST | flags)

    part = args.count // 4
    sets = {"Held-out shapes and maps": (lambda: held_out(args.count), False)}  # what loads them; whether their mask is the true one
    for title, stops in (("two stops darker", -2), ("a stop darker", -1), ("a stop brighter", 1)):
        sets[f"Of the first, {title}"] = (lambda stops=stops: datasets.exposed(held_out(args.count)[:part], stops)), False
    for title, flags in (("every fourth object painted", corpus.MAY_BE_PAINTED), ("some of them pale, marked or matte", corpus.EVERYDAY),
                         ("in whole frames", corpus.WHOLE_FRAME)):
        sets[f"As the first, {title}"] = (lambda flags=flags: held_out(part, flags)), False
    for title, load, folder, true_mask in (
            ("`materials`, Blinn-Phong", datasets.materials, "materials", False),
            ("`materials`, GGX path-traced", datasets.ggx, "materials/cycles_ggx", True),
            ("MIT objects, real", datasets.mit, "mit", True),
            ("The same, white all over", functools.partial(datasets.mit, color=(0.8, 0.8, 0.8)), "mit", True),
            ("The same, green all over", functools.partial(datasets.mit, color=(0.2, 0.5, 0.3)), "mit", True)):
        if (args.data / folder).is_dir():
            sets[title] = functools.partial(load, args.data / folder), true_mask
    parts = []
    for number, (title, (load, true_mask)) in enumerate(sets.items()):
        if not re.search(args.only, title):
            continue
        items = load()
        predictions = scores.predict(networks, items, true_mask=true_mask)
        rows = {"networks": scores.score(items, predictions), **scores.baselines(items)}
        if number == 0:
            rows["thesis, on its own corpus"] = THESIS
        parts.append(f"### {title} ({len(items)})\n\n" + table(rows))
        if items[0].shininess is not None and len(items) >= 100:
            shares = scores.confusion(items, predictions)
            parts.append("Bins, true by row, in %:\n\n```\n" +
                         "\n".join(" ".join(f"{100 * x:3.0f}" for x in row) for row in shares) + "\n```")
        picture(items, predictions, args.out / f"predictions-{number}.png")
    if not parts:
        raise SystemExit(f"--only {args.only}: there are {', '.join(sets)}")
    text = "\n\n".join(parts) + "\n"
    print(text)
    if args.report:
        args.report.write_text(text)


main()

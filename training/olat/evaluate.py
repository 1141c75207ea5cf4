#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Scores checkpoints: evaluate.py [--checkpoint late=out/olat/checkpoint.pt …]. Prints Markdown and writes it with --report.

Sets: subjects of the corpus that were held out (331 lights), heads rendered by Cycles (`olat_head`), real faces (`yale_faces`).
None of them was ever trained on. Pictures of true and predicted OLAT images are written to OUT/olats-*.png.
"""
import argparse
import pathlib

import numpy as np
import torch
from PIL import Image

from olat import corpus, datasets, scores
from olat.networks import load_checkpoint

COLUMNS = (("l1", "ℓ1, linear", "{:.2f}"), ("l1_srgb", "ℓ1, sRGB", "{:.2f}"), ("ms_ssim", "MS-SSIM", "{:.4f}"),
           ("relit", "relit, %", "{:.2f}"))
SHOWN = ((0.0, 0.1, 1.0), (-0.8, 0.3, 0.5), (0.8, 0.3, 0.5), (0.0, 0.9, 0.4), (0.1, -0.6, 0.8), (0.97, 0.2, -0.1),
         (-0.7, 0.3, -0.6))


def table(rows):
    lines = ["| | " + " | ".join(title for _, title, _ in COLUMNS) + " |", "|---" * (len(COLUMNS) + 1) + "|"]
    for name, row in rows.items():
        lines.append(f"| {name} | " + " | ".join(form.format(row[key]) for key, _, form in COLUMNS) + " |")
    return "\n".join(lines)


def picture(item, predictions, path):
    """Rows: truth, then each prediction. Columns: gradient images (first row only), then lights from several sides."""
    chosen = [int((item.directions @ np.array(d)).argmax()) for d in SHOWN]

    def strip(first, olats):
        cells = [torch.from_numpy(np.ascontiguousarray(c, np.float32)) for c in (*first, *(olats[chosen] * item.gain))]
        return torch.cat([scores.to_srgb(c) for c in cells], 2).numpy()

    rows = [strip((1.4 * item.a, 1.4 * item.b), item.olats)]
    for p in predictions:
        rows.append(strip((item.a + item.b, np.einsum("n,nchw->chw", scores.environments(item.directions)[0], p)), p))
    Image.fromarray((np.concatenate(rows, 1).transpose(1, 2, 0) * 255 + 0.5).astype(np.uint8)).save(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=corpus.ROOT / "out/olat")
    parser.add_argument("--checkpoint", nargs="*", metavar="NAME=FILE", help="of train.py, or folders of exported networks (network=models/olat); by default network=OUT/checkpoint.pt")
    parser.add_argument("--data", type=pathlib.Path, default=datasets.DATA)
    parser.add_argument("--corpus", type=pathlib.Path, help="held-out subjects; OUT/corpus/test")
    parser.add_argument("--scale", type=float, default=1, help="of the pictures: heads larger or smaller than those of training")
    parser.add_argument("--report", type=pathlib.Path)
    args = parser.parse_args()
    torch.set_num_threads(2)
    models = {"cosine lobe": "cosine-lobe"}
    for pair in args.checkpoint or [f"network={args.out / 'checkpoint.pt'}"]:
        name, path = pair.split("=", 1)
        models[name] = load_checkpoint(path)

    sets = {"Held-out subjects of the corpus, 331 lights": datasets.held_out(args.corpus or args.out / "corpus/test")}
    for title, load, name in (("Heads rendered by Cycles, 96 lights (`olat_head`)", datasets.olat_head, "olat_head"),
                              ("Real faces, lights in front only (`yale_faces`)", datasets.yale, "yale_faces")):
        if (args.data / name).is_dir():
            sets[title] = load(args.data / name)
    parts = []
    for number, (title, items) in enumerate((t, i) for t, i in sets.items() if i):
        rows = {name: [] for name in models}
        single = {}
        for item in items if args.scale == 1 else [i.scaled(args.scale) for i in items]:
            predictions = {}
            for name, model in models.items():
                predictions[name] = scores.predict(model, item)
                rows[name].append(scores.score(item, predictions[name]))
            single[item.name] = {name: r[-1] for name, r in rows.items()}
            picture(item, predictions.values(), args.out / f"olats-{number}-{item.name.replace(' ', '-')}.png")
        means = {name: {k: float(np.mean([s[k] for s in r])) for k in r[0]} for name, r in rows.items()}
        parts.append(f"### {title}: {len(items)}\n\n" + table(means))
        parts.append("By subject, ℓ1 linear / MS-SSIM: " + "; ".join(
            f"{subject} " + ", ".join(f"{name} {s['l1']:.2f} / {s['ms_ssim']:.3f}" for name, s in by.items())
            for subject, by in single.items()) + ".")
    text = "\n\n".join(parts) + "\n"
    print(text)
    if args.report:
        args.report.write_text(text)


if __name__ == "__main__":
    main()

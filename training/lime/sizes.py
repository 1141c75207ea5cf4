#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Error of the three U-Nets by the size of the square that they look at: sizes.py [--count 200] [--bench network-bench].

The same held-out samples, rendered once at 384 × 384 and averaged down to each size; layers that come out are brought to
128 × 128 before they are compared, inside the true mask, which specular and mirror networks get. With --bench, times of the
project's own engine beside them (models as `models/lime` builds them, --models FOLDER). Prints Markdown.
"""
import argparse
import pathlib
import re
import subprocess

import torch
from torch.nn import functional

from lime import corpus, datasets, encoding
from lime.networks import load_checkpoint

SIZES = (64, 96, 128, 192)
RENDERED, COMPARED = 384, 128


def at_size(image, size):
    return functional.interpolate(image, size=(size, size), mode="area")


def compared(image):
    return functional.interpolate(image, size=(COMPARED, COMPARED), mode="bilinear", align_corners=False)


def errors(networks, batch, size):
    """Sums over the batch: IoU of masks, mean absolute differences of the codes of layers."""
    image, mask = encoding.to_srgb(at_size(encoding.to_linear(batch.image), size)), (at_size(batch.mask, size) > 0.5).float()
    found = compared(networks.find_mask(image)) > 0.5
    specular = networks.find_specular(image, mask)
    mirror = networks.find_mirror(specular, mask)
    true = at_size(batch.mask, COMPARED) > 0.5
    out = {"mask": ((found & true).sum((1, 2, 3)) / (found | true).sum((1, 2, 3)).clamp(min=1)).sum()}
    for name, code, truth in (("specular", specular, batch.layer), ("mirror", mirror, batch.mirror)):
        difference = (compared(code) - encoding.encode(at_size(truth, COMPARED))).abs() * true
        out[name] = (difference.sum((1, 2, 3)) / true.sum((1, 2, 3)).clamp(min=1)).sum()
    return {name: float(value) for name, value in out.items()}


def milliseconds(bench, model, size):
    text = subprocess.run([bench, "--size", str(size), "--runs", "15", model], check=True, capture_output=True, text=True)
    return float(re.search(r"x \d+: ([\d.]+) ms", text.stdout).group(1))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--checkpoint", type=pathlib.Path, default=corpus.ROOT / "out/lime/checkpoint.pt", help="of train.py, or a folder of exported networks: models/lime")
    parser.add_argument("--hdri", default=None)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--bench", help="the program network-bench")
    parser.add_argument("--models", type=pathlib.Path, default=corpus.ROOT / "build/models/lime")
    args = parser.parse_args()
    networks = load_checkpoint(args.checkpoint)
    samples = corpus.Corpus(args.hdri)
    sums = {size: {} for size in SIZES}
    with torch.no_grad():
        for first in range(0, args.count, 8):
            batch = corpus.Batch(samples.render(datasets.CHOICES, first, min(8, args.count - first), RENDERED, corpus.TEST))
            for size in SIZES:
                for name, value in errors(networks, batch, size).items():
                    sums[size][name] = sums[size].get(name, 0) + value / args.count
    print("| square | mask IoU | specular, MAE of code | mirror, MAE of code |" + (" ms: segmentation, specular, mirror |" if args.bench else ""))
    print("|---|---|---|---|" + ("---|" if args.bench else ""))
    for size in SIZES:
        row = [f"{size} × {size}", f"{sums[size]['mask']:.1%}", f"{sums[size]['specular']:.4f}", f"{sums[size]['mirror']:.4f}"]
        if args.bench:
            row.append(", ".join(f"{milliseconds(args.bench, str(args.models / (n + '.net')), size):.1f}"
                                 for n in ("segmentation", "specular", "mirror")))
        print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()

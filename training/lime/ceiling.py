#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""How well shininess could be told if layers were true: ceiling.py [--samples 24000]. Prints Markdown and writes OUT/ceiling.md.

ExponentNet anew, side by side on the same samples, which are seen several times, half of them in a mirror: on the true
specular layer; on what a picture can show of it, clipped where the picture is white; on the latter and the true mirror
image. What the shipped networks reach with layers of their own is in evaluate.py's report.
"""
import argparse
import os
import pathlib

os.environ.setdefault("OMP_WAIT_POLICY", "passive")

import numpy as np  # noqa: E402
import torch  # noqa: E402
from torch.nn import functional  # noqa: E402

from lime import corpus, datasets, encoding  # noqa: E402
from lime.networks import SIZES, PooledEncoder  # noqa: E402
import descent  # noqa: E402

BATCH, RATE = 64, 1e-3
# The layers that each sees, as columns of `layers`.
VARIANTS = {"true specular layer": [0], "the same, clipped as the picture is": [1], "clipped, and true mirror image": [1, 2]}


def layers(batch):
    """n × 3: codes of the specular layer, of what is left of it in a picture that ends at white, and of the mirror image."""
    rest = 1 - batch.ambient.view(-1, 1, 1, 1) - batch.diffuse[:, :, None, None] * batch.shading
    seen = torch.minimum(batch.layer * batch.tint, rest.clamp(min=0)).mean(1, keepdim=True)
    return torch.cat([batch.layer_code, encoding.encode(seen) * batch.mask, batch.mirror_code], 1)


def render(samples, seed, count, flags):
    stream = corpus.Stream(samples, seed, 0, BATCH, SIZES["standard"]["input"], flags, threads=2)
    found, bins = np.empty((count, 3, 128, 128), np.float16), np.empty(count, np.int64)
    for first in range(0, count, BATCH):
        batch = next(stream)
        n = min(BATCH, count - first)
        found[first:first + n], bins[first:first + n] = layers(batch)[:n].numpy(), batch.bin[:n].numpy()
    stream.close()
    return found, bins


def score(network, columns, found, bins):
    """Cross-entropy, shares of bins that are right, and right or next to right."""
    network.eval()
    with torch.no_grad():
        scores = torch.cat([network(torch.from_numpy(found[i:i + 100, columns]).float()) for i in range(0, len(bins), 100)])
    truth = torch.from_numpy(bins)
    away = (encoding.choose_bin(torch.softmax(scores, 1)) - truth).abs()
    return float(functional.cross_entropy(scores, truth)), float((away == 0).float().mean()), float((away <= 1).float().mean())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=corpus.ROOT / "out/lime")
    parser.add_argument("--hdri", default=None)
    parser.add_argument("--samples", type=int, default=24000)
    parser.add_argument("--times", type=int, default=4, help="that each is seen")
    parser.add_argument("--seed", type=int, default=4)
    parser.add_argument("--count", type=int, default=1000, help="held-out samples")
    args = parser.parse_args()
    torch.manual_seed(args.seed)
    torch.set_num_threads(2)
    order = np.random.default_rng(args.seed)
    samples = corpus.Corpus(args.hdri)
    found, bins = render(samples, args.seed, args.samples, 0)
    size = SIZES["standard"]
    networks = {name: PooledEncoder(len(columns), encoding.BINS, size["exponent"], size["input"])
                for name, columns in VARIANTS.items()}
    optimizers = {name: torch.optim.AdamW(network.parameters(), weight_decay=1e-2) for name, network in networks.items()}
    each, step = args.samples // BATCH, 0
    for time in range(args.times):
        for part in np.split(order.permutation(each * BATCH), each):
            x, truth = torch.from_numpy(found[np.sort(part)]).float(), torch.from_numpy(bins[np.sort(part)])
            x = x.flip(3) if order.random() < 0.5 else x
            rate = descent.rate_of(RATE, step / (each * args.times), step)
            for name, network in networks.items():
                with torch.autocast("cpu", torch.bfloat16):
                    scores = network(x[:, VARIANTS[name]])
                descent.step(optimizers[name], functional.cross_entropy(scores.float(), truth), rate)
            step += 1
        print(f"seen {time + 1} of {args.times} times", flush=True)
    held_out = render(samples, datasets.CHOICES, args.count, corpus.TEST)
    lines = [f"| {args.samples} samples, {args.times} times | bin exact | exact or next | cross-entropy |", "|---|---|---|---|"]
    for name, network in networks.items():
        entropy, exact, near = score(network, VARIANTS[name], *held_out)
        lines.append(f"| {name} | {exact:.1%} | {near:.1%} | {entropy:.3f} |")
    text = "\n".join(lines) + "\n"
    print(text)
    (args.out / "ceiling.md").write_text(text)


main()

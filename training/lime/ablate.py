#!/usr/bin/env python3
"""Ablations of thesis Table 6.1: ablate.py [--samples 40000]. Prints Markdown and writes OUT/ablations.md.

ExponentNet and AlbedoNet anew, in four variants side by side on the very same samples in the same order: with the rendering
loss and MirrorNet, without the rendering loss, without MirrorNet, and with regression of log10 s in place of bins.
SegmentationNet, SpecularNet and MirrorNet are those of the checkpoint for all of them and do not learn, so that what is
compared is what each part gives to those that decide. Scored as evaluate.py does. Two other orders of samples with --seed.
"""
import argparse
import math
import os
import pathlib

os.environ.setdefault("OMP_WAIT_POLICY", "passive")

import torch  # noqa: E402

from lime import corpus, datasets, scores, stages  # noqa: E402
from lime.networks import SIZES, Networks, load_checkpoint  # noqa: E402

BATCH, RATE = 32, 1e-3
# Of each: options of Networks, and whether the rendering loss is used.
VARIANTS = {"whole": ({}, True), "no rendering loss": ({}, False), "no MirrorNet": ({"use_mirror": False}, True),
            "regression": ({"regress": True}, True)}
COLUMNS = (("bin_exact", "bin exact", "{:.1%}"), ("bin_adjacent", "exact or next", "{:.1%}"),
           ("diffuse_mse", "MSE m_d", "{:.4f}"), ("alpha_mse", "MSE α", "{:.4f}"),
           ("log_shininess_mse", "MSE log10 s", "{:.4f}"))


class Variant:
    """Networks whose heads are new and whose other networks are those of `trunk`, and what teaches the heads."""

    def __init__(self, trunk, perceptual, **options):
        self.perceptual = perceptual
        self.networks = Networks(**options)
        for part in ("segmentation", "specular", "mirror"):
            setattr(self.networks, part, getattr(trunk, part))
        self.heads = [p for part in ("exponent", "albedo") for p in getattr(self.networks, part).parameters()]
        self.optimizer = torch.optim.Adam(self.heads, lr=RATE)

    def train(self):
        self.networks.eval()
        self.networks.exponent.train()
        self.networks.albedo.train()

    def step(self, found, batch, rate):
        for group in self.optimizer.param_groups:
            group["lr"] = rate
        total = sum(stages.heads_losses(self.networks, batch, *found, self.perceptual).values())
        self.optimizer.zero_grad(set_to_none=True)
        total.backward()
        torch.nn.utils.clip_grad_norm_(self.heads, 1.0)
        self.optimizer.step()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=corpus.ROOT / "out/lime")
    parser.add_argument("--checkpoint", type=pathlib.Path, help="of train.py, or a folder of exported networks: models/lime")
    parser.add_argument("--data", type=pathlib.Path, default=datasets.DATA)
    parser.add_argument("--hdri", default=None)
    parser.add_argument("--samples", type=int, default=40000)
    parser.add_argument("--seed", type=int, default=3)
    parser.add_argument("--count", type=int, default=1000, help="held-out samples")
    args = parser.parse_args()
    torch.manual_seed(args.seed)
    torch.set_num_threads(2)
    trunk = load_checkpoint(args.checkpoint or args.out / "checkpoint.pt")
    samples = corpus.Corpus(args.hdri)
    variants = {name: Variant(trunk, perceptual, **options) for name, (options, perceptual) in VARIANTS.items()}
    for v in variants.values():
        v.train()
    stream = corpus.Stream(samples, args.seed, 0, BATCH, SIZES["standard"]["input"], corpus.TAUGHT)
    steps = args.samples // BATCH
    for step in range(steps):
        batch = next(stream)
        with torch.no_grad():
            found = stages.find_layers(trunk, batch)
        rate = RATE * min(1, (step + 1) / 50) * (0.01 + 0.99 * 0.5 * (1 + math.cos(math.pi * step / steps)))
        for v in variants.values():
            v.step(found, batch, rate)
        if step % 100 == 0:
            print(f"{step * BATCH} samples", flush=True)
    stream.close()

    sets = {"Held-out shapes and maps": datasets.synthetic(samples, 1, args.count)}
    if (args.data / "materials").is_dir():
        sets["`materials`, Blinn-Phong"] = datasets.materials(args.data / "materials")
    parts = []
    for title, items in sets.items():
        rows = {name: scores.score(items, scores.predict(v.networks, items)) for name, v in variants.items()}
        rows["constant"] = scores.baselines(items)["constant"]
        lines = ["| | " + " | ".join(c[1] for c in COLUMNS) + " |", "|---" * (len(COLUMNS) + 1) + "|"]
        lines += [f"| {name} | " + " | ".join(form.format(row[key]) for key, _, form in COLUMNS) + " |"
                  for name, row in rows.items()]
        parts.append(f"### {title} ({len(items)})\n\n" + "\n".join(lines))
    text = "\n\n".join(parts) + "\n"
    print(text)
    (args.out / "ablations.md").write_text(text)


main()

#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Ablations of thesis Table 6.1: ablate.py [--samples 40000]. Prints Markdown and writes OUT/ablations.md.

ExponentNet and AlbedoNet anew, in variants side by side on the very same samples in the same order: ExponentNet with MirrorNet,
without, and with regression of log10 s in place of bins; AlbedoNet with the rendering loss and without, from the same first
weights. SegmentationNet, SpecularNet and MirrorNet are those of the checkpoint for all of them and do not learn, so that
what is compared is what each part gives to those that decide. Scored as evaluate.py does, and by what a viewer
sees of the albedos (scores.rendered_error). Other orders with --seed.
"""
import os

os.environ.setdefault("OMP_WAIT_POLICY", "passive")

import torch  # noqa: E402

from lime import ablations, corpus, stages  # noqa: E402
from lime.networks import INPUT, Networks  # noqa: E402
import descent  # noqa: E402

BATCH, RATE, TIMES = 32, 1e-3, 3  # TIMES that each sample is used


class Head:
    """One network that is new, among those of `networks`, and what teaches it."""

    def __init__(self, networks, part, terms):
        self.network, self.terms = getattr(networks, part), terms
        self.optimizer = torch.optim.Adam(self.network.parameters(), lr=RATE)
        self.network.train()

    def step(self, batch, rate):
        with torch.autocast("cpu", torch.bfloat16):
            total = sum(self.terms(batch).values())
        descent.step(self.optimizer, total, rate)


def prepare(trunk, seed):
    """Networks by variant, and the heads that are to learn. A network that is like that of `whole` is it."""
    variants, heads = {}, []
    for name, (options, perceptual) in ablations.VARIANTS.items():
        torch.manual_seed(seed)
        networks = Networks(**options).eval()
        for part in ("segmentation", "specular", "mirror"):
            setattr(networks, part, getattr(trunk, part))
        if name == "whole" or options:
            heads.append(Head(networks, "exponent", lambda b, n=networks: stages.exponent_terms(n, b, *b.found[1:])))
        else:
            networks.exponent = variants["whole"].exponent
        if name == "whole" or not perceptual:
            heads.append(Head(networks, "albedo", lambda b, n=networks, p=perceptual: stages.albedo_terms(n, b, *b.found[:2], p)))
        else:
            networks.albedo = variants["whole"].albedo
        variants[name] = networks
    return variants, heads


def main():
    args, trunk, samples, sets = ablations.begin(__doc__, 40000)
    variants, heads = prepare(trunk, args.seed)
    stream = corpus.Stream(samples, args.seed, 0, BATCH, INPUT, corpus.TAUGHT, twice=True)
    batches, steps = corpus.Again(stream, TIMES), args.samples // BATCH
    for step in range(steps):
        batch = next(batches)
        if not batch.found:
            with torch.autocast("cpu", torch.bfloat16):
                batch.found = stages.find_layers(trunk, batch)
        for head in heads:
            head.step(batch, descent.rate_of(RATE, step / steps, step))
        if step % 100 == 0:
            print(f"{step * BATCH} samples", flush=True)
    stream.close()
    ablations.report(variants, sets, args.out / "ablations.md")


main()

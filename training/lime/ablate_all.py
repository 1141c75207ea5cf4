#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Ablations of thesis Table 6.1, from end to end: ablate_all.py [--samples 250000]. Prints Markdown and writes OUT/ablations-all.md.

All networks but SegmentationNet, which is the checkpoint's, from random weights (the same for all variants) as in 6.5.4, in
variants side by side on the very same samples in the same order: each network apart, then the four in a row, then ExponentNet
and AlbedoNet on layers as each variant finds them. So a loss or a network that is left out is missing where it taught others, too: the
rendering loss to SpecularNet, MirrorNet to the layers that ExponentNet's loss goes through. Scored as ablate.py does. Other orders with --seed.
"""
import dataclasses
import os
import time
import weakref

os.environ.setdefault("OMP_WAIT_POLICY", "passive")

import torch  # noqa: E402

from lime import ablations, corpus, stages  # noqa: E402
from lime.networks import INPUT, Networks  # noqa: E402
import descent  # noqa: E402

# Stages in their order, pixels of their pictures, share of the samples. Small pictures are quick, as in train.py.
PLAN = (("specular", INPUT // 2, 0.32), ("specular", INPUT, 0.12), ("mirror", INPUT // 2, 0.12), ("mirror", INPUT, 0.04),
        ("albedo", INPUT, 0.06), ("exponent", INPUT, 0.06), ("chain-albedo", INPUT, 0.08), ("heads", INPUT, 0.20))


class Learner:
    """Networks of one variant in a stage."""

    def __init__(self, stage, networks, perceptual):
        self.stage, self.networks, self.perceptual = stage, networks, perceptual
        self.found = weakref.WeakKeyDictionary()  # its own layers of a batch that comes several times
        networks.eval()
        for part in stage.parts:
            getattr(networks, part).train()
        learning = [p for part in stage.parts for p in getattr(networks, part).parameters()]
        self.optimizer = torch.optim.Adam(learning, lr=stage.rate)

    def step(self, batch, rate):
        with torch.autocast("cpu", torch.bfloat16):
            if self.stage.times > 1:
                if batch not in self.found:
                    self.found[batch] = stages.find_layers(self.networks, batch)
                batch.found = self.found[batch]
            total = sum(stages.stage_losses(self.stage.name, self.networks, batch, self.perceptual).values())
        descent.step(self.optimizer, total, rate)


def alike(stage, name):
    """What tells a variant's networks from others' in a stage that teaches one apart: those of the same learn the same."""
    options, perceptual = ablations.VARIANTS[name]
    return {"mirror": True, "specular": perceptual, "albedo": perceptual, "exponent": str(options)}.get(stage, name)


def teach(stage, variants, samples, drawn, pixels, count, seed):
    """Goes through a stage with `count` samples from `drawn` on; the first that was not drawn yet."""
    first = {}  # by what is alike, the variant that learns for all of these
    for name in variants:
        first.setdefault(alike(stage.name, name), name)
    parts = {name: [p for p in stage.parts if variants[name].use_mirror or p != "mirror"] for name in variants}
    learners = [Learner(dataclasses.replace(stage, parts=parts[name]), variants[name], ablations.VARIANTS[name][1])
                for name in first.values()]
    batch = stage.batch * (INPUT // pixels) ** 2
    steps = max(count // batch, 1)
    stream = corpus.Stream(samples, seed, drawn, batch, pixels, corpus.TAUGHT, twice=True)
    batches, started = corpus.Again(stream, stage.times), time.monotonic()
    for step in range(steps):
        given = next(batches)
        for learner in learners:
            learner.step(given, descent.rate_of(stage.rate, step / steps, step))
    stream.close()
    for name, networks in variants.items():
        learned = variants[first[alike(stage.name, name)]]
        for part in parts[name] if learned is not networks else ():
            getattr(networks, part).load_state_dict(getattr(learned, part).state_dict())
    print(f"{stage.name} at {pixels}: {steps * batch} samples, {(time.monotonic() - started) / 60:.1f} minutes", flush=True)
    return stream.index


def main():
    args, known, samples, sets = ablations.begin(__doc__, 250000)
    drawn, variants = 0, {}
    for name, (options, _) in ablations.VARIANTS.items():
        torch.manual_seed(args.seed)
        variants[name] = Networks(**options)
        variants[name].segmentation = known.segmentation
    of = {stage.name: stage for stage in stages.STAGES}
    for name, pixels, share in PLAN:
        drawn = teach(of[name], variants, samples, drawn, pixels, int(share * args.samples), args.seed)
    ablations.report(variants, sets, args.out / "ablations-all.md", layers=True)


main()

#!/usr/bin/env python3
"""Ablations of thesis Table 6.1: ablate.py [--samples 40000]. Prints Markdown and writes OUT/ablations.md.

ExponentNet and AlbedoNet anew, in variants side by side on the very same samples in the same order: ExponentNet with MirrorNet,
without, and with regression of log10 s in place of bins; AlbedoNet with the rendering loss and without, from the same first
weights. SegmentationNet, SpecularNet and MirrorNet are those of the checkpoint for all of them and do not learn, so that
what is compared is what each part gives to those that decide. Scored as evaluate.py does, and by what a viewer
sees of the albedos (scores.rendered_error). Other orders with --seed.
"""
import argparse
import os
import pathlib

os.environ.setdefault("OMP_WAIT_POLICY", "passive")

import torch  # noqa: E402

from lime import corpus, datasets, scores, stages  # noqa: E402
from lime.networks import SIZES, Networks, load_checkpoint  # noqa: E402
from lime.tables import table  # noqa: E402
import descent  # noqa: E402

BATCH, RATE, TIMES = 32, 1e-3, 3  # TIMES that each sample is used
# Of each: options of Networks, and whether the rendering loss is used. A network that is like that of `whole` is it.
VARIANTS = {"whole": ({}, True), "no rendering loss": ({}, False), "no MirrorNet": ({"use_mirror": False}, True),
            "regression": ({"regress": True}, True)}


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
    """Networks by variant, and the heads that are to learn."""
    variants, heads = {}, []
    for name, (options, perceptual) in VARIANTS.items():
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
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=corpus.ROOT / "out/lime")
    parser.add_argument("--checkpoint", type=pathlib.Path, help="of train.py, or a folder of exported networks: models/lime")
    parser.add_argument("--data", type=pathlib.Path, default=datasets.DATA)
    parser.add_argument("--hdri", default=None)
    parser.add_argument("--samples", type=int, default=40000, help="each use of one counts, three of each")
    parser.add_argument("--seed", type=int, default=3)
    parser.add_argument("--count", type=int, default=1000, help="held-out samples")
    args = parser.parse_args()
    torch.set_num_threads(2)
    trunk = load_checkpoint(args.checkpoint or args.out / "checkpoint.pt")
    assert trunk.size == SIZES["standard"]["input"], "ablations are of the networks of standard size"
    samples = corpus.Corpus(args.hdri)
    # Pictures, and whether their mask is the true one, as in evaluate.py.
    sets = {"Held-out shapes and maps": (datasets.synthetic(samples, datasets.CHOICES, args.count), False)}
    if (args.data / "materials").is_dir():
        sets["`materials`, Blinn-Phong"] = (datasets.materials(args.data / "materials"), False)
    if (args.data / "materials/cycles_ggx").is_dir():
        sets["`materials`, GGX path-traced"] = (datasets.ggx(args.data / "materials/cycles_ggx"), True)
    variants, heads = prepare(trunk, args.seed)
    stream = corpus.Stream(samples, args.seed, 0, BATCH, SIZES["standard"]["input"], corpus.TAUGHT, twice=True)
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

    parts = []
    for title, (items, true_mask) in sets.items():
        found = {name: scores.predict(networks.eval(), items, true_mask=true_mask) for name, networks in variants.items()}
        rows = {name: scores.score(items, predictions) for name, predictions in found.items()}
        rows["constant"] = scores.baselines(items)["constant"]
        if items[0].alpha is not None:
            count = len(items)
            found["constant"] = [{"diffuse": sum(i.diffuse for i in items) / count, "alpha": sum(i.alpha for i in items) / count}] * count
            for name, predictions in found.items():
                rows[name]["rendered_mse"] = scores.rendered_error(
                    items, [p["diffuse"] for p in predictions], [p["alpha"] for p in predictions])
        parts.append(f"### {title} ({len(items)})\n\n" + table(rows, needed=rows["constant"]))
    text = "\n\n".join(parts) + "\n"
    print(text)
    (args.out / "ablations.md").write_text(text)


main()

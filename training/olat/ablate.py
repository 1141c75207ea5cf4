#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What each part gives, as thesis Table 7.1: ablate.py [--steps 800]. Prints Markdown and writes OUT/ablations.md.

Networks anew, side by side on the very same batches: whole; without the perceptual loss; without the alignment loss; without the
relighting loss; from three OLATs of wide baseline in place of gradient images; and with the direction fused early. --variants
chooses others, among them narrower ones; --keep writes networks for relight-curves. The OLATs of the batches are up to --shifts pixels off, as after a capture in which
somebody moved a little, which is what the alignment loss is for; scores are on OLATs in place. The DirectionNet of the
perceptual loss is the checkpoint's.
"""
import argparse
import os
import pathlib
import time

os.environ.setdefault("OMP_WAIT_POLICY", "passive")

import numpy as np  # noqa: E402
import torch  # noqa: E402

import export  # noqa: E402
from olat import corpus, datasets, samples, scores, teaching  # noqa: E402
from olat.networks import DirectionNet, network  # noqa: E402
import descent  # noqa: E402

RATE, CROPS, LIGHTS, SIZE = 2e-3, 3, 4, 96
GRADIENTS = {"fusion": "late", "input": "gradients"}
# Of each: the network, and what teaching.terms_of is called with.
VARIANTS = {"whole": (GRADIENTS, {}), "no photometric loss": (GRADIENTS, {"photometric": False}),
            "no perceptual loss": (GRADIENTS, {"perceptual": False}),
            "no alignment loss": (GRADIENTS, {"alignment": False}), "no relighting loss": (GRADIENTS, {"relighting": False}),
            "3-OLAT input": ({"fusion": "late", "input": "olats"}, {"inputs": "olats"}),
            "early fusion": ({"fusion": "early", "input": "gradients"}, {}),
            "early, half as wide": ({"fusion": "early", "input": "gradients", "width": 0.5}, {}),
            "half as wide": ({**GRADIENTS, "width": 0.5}, {}), "quarter as wide": ({**GRADIENTS, "width": 0.25}, {})}
TABLE = ("whole", "no photometric loss", "no perceptual loss", "no alignment loss", "no relighting loss", "3-OLAT input", "early fusion")


class Variant:
    def __init__(self, variant, options):
        self.variant, self.options = variant, {"alignment": True, **options}
        self.net = network(variant)
        self.optimizer = torch.optim.Adam(self.net.parameters(), lr=RATE)
        self.average, self.seconds = teaching.Average(self.net, 0.99), 0.0
        self.random = np.random.default_rng(4)

    def step(self, judge, batch, rate):
        started = time.process_time()
        terms = teaching.terms_of(self.net, judge, batch, self.random, **self.options)
        descent.step(self.optimizer, sum(terms.values()), rate)
        self.average.update(self.net)
        self.seconds += time.process_time() - started

    def finished(self):
        self.net.load_state_dict(self.average.state)
        return self.variant["input"], self.net.eval()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=corpus.ROOT / "out/olat")
    parser.add_argument("--data", type=pathlib.Path, default=datasets.DATA)
    parser.add_argument("--steps", type=int, default=800)
    parser.add_argument("--minutes", type=float, default=1e9, help="stop there, all after as many steps as were made")
    parser.add_argument("--variants", nargs="+", choices=list(VARIANTS), default=TABLE)
    parser.add_argument("--report", type=pathlib.Path, help="OUT/ablations.md")
    parser.add_argument("--keep", type=pathlib.Path, help="folder for the late variants' ONNX files, a folder each")
    parser.add_argument("--shifts", type=int, default=3)
    parser.add_argument("--seed", type=int, default=3)
    parser.add_argument("--threads", type=int, default=2)
    args = parser.parse_args()
    torch.set_num_threads(args.threads)
    judge = DirectionNet()
    judge.load_state_dict(torch.load(args.out / "checkpoint.pt", map_location="cpu")["judge"])
    judge.requires_grad_(False)
    subjects = [corpus.Subject(p) for p in corpus.stored(args.out / "corpus/train")]
    variants = {}
    for name in args.variants:
        variant, options = VARIANTS[name]
        torch.manual_seed(args.seed)
        variants[name] = Variant(variant, options)

    def make(number):
        random = np.random.default_rng((args.seed, number))
        return samples.draw(random, subjects, CROPS, LIGHTS, SIZE, SIZE, args.shifts, True)

    stream, started, made = samples.Stream(make), time.monotonic(), 0
    for made in range(1, args.steps + 1):
        progress = max(made / args.steps, (time.monotonic() - started) / (60 * args.minutes))
        batch = next(stream)
        for v in variants.values():
            v.step(judge, batch, descent.rate_of(RATE, progress, made))
        if made % 50 == 0:
            print(f"step {made}, {(time.monotonic() - started) / 60:.1f} minutes", flush=True)
        if progress >= 1:
            break
    stream.close()

    if args.keep:
        for name, v in variants.items():
            if v.variant.items() >= GRADIENTS.items():
                export.write(v.finished()[1], args.keep / name.replace(" ", "-"))
    text = (f"{made} steps of {CROPS} crops of {SIZE} × {SIZE} under {LIGHTS} lights each, {len(subjects)} subjects. CPU seconds of "
            "training: " + ", ".join(f"{name} {v.seconds:.0f}" for name, v in variants.items()) + ".\n\n" +
            compared({"cosine lobe": "cosine-lobe", **{name: v.finished() for name, v in variants.items()}}, args))
    print(text)
    (args.report or args.out / "ablations.md").write_text(text)


def compared(models, args):
    """One table: every model on every set that is there, linear ℓ1 and MS-SSIM."""
    sets = {"held-out, 331 lights": datasets.held_out(args.out / "corpus/test")}
    for title, load, name in (("`olat_head`", datasets.olat_head, "olat_head"), ("`yale_faces`", datasets.yale, "yale_faces")):
        if (args.data / name).is_dir():
            sets[title] = load(args.data / name)
    lines = ["| | " + " | ".join(f"{title}: ℓ1 | MS-SSIM" for title in sets) + " |", "|---" * (2 * len(sets) + 1) + "|"]
    for name, model in models.items():
        cells = []
        for items in sets.values():
            scored = [scores.score(item, scores.predict(model, item)) for item in items]
            cells += [f"{np.mean([s['l1'] for s in scored]):.2f}", f"{np.mean([s['ms_ssim'] for s in scored]):.4f}"]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()

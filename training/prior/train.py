#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fits the prior's network through the solve: train.py --out RUN --samples FOLDER… (README.md). An interrupted run continues."""
import argparse
import json
import math
import pathlib
import sys
import time

import numpy as np
import torch

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
import networks
import pictures
import problem
import warm_start

DECAY, KEEP = 1e-5, 0.998
TRUNK, STEADY_EVERY = 0.15, 3  # share of the rate; steps


def whdr(example, planes=None, count=600):
    """Share of wrong judgments of pairs (Bell et al. 2014, δ = .1) of the last solution, or of planes like it; a third of the pairs is of one paint."""
    s, picture, reflectance, _, mask = planes or example.planes()
    rng = np.random.default_rng(1)
    valid = np.flatnonzero((mask.ravel() > 0.5) & (picture.reshape(-1, 3).mean(-1) > 0.02))
    if len(valid) < 100:
        return None
    true, found = (np.log(np.maximum(x.reshape(-1, 3).mean(-1), 1e-3)) for x in (reflectance, picture * np.exp(-s)[..., None]))
    i, j = rng.choice(valid, (2, 20 * count))
    step = true[i] - true[j]
    equal, other = np.flatnonzero(abs(step) < 0.03)[: count // 3], np.flatnonzero(abs(step) > 0.1)[: 2 * count // 3]
    chosen = np.concatenate([equal, other])
    if len(chosen) == 0:
        return None

    def judged(x):
        return np.where(x > np.log(1.1), 1, np.where(x < -np.log(1.1), -1, 0))

    return float((judged((found[i] - found[j])[chosen]) != np.concatenate([np.zeros(len(equal)), np.sign(step[other])])).mean())


def fields_apart(network, inputs, fields, rng, bf16=False):
    """Mean square distance of the fields of inputs, relative to their limit, from those of crops that start a few pixels later and have noise:
    what would flicker when a camera moves."""
    step, inner = 16, 8  # of sizes; what a crop's border changes does not count
    y, x = (int(k) for k in rng.integers(0, step, 2))
    height, width = inputs.shape[2] - step, inputs.shape[3] - step
    if min(height, width) < 2 * step:
        return inputs.new_zeros(())
    crops = inputs[:, :, y : y + height, x : x + width]
    noise = torch.randn_like(crops) * torch.rand(len(inputs), 1, 1, 1, device=inputs.device) * 0.06
    with torch.autocast(inputs.device.type, torch.bfloat16, enabled=bf16):
        answers = network(crops + noise)
    found = problem.fields_of(answers.float())[:, :, inner:-inner, inner:-inner]
    return problem.mean_square(fields[:, :, y + inner : y + height - inner, x + inner : x + width - inner] - found)


def evaluate(network, examples):
    """Of pictures with truth, by kind: mean loss without pairs, and WHDR. Of couples: shares of light and of paint that reflectance keeps, and
    confusion. Each with the count. network None: the fitted prior."""
    rows = {}

    def fields_of(picture):
        if network is None:
            return np.zeros((problem.FIELDS, *picture.size), np.float32)
        with torch.no_grad():
            return picture.part(problem.fields_of(network(torch.from_numpy(picture.input)[None]))[0]).numpy()

    def one(example):
        if isinstance(example, problem.Triple):
            example.loss([fields_of(p) for p in example.pictures], 1, 0, False)
            light, paint = example.shares
            return {"couples", example.kind}, (light, paint, (light + 1 - paint) / 2)
        loss, wrong = example.loss(fields_of(example), (0, 0, 0), False)[0], whdr(example)
        return {example.kind, example.kind if example.kind in ("procedural", "flat") else "traced"}, (loss, np.nan if wrong is None else wrong)

    for names, values in problem.Loss.pool.map(one, examples):
        for name in names:
            rows.setdefault(name, []).append(values)
    return {k: [round(float(x), 4) for x in np.nanmean(np.array(v), 0)] + [len(v)] for k, v in sorted(rows.items())}


class Run:
    def __init__(self, args):
        self.args, self.out = args, args.out
        self.out.mkdir(parents=True, exist_ok=True)
        torch.manual_seed(args.seed)
        self.network, self.average = networks.Prior().to(args.device, memory_format=torch.channels_last), networks.Prior()
        if args.trunk:
            import lite_file  # needs python3-flatbuffers

            self.network.trunk.start_pretrained(lite_file.convolutions(args.trunk))
        self.average.load_state_dict(self.network.state_dict())
        trunk = list(self.network.trunk.fitted())
        others = [p for n, p in self.network.named_parameters() if not n.startswith("trunk.")]
        self.optimizer = torch.optim.Adam([{"params": others, "share": 1.0}, {"params": trunk, "share": TRUNK}], lr=args.rate, weight_decay=DECAY, betas=(0.9, 0.98))
        self.step = 0
        self.path = self.out / "state.pt"
        if self.path.exists():
            state = torch.load(self.path, map_location=args.device)
            self.step = state["step"]
            for name in ("network", "average", "optimizer"):
                getattr(self, name).load_state_dict(state[name])
        elif args.start:
            start = warm_start.weights_of(args.start) if args.start.suffix == ".onnx" else torch.load(args.start, map_location=args.device)["average"]
            self.network.load_state_dict(start)
            self.average.load_state_dict(start)

    def save(self):
        state = {n: getattr(self, n).state_dict() for n in ("network", "average", "optimizer")} | {"step": self.step}
        torch.save(state, self.path.with_suffix(".new"))
        self.path.with_suffix(".new").rename(self.path)

    def log(self, **values):
        print(json.dumps(values), flush=True)
        with open(self.out / "log.jsonl", "a") as f:
            f.write(json.dumps(values) + "\n")

    def part(self, batch, shifts):
        """Loss of examples of one size, and as numbers that of the solves, the distance of crops' fields, and the size of fields."""
        args, shown = self.args, [p for e in batch for p in problem.pictures_of(e)]
        inputs = torch.from_numpy(np.stack([p.input for p in shown])).to(args.device, memory_format=torch.channels_last)
        with torch.autocast(args.device, torch.bfloat16, enabled=args.bf16):
            answers = self.network(inputs)
        fields = problem.fields_of(answers.float())
        weights = (args.equal, args.different, args.alike)
        loss = problem.Loss.apply(batch, weights, 0.0 if args.local_only else 1.0, args.local, *(p.part(f) for f, p in zip(fields, shown)))
        half = (len(inputs) + 1) // 2
        steady = args.steady and self.step % STEADY_EVERY == 0
        apart = fields_apart(self.network, inputs[:half], fields[:half], shifts, args.bf16) if steady else torch.zeros(())
        size = problem.mean_square(fields)
        return loss + STEADY_EVERY * args.steady * apart + args.small * size, (float(loss), STEADY_EVERY * float(apart), float(size))

    def train(self, pools, tests):
        """pools: those of examples, of which each step takes batches, with their counts."""
        args = self.args
        if self.step == 0:
            self.log(step=0, fitted=evaluate(None, tests))
        start, sums, shifts = time.time(), [], np.random.default_rng(args.seed + self.step)
        while self.step < args.steps:
            self.step += 1
            rate = args.rate * min(1, self.step / 100) * 0.5 * (1 + math.cos(math.pi * self.step / args.steps)) + 1e-6
            for group in self.optimizer.param_groups:
                group["lr"] = rate * group["share"]
            self.optimizer.zero_grad()
            terms = []
            for pool, count, weight in pools:
                loss, term = self.part(pool.batch(count), shifts)
                (weight * loss).backward()
                terms.append(term)
            if not torch.isfinite(torch.nn.utils.clip_grad_norm_(self.network.parameters(), 1.0)):
                self.log(step=self.step, skipped="its derivative is not finite")  # one such step would spoil all weights
                continue
            self.optimizer.step()
            keep = min(KEEP, self.step / (self.step + 10))
            with torch.no_grad():
                for a, p in zip(self.average.parameters(), self.network.parameters()):
                    a.mul_(keep).add_(p.to(a.device), alpha=1 - keep)
            sums.append(terms)
            if self.step % 50 == 0:
                loss, apart, size = np.mean(sums, 0).T.round(4).tolist()  # of each pool
                self.log(step=self.step, loss=loss, apart=apart, size=size, seconds=round(time.time() - start, 1))
                sums = []
            if self.step % args.every == 0 or self.step == args.steps:
                self.save()
                self.log(step=self.step, held_out=evaluate(self.average, tests))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--samples", type=pathlib.Path, nargs="*", default=[], help="folders of SEED.npz")
    parser.add_argument("--couples", type=pathlib.Path, nargs="*", default=[], help="folders of ../couples; one that is named twice is drawn from twice as often")
    parser.add_argument("--held-out-couples", type=pathlib.Path, nargs="*", default=[])
    parser.add_argument("--trunk", type=pathlib.Path, help="TensorFlow Lite file of a pretrained MobileNetV2; without it the trunk starts at random")
    parser.add_argument("--start", type=pathlib.Path, help="state.pt of another run, or its network as ONNX")
    parser.add_argument("--steps", type=int, default=6000)
    parser.add_argument("--batch", type=int, default=8, help="pictures with truth in a step")
    parser.add_argument("--triples", type=int, default=2, help="of couples in a step, three pictures each")
    parser.add_argument("--triple-weight", type=float, default=1.0)
    parser.add_argument("--bf16", action="store_true", help="networks in 16 bits, for processors with AVX-512 bf16 or AMX")
    parser.add_argument("--rate", type=float, default=2e-3)
    parser.add_argument("--equal", type=float, default=1.0, help="weight of pairs of one paint")
    parser.add_argument("--different", type=float, default=0.5, help="weight of pairs of two paints")
    parser.add_argument("--alike", type=float, default=1.0, help="weight of the distance of ln R between lights of one scene")
    parser.add_argument("--assets", type=pathlib.Path, help="of ../intrinsic/README.md, for drawn pictures")
    parser.add_argument("--local", type=float, default=0.3, help="weight of V's distance from ln shading, without a solve")
    parser.add_argument("--local-only", action="store_true", help="no solves: a fast start")
    parser.add_argument("--steady", type=float, default=1.0, help="weight of the fields' change between crops and noise")
    parser.add_argument("--small", type=float, default=0.3, help="weight of the fields' mean square, relative to their limit")
    parser.add_argument("--shares", type=float, nargs=2, default=(0.3, 0.3), help="of samples and of drawings, among samples, drawings and procedural scenes; each of the first two makes three pictures")
    parser.add_argument("--pool", type=int, default=1500, help="examples in memory")
    parser.add_argument("--fresh", type=float, default=1.2, help="new examples for each step")
    parser.add_argument("--fresh-couples", type=float, default=0.2, help="new triples for each that a step takes")
    parser.add_argument("--every", type=int, default=500, help="steps between tests on held-out examples")
    parser.add_argument("--tests", type=int, default=40, help="held-out procedural and drawn examples, each")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--device", default="cpu", help="of the network: cpu or cuda; solves run on all processors")
    parser.add_argument("--threads", type=int, default=2, help="of the network on a processor")
    args = parser.parse_args()
    torch.set_num_threads(args.threads)
    problem.LIBRARY = problem.load()
    run = Run(args)
    seed = args.seed + run.step  # other examples than before an interruption
    pool = pictures.Pool(args.samples, args.assets, args.shares, args.pool, seed, (args.equal, args.different, args.alike), args.fresh)
    couples = pictures.Couples(args.couples, args.pool, seed, args.fresh_couples)
    start = time.time()
    pool.fill()
    tests = pictures.held_out(args.samples, args.assets, args.tests, args.held_out_couples)
    run.log(files=len(pictures.samples(args.samples, False)), pool=len(pool.items), couples=len(couples.items), tests=len(tests), parameters=networks.parameters(run.network), seconds=round(time.time() - start, 1))
    pools = [(pool, args.batch, 1.0)] + ([(couples, args.triples, args.triple_weight)] if couples.items else [])
    run.train(pools, tests)
    pool.stop()
    couples.stop()


if __name__ == "__main__":
    main()

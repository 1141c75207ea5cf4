#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fits the prior's network through the solve: train.py --out RUN --samples FOLDER… (README.md). An interrupted run continues."""
import argparse
import json
import math
import pathlib
import time

import numpy as np
import torch

import networks
import pictures
import problem

DECAY, KEEP = 1e-5, 0.998


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


def fields_apart(network, inputs, fields, rng):
    """Mean square distance of the fields of inputs, relative to their limits, from those of crops that start a few pixels later and have noise:
    what would flicker when a camera moves."""
    step, inner = 16, 8  # of sizes; what a crop's border changes does not count
    y, x = (int(k) for k in rng.integers(0, step, 2))
    height, width = inputs.shape[2] - step, inputs.shape[3] - step
    if min(height, width) < 2 * step:
        return inputs.new_zeros(())
    crops = inputs[:, :, y : y + height, x : x + width]
    noise = torch.randn_like(crops) * torch.rand(len(inputs), 1, 1, 1, device=inputs.device) * 0.06
    found = problem.fields_of(network(crops + noise))[:, :, inner:-inner, inner:-inner]
    return problem.mean_square(fields[:, :, y + inner : y + height - inner, x + inner : x + width - inner] - found)


def evaluate(network, examples):
    """Mean loss without pairs, and WHDR, by kind. network None: the fitted prior."""
    rows = {}

    def one(example):
        if network is None:
            fields = np.zeros((problem.FIELDS, *example.size), np.float32)
        else:
            with torch.no_grad():
                fields = example.part(problem.fields_of(network(torch.from_numpy(example.input)[None]))[0]).numpy()
        return example.kind, example.loss(fields, (0, 0, 0), False)[0], whdr(example)

    for kind, loss, wrong in problem.Loss.pool.map(one, examples):
        for name in {kind, kind if kind in ("procedural", "flat") else "traced"}:
            rows.setdefault(name, []).append((loss, np.nan if wrong is None else wrong))
    return {k: [round(float(x), 4) for x in np.nanmean(np.array(v), 0)] + [len(v)] for k, v in sorted(rows.items())}


class Run:
    def __init__(self, args):
        self.args, self.out = args, args.out
        self.out.mkdir(parents=True, exist_ok=True)
        torch.manual_seed(args.seed)
        self.network = networks.Prior(args.width).to(args.device, memory_format=torch.channels_last)
        self.average = networks.Prior(args.width)
        self.average.load_state_dict(self.network.state_dict())
        self.optimizer = torch.optim.Adam(self.network.parameters(), lr=args.rate, weight_decay=DECAY, betas=(0.9, 0.98))
        self.step = 0
        self.path = self.out / "state.pt"
        if self.path.exists():
            state = torch.load(self.path, map_location=args.device)
            self.step = state["step"]
            for name in ("network", "average", "optimizer"):
                getattr(self, name).load_state_dict(state[name])
        elif args.start:
            state = torch.load(args.start, map_location=args.device)
            narrow = networks.Prior(state["width"])
            narrow.load_state_dict(state["average"])
            start = networks.grown(narrow, args.width).state_dict()
            self.network.load_state_dict(start)
            self.average.load_state_dict(start)

    def save(self):
        state = {n: getattr(self, n).state_dict() for n in ("network", "average", "optimizer")} | {"step": self.step, "width": self.args.width}
        torch.save(state, self.path.with_suffix(".new"))
        self.path.with_suffix(".new").rename(self.path)

    def log(self, **values):
        print(json.dumps(values), flush=True)
        with open(self.out / "log.jsonl", "a") as f:
            f.write(json.dumps(values) + "\n")

    def train(self, pool, tests):
        args, weights = self.args, (self.args.equal, self.args.different, self.args.alike)
        if self.step == 0:
            self.log(step=0, fitted=evaluate(None, tests))
        start, sums, shifts = time.time(), [], np.random.default_rng(args.seed)
        while self.step < args.steps:
            self.step += 1
            rate = args.rate * min(1, self.step / 100) * 0.5 * (1 + math.cos(math.pi * self.step / args.steps)) + 1e-6
            for group in self.optimizer.param_groups:
                group["lr"] = rate
            batch = pool.batch(args.batch)
            inputs = torch.from_numpy(np.stack([p.input for p in batch])).to(args.device, memory_format=torch.channels_last)
            fields = problem.fields_of(self.network(inputs))
            parts = [p.part(f) for f, p in zip(fields, batch)]
            loss = problem.Loss.apply(batch, weights, None if args.local_only else args.local, *parts)
            half = (len(inputs) + 1) // 2
            apart = fields_apart(self.network, inputs[:half], fields[:half], shifts) if args.steady else torch.zeros(())
            size = problem.mean_square(fields)
            self.optimizer.zero_grad()
            (loss + args.steady * apart + args.small * size).backward()
            torch.nn.utils.clip_grad_norm_(self.network.parameters(), 1.0)
            self.optimizer.step()
            keep = min(KEEP, self.step / (self.step + 10))
            with torch.no_grad():
                for a, p in zip(self.average.parameters(), self.network.parameters()):
                    a.mul_(keep).add_(p.to(a.device), alpha=1 - keep)
            sums.append((float(loss), float(apart), float(size)))
            if self.step % 100 == 0:
                loss, apart, size = np.mean(sums, 0)
                self.log(step=self.step, loss=round(float(loss), 4), apart=round(float(apart), 6), size=round(float(size), 5), seconds=round(time.time() - start, 1), made=pool.made)
                sums = []
            if self.step % args.every == 0 or self.step == args.steps:
                self.save()
                self.log(step=self.step, held_out=evaluate(self.average, tests))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--samples", type=pathlib.Path, nargs="*", default=[], help="folders of SEED.npz")
    parser.add_argument("--width", default="medium", choices=networks.WIDTHS)
    parser.add_argument("--start", type=pathlib.Path, help="state.pt of another run, of this width or a narrower one")
    parser.add_argument("--steps", type=int, default=6000)
    parser.add_argument("--batch", type=int, default=8)
    parser.add_argument("--rate", type=float, default=2e-3)
    parser.add_argument("--equal", type=float, default=1.0, help="weight of pairs of one paint")
    parser.add_argument("--different", type=float, default=0.5, help="weight of pairs of two paints")
    parser.add_argument("--alike", type=float, default=1.0, help="weight of the distance of ln R between lights of one scene")
    parser.add_argument("--assets", type=pathlib.Path, help="of ../intrinsic/README.md, for drawn pictures")
    parser.add_argument("--local", type=float, default=0.3, help="weight of shares of paint at edges, and of V")
    parser.add_argument("--local-only", action="store_true", help="no solves: a fast start")
    parser.add_argument("--steady", type=float, default=1.0, help="weight of the fields' change between crops and noise")
    parser.add_argument("--small", type=float, default=0.3, help="weight of the fields' mean square, relative to their limits")
    parser.add_argument("--shares", type=float, nargs=2, default=(0.3, 0.3), help="of samples and of drawings, among samples, drawings and procedural scenes; each of the first two makes three pictures")
    parser.add_argument("--pool", type=int, default=1500, help="examples in memory")
    parser.add_argument("--fresh", type=float, default=1.2, help="new examples for each step")
    parser.add_argument("--every", type=int, default=500, help="steps between tests on held-out examples")
    parser.add_argument("--tests", type=int, default=40, help="held-out procedural and drawn examples, each")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--device", default="cpu", help="of the network: cpu or cuda; solves run on all processors")
    parser.add_argument("--threads", type=int, default=2, help="of the network on a processor")
    args = parser.parse_args()
    torch.set_num_threads(args.threads)
    problem.LIBRARY = problem.load()
    run = Run(args)
    pool = pictures.Pool(args.samples, args.assets, args.shares, args.pool, args.seed, (args.equal, args.different, args.alike), args.fresh)
    start = time.time()
    pool.fill()
    tests = pictures.held_out(args.samples, args.assets, args.tests)
    run.log(files=len(pictures.samples(args.samples, False)), pool=len(pool.items), tests=len(tests), parameters=networks.parameters(run.network), seconds=round(time.time() - start, 1))
    run.train(pool, tests)
    pool.stop()


if __name__ == "__main__":
    main()

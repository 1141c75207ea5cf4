#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Trains a network on the rendered corpus: train.py --minutes 60. See README.md.

First, for a tenth of the time, the DirectionNet whose features the perceptual loss compares; then the network itself.
Writes OUT/checkpoint.pt (every minute and at the end), OUT/log.jsonl and OUT/curves.png. The same command with --resume goes
on where the checkpoint ended; with more --minutes it goes on longer.
"""
import argparse
import copy
import json
import os
import pathlib
import time

# Threads that wait let others have the core: spinning costs most of a shared machine's time. Read when torch is loaded.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

import numpy as np  # noqa: E402
import torch  # noqa: E402

from olat import corpus, curves, encoding, samples, teaching  # noqa: E402
from olat.networks import DirectionNet, exported, network, warm_start  # noqa: E402
import descent  # noqa: E402
import records  # noqa: E402

RATE = 2e-3
LONGEST_STEP = 20  # seconds; what goes beyond is a process that was stopped for a while, not training


def arguments():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--out", type=pathlib.Path, default=corpus.ROOT / "out/olat")
    p.add_argument("--corpus", type=pathlib.Path, help="folder that make_corpus.py wrote; OUT/corpus")
    p.add_argument("--minutes", type=float, default=60, help="of training in all")
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--threads", type=int, default=2)
    p.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu")
    p.add_argument("--resume", action="store_true")
    p.add_argument("--overwrite", action="store_true", help="begin where OUT has a checkpoint, which is lost then")
    p.add_argument("--start", type=pathlib.Path, help="folder of exported weights (export.py) to begin with, such as models/olat")
    p.add_argument("--rate", type=float, default=RATE, help="largest learning rate")
    p.add_argument("--fusion", choices=("late", "early"), default="late")
    p.add_argument("--input", choices=("gradients", "olats"), default="gradients", help="olats: the wide-baseline 3-OLAT input")
    p.add_argument("--width", type=float, default=1, help="of the U-Net's layers, against the standard ones")
    p.add_argument("--no-perceptual", action="store_true", help="ablation: without the perceptual loss")
    p.add_argument("--shifts", type=int, default=0, help="OLATs of the corpus are up to as many pixels off")
    p.add_argument("--alignment", action="store_true", help="with the alignment loss, which makes up for such shifts")
    return p.parse_args()


def load_subjects(folder):
    subjects = [corpus.Subject(p) for p in corpus.stored(folder)]
    if not subjects:
        raise SystemExit(f"{folder} holds no subjects: run training/olat/make_corpus.py")
    return subjects


@torch.no_grad()
def validate(variant, state, subjects, device):
    """Mean absolute errors of codes and of linear light over held-out subjects."""
    net = network(variant).to(device)
    net.load_state_dict(state)
    net.eval()
    sums = np.zeros(2)
    for s in subjects:
        batch = samples.Batch(s.gradients[:1], s.gradients[1:], s.olats[None].astype(np.float32), s.directions[None],
                              s.alpha[None]).to(device)
        code = net(batch.x["gradients"], batch.directions)
        inside = batch.alpha / (batch.alpha.sum() * 3 * code.shape[1])
        sums += [float(((code.clamp(min=0) - batch.truth).abs() * inside).sum()),
                 float(((encoding.decode(code) - batch.truth ** 2).abs() * inside).sum())]
    return dict(zip(("held_out_code", "held_out_linear"), sums / len(subjects)))


def main():
    args = arguments()
    torch.manual_seed(args.seed)
    torch.set_num_threads(args.threads)
    args.out.mkdir(parents=True, exist_ok=True)
    folder = args.corpus or args.out / "corpus"
    subjects, held_back = load_subjects(folder / "train"), load_subjects(folder / "validation")
    variant = {"fusion": args.fusion, "input": args.input, "width": args.width}
    judge, net = DirectionNet().to(args.device), network(variant).to(args.device)
    judge_optimizer, optimizer = (torch.optim.Adam(n.parameters(), lr=RATE) for n in (judge, net))
    average = teaching.Average(net)
    state = {"variant": variant, "judged": 0.0, "seconds": 0.0, "batches": 0, "lit": 0, "arguments": vars(args)}
    path = args.out / "checkpoint.pt"
    records.keep(path, args)
    if args.resume:
        saved = torch.load(path, map_location=args.device)
        was = {"width": 1, **saved["variant"]}
        if was != variant:
            raise SystemExit(f"{path} holds another variant: {was}")
        for part, name in ((judge, "judge"), (net, "network"), (judge_optimizer, "judge_optimizer"), (optimizer, "optimizer")):
            part.load_state_dict(saved[name])
        average.state, average.steps = saved["average"], saved["batches"]
        state.update({k: saved[k] for k in ("judged", "seconds", "batches", "lit")})
        records.cut(args.out / "log.jsonl", (state["judged"] + state["seconds"]) / 60)
    log = open(args.out / "log.jsonl", "a" if args.resume else "w", encoding="utf-8")

    def write(**record):
        log.write(json.dumps({"minutes": round((state["judged"] + state["seconds"]) / 60, 3), **record}) + "\n")
        log.flush()

    def save():
        whole = {**state, "judge": judge.state_dict(), "network": net.state_dict(), "average": average.state,
                 "judge_optimizer": judge_optimizer.state_dict(), "optimizer": optimizer.state_dict()}
        torch.save(whole, str(path) + ".new")
        pathlib.Path(str(path) + ".new").replace(path)
        curves.plot(args.out / "log.jsonl", args.out / "curves.png")

    def make(number):
        random = np.random.default_rng((args.seed, number))
        return samples.draw(random, subjects, *samples.shape_of(random), args.shifts, args.input == "olats")

    if args.start and not args.resume:
        pictures = [make(i).to(args.device).x["gradients"] for i in range(12)]
        warm_start.load(exported(net, args.start), lambda: [net.features(x) for x in pictures])
        average = teaching.Average(net)
    write(event="start", subjects=len(subjects), arguments={k: str(v) for k, v in vars(args).items()})
    judge_budget = 60 * min(0.1 * args.minutes, 4)
    if args.resume and state["batches"]:
        judge_budget = state["judged"]
    stream, means, count, saved_at = samples.Stream(make, state["batches"]), {}, 0, time.monotonic()
    random = np.random.default_rng((args.seed, 10 ** 9 + state["batches"]))
    while state["judged"] < judge_budget:
        started = time.monotonic()
        batch = next(stream).to(args.device)
        loss = teaching.direction_loss(judge, batch, random)
        descent.step(judge_optimizer, loss, descent.rate_of(RATE, state["judged"] / judge_budget, count))
        count += 1
        means["direction"] = means.get("direction", 0) + float(loss)
        state["judged"] += min(time.monotonic() - started, LONGEST_STEP)
        if count % 50 == 0:
            write(stage="direction", **{k: v / 50 for k, v in means.items()})
            means = {}
        if time.monotonic() - saved_at > 60:
            save()
            saved_at = time.monotonic()
    stream.close()
    stream = samples.Stream(make, state["batches"])
    judge.requires_grad_(False)
    budget, means, count = 60 * args.minutes - state["judged"], {}, 0
    net.train()
    while state["seconds"] < budget:
        started = time.monotonic()
        batch = next(stream).to(args.device)
        terms = teaching.terms_of(net, judge, batch, random, args.input, perceptual=not args.no_perceptual, alignment=args.alignment)
        descent.step(optimizer, sum(terms.values()), descent.rate_of(args.rate, state["seconds"] / budget, count))
        average.update(net)
        count += 1
        state["batches"] += 1
        state["lit"] += batch.truth.shape[0] * batch.truth.shape[1]
        for name, value in terms.items():
            means[name] = means.get(name, 0) + float(value)
        state["seconds"] += min(time.monotonic() - started, LONGEST_STEP)
        if count % 50 == 0:
            record = {k: v / 50 for k, v in means.items()}
            means = {}
            if count % 500 == 0 and args.input == "gradients":
                record.update(validate(variant, copy.deepcopy(average.state), held_back, args.device))
            write(stage="network", batches=state["batches"], lit=state["lit"], rate=optimizer.param_groups[0]["lr"], **record)
        if time.monotonic() - saved_at > 60:
            save()
            saved_at = time.monotonic()
    stream.close()
    if args.input == "gradients":
        write(stage="network", event="end", **validate(variant, average.state, held_back, args.device))
    save()


if __name__ == "__main__":
    main()

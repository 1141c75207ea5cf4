#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Trains the five networks on the rendered corpus: train.py --minutes 60. See README.md.

Writes OUT/checkpoint.pt (every minute and at the end of a stage), OUT/log.jsonl and OUT/curves.png. The same command with
--resume (in place of --start and --anew, if it had these), or --resume alone, goes on where the checkpoint ended: with its
stages, minutes, seed and losses, and behind the samples that were drawn. --resume --stages a,b,… goes through other stages
than those that the checkpoint is amid, or through the same once more when it has ended, from its weights, and shares --minutes
out among them. --start models/lime in place of --resume begins with exported weights, where there is no checkpoint any more.
"""
import argparse
import json
import os
import pathlib
import time

# Threads that wait let others have the core: spinning costs most of a shared machine's time. Read when torch is loaded.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

import torch  # noqa: E402

from lime import corpus, curves, stages  # noqa: E402
from lime.networks import INPUT, Networks, exported, warm_start  # noqa: E402
import descent  # noqa: E402
import records  # noqa: E402

VALIDATION_SEED = 2  # of the test split; others are datasets.CHOICES and datasets.REPORT
HELD_BACK = 64       # validation samples
MINUTES = 60         # where nobody says
MUON = 3             # rate of settled networks, of Adam's (whose own share of it is Muon.ADAM)
LONGEST_STEP = 20    # seconds; what goes beyond is a process that was stopped for a while, not training


def arguments():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--out", type=pathlib.Path, default=corpus.ROOT / "out/lime")
    p.add_argument("--minutes", type=float, help=f"of training in all, shared out among the stages; {MINUTES}, or the checkpoint's")
    p.add_argument("--seed", type=int, help="of the samples; 1, or the checkpoint's; --start wants another than its weights had")
    p.add_argument("--hdri", default=None, help="folder of CC0 environment maps; '' for rooms only")
    p.add_argument("--threads", type=int, default=2, help="of the training")
    p.add_argument("--workers", type=int, default=1, help="threads that render samples")
    p.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu")
    p.add_argument("--resume", action="store_true")
    p.add_argument("--overwrite", action="store_true", help="begin where OUT has a checkpoint, which is lost then")
    p.add_argument("--start", type=pathlib.Path, help="folder of exported weights (export.py) to begin with, such as models/lime")
    p.add_argument("--anew", help="with --start or --resume: networks that begin with random weights all the same, separated by commas; leave it out to go on after an interruption")
    p.add_argument("--settled", action="store_true", help="with --start: normalization stays as it is, folded into the convolutions, and Muon (descent.py) takes Adam's place")
    p.add_argument("--plain", action="store_true", help="half of the samples are of one color and shiny, as most of those are that are scored")
    p.add_argument("--bfloat16", action="store_true", help="compute in 16 bits: twice as fast on a CPU with AVX512-BF16")
    p.add_argument("--stages", help="go through these only, separated by commas (lime/stages.py); default: all")
    p.add_argument("--no-perceptual", action="store_true", help="ablation: without the rendering loss")
    p.add_argument("--no-mirror", action="store_true", help="ablation: without MirrorNet")
    p.add_argument("--regress", action="store_true", help="ablation: log10 of the shininess instead of bins")
    return p.parse_args()


def validate(stage, networks, batches, perceptual):
    """Mean loss terms over held-out samples."""
    networks.eval()
    sums = {}
    with torch.no_grad():
        for batch in batches:
            for name, value in stages.stage_losses(stage.name, networks, batch, perceptual).items():
                sums[name] = sums.get(name, 0) + float(value) / len(batches)
    learn(stage, networks)
    return sums


def batches_of(arrays, device, batch=16):
    return [corpus.Batch({k: a[i:i + batch] for k, a in arrays.items()}, device) for i in range(0, len(arrays["image"]), batch)]


def learn(stage, networks):
    """Networks that a stage does not teach keep the statistics of their normalization, too."""
    for part in networks.parts():
        getattr(networks, part).train(part in stage.parts)


def run(networks, batch, anew):
    """The way of pictures through all networks, as in use; the truth is in place of what those in `anew`, which know nothing
    yet, would give the next ones."""
    mask = batch.mask if "segmentation" in anew else (networks.find_mask(batch.image) > 0.5).float()
    specular = batch.layer_code if "specular" in anew else networks.find_specular(batch.image, mask)
    networks.find_albedo(batch.image, mask, specular)
    if networks.use_mirror:
        mirror = networks.find_mirror(specular, mask)
    networks.find_exponent(specular, batch.mirror_code if "mirror" in anew or not networks.use_mirror else mirror)


def check(args, path):
    if args.resume and args.start:
        raise SystemExit("--resume goes on with a checkpoint, --start with exported weights")
    if args.anew and not (args.resume or args.start):
        raise SystemExit("without --start or --resume all networks begin anew")
    if args.start and args.seed is None:
        raise SystemExit("--start wants a --seed, another than its weights were trained with (their README tells)")
    if args.settled and not (args.start or args.resume):
        raise SystemExit("--settled goes on with weights that know much already (--start)")
    records.keep(path, args)


def initial_state(args, path):
    """What a checkpoint says of a training beside its weights, and those of the checkpoint and its optimizer, or none."""
    variant = {"use_mirror": not args.no_mirror, "regress": args.regress, "settled": args.settled}
    state = {"variant": variant, "stages": None, "minutes": MINUTES, "stage": 0, "seconds": 0.0, "samples": 0, "drawn": 0,
             "trained_seconds": 0.0, "seed": 1, "perceptual": True, "plain": False}
    weights = optimizer = None
    if args.resume:
        saved = torch.load(path, map_location=args.device)
        variant["settled"] |= saved["variant"].setdefault("settled", False)
        if saved["variant"] != variant:
            raise SystemExit(f"{path} holds another variant: {saved['variant']}")
        weights, optimizer = saved.pop("networks"), saved.pop("optimizer")
        state.update({"drawn": saved["samples"]}, **saved)
    if args.seed is not None:
        state["seed"] = args.seed
    state["perceptual"] &= not args.no_perceptual
    state["plain"] |= args.plain
    return state, weights, optimizer


def plan_stages(args, state, networks, path):
    """Which stages are to come, in `state`; whether the checkpoint was amid these."""
    asked = args.stages.split(",") if args.stages else None
    amid = args.resume and state["stage"] < len(stages.stages_of(networks, state["stages"]))
    goes_on = amid and asked in (None, state["stages"])
    if asked and not goes_on:
        state.update(stages=asked, minutes=MINUTES, stage=0, seconds=0.0)
    elif args.resume and not amid:
        raise SystemExit(f"{path}: this training has ended; --stages goes on")
    if args.minutes is not None:
        state["minutes"] = args.minutes
    return goes_on


class Training:
    """Networks, what they learn from, and where they are in it (`state`, as the checkpoint has it)."""

    def __init__(self, args, state, networks, samples, log):
        self.args, self.state, self.networks, self.samples, self.log = args, state, networks, samples, log
        self.held_back = {}  # by the kind of pictures that a stage learns from

    def write(self, **record):
        self.log.write(json.dumps(record) + "\n")
        self.log.flush()

    def save(self, optimizer):
        path = str(self.args.out / "checkpoint.pt")
        torch.save({**self.state, "networks": self.networks.state_dict(), "optimizer": optimizer and optimizer.state_dict()}, path + ".new")
        pathlib.Path(path + ".new").replace(path)
        curves.plot(self.args.out / "log.jsonl", self.args.out / "curves.png")

    def held_out(self, stage, kind):
        """Loss terms by the names of the log."""
        if kind not in self.held_back:
            arrays = self.samples.render(VALIDATION_SEED, 0, HELD_BACK, INPUT, corpus.TEST | kind, self.args.threads)
            self.held_back[kind] = batches_of(arrays, self.args.device)
        terms = validate(stage, self.networks, self.held_back[kind], self.state["perceptual"])
        return {"held_out_" + name: value for name, value in terms.items()}

    def teach(self, stage, optimizer_state=None):
        """Goes through a stage, or on with it."""
        args, state = self.args, self.state
        budget = 60 * state["minutes"] * stage.share
        learn(stage, self.networks)
        learning = [p for part in stage.parts for p in getattr(self.networks, part).parameters()]
        settled = state["variant"]["settled"]
        rate = stage.rate * (MUON if settled else 1)
        optimizer = (descent.Muon if settled else torch.optim.Adam)(learning, lr=rate)
        if optimizer_state:
            optimizer.load_state_dict(optimizer_state)
        kind = corpus.WHOLE_FRAME if stage.name == "segmentation" else 0
        stream, stream_pixels = None, 0
        means, count, saved = {}, 0, time.monotonic()
        while state["seconds"] < budget:
            started = time.monotonic()
            progress = state["seconds"] / budget
            coarse = progress < stage.coarse
            if stream_pixels != INPUT >> coarse:
                stream_pixels, batch = INPUT >> coarse, stage.batch << 2 * coarse
                if stream:
                    stream.close()
                stream = corpus.Stream(self.samples, state["seed"], state["drawn"], batch, stream_pixels, corpus.TAUGHT | kind,
                                       args.workers, args.device, twice=True, second_flags=0 if state["plain"] else None)
                batches = corpus.Again(stream, stage.times)
            given = next(batches)
            with torch.autocast(torch.device(args.device).type, torch.bfloat16, enabled=args.bfloat16):
                if stage.times > 1 and not given.found:
                    given.found = stages.find_layers(self.networks, given)
                terms = stages.stage_losses(stage.name, self.networks, given, state["perceptual"])
            descent.step(optimizer, sum(terms.values()), descent.rate_of(rate, progress, count))
            count += 1
            state["samples"] += batch
            state["drawn"] = stream.index
            for name, value in terms.items():
                means[name] = means.get(name, 0) + float(value)
            took = min(time.monotonic() - started, LONGEST_STEP)
            state["seconds"] += took
            state["trained_seconds"] += took
            if count % 50 == 0:
                record = {name: value / 50 for name, value in means.items()}
                means = {}
                if count % 200 == 0:
                    record.update(self.held_out(stage, kind))
                self.write(stage=stage.name, samples=state["samples"], minutes=state["trained_seconds"] / 60,
                           rate=optimizer.param_groups[0]["lr"], **record)
            if time.monotonic() - saved > 60:
                self.save(optimizer)
                saved = time.monotonic()
        if stream:
            stream.close()
        self.write(event="end", stage=stage.name, minutes=state["trained_seconds"] / 60, samples=state["samples"],
                   **self.held_out(stage, kind))


def main():
    args = arguments()
    torch.set_num_threads(args.threads)
    args.out.mkdir(parents=True, exist_ok=True)
    path = args.out / "checkpoint.pt"
    check(args, path)
    state, weights, optimizer_state = initial_state(args, path)
    settled = state["variant"]["settled"]
    torch.manual_seed(state["seed"])
    networks = Networks(**state["variant"]).to(args.device, memory_format=torch.channels_last)
    anew = set(args.anew.split(",")) if args.anew else set()
    if anew and settled:
        raise SystemExit("--anew: settled networks have no normalization to begin with")
    if not anew <= set(networks.parts()):
        raise SystemExit(f"--anew {args.anew}: there are {', '.join(networks.parts())}")
    if args.resume:
        kept = {name: tensor for name, tensor in weights.items() if name.split(".")[0] not in anew}
        missing, unexpected = networks.load_state_dict(kept, strict=False)
        if unexpected or any(name.split(".")[0] not in anew for name in missing):
            raise SystemExit(f"{path} holds other networks")
    goes_on = plan_stages(args, state, networks, path)
    if anew or not goes_on:
        optimizer_state = None
    order = stages.stages_of(networks, state["stages"])
    print(f"{state['minutes']:g} minutes of {', '.join(s.name for s in order)}", flush=True)

    samples = corpus.Corpus(args.hdri)
    maps = samples.maps(False)
    print(f"light: procedural rooms and {len(maps)} environment maps" if maps else
          "light: procedural rooms only, as no environment maps are at hand (--hdri)", flush=True)
    if args.start:
        files = {network: path for network, path in exported(networks, args.start).items() if path.stem not in anew}
        if settled:
            warm_start.take(files)
        else:
            arrays = samples.render(state["seed"], 0, 64, INPUT, corpus.TAUGHT, args.threads)
            first = batches_of(arrays, args.device)
            warm_start.load(files, lambda: [run(networks, batch, anew) for batch in first])
    if args.resume:
        records.cut(args.out / "log.jsonl", state["trained_seconds"] / 60)
    with open(args.out / "log.jsonl", "a" if args.resume else "w", encoding="utf-8") as log:
        training = Training(args, state, networks, samples, log)
        training.write(event="start", maps=maps, arguments={k: str(v) for k, v in vars(args).items()})
        for number in range(state["stage"], len(order)):
            if number != state["stage"]:
                state.update(stage=number, seconds=0.0)
            training.teach(order[number], optimizer_state)
            optimizer_state = None
            state.update(stage=number + 1, seconds=0.0)
            training.save(None)  # the optimizer of an ended stage is of no use to the next one


main()

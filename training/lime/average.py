#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The mean of two trainings, one of which went on from the other: average.py BEFORE AFTER.pt --networks specular,mirror --out OUT.pt

Where a training taught what another corpus wants, weights between its first and its last often do both better than either
(Wortsman et al., Robust fine-tuning of zero-shot models, 2022). Networks that are not named are those of BEFORE.
"""
import argparse
import pathlib

import torch

from lime.networks import load_checkpoint, warm_start


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", type=pathlib.Path, help="checkpoint of train.py, or the folder of exported networks that it began with (--settled)")
    parser.add_argument("after", type=pathlib.Path)
    parser.add_argument("--networks", required=True, help="those that are averaged, separated by commas")
    parser.add_argument("--share", type=float, default=0.5, help="of AFTER; %(default)s")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    args = parser.parse_args()
    before, after = load_checkpoint(args.before), torch.load(args.after, map_location="cpu")
    if after["variant"].get("settled"):
        before = warm_start.settle(before)
    weights, known = before.state_dict(), before.parts()
    if {n: t.shape for n, t in weights.items()} != {n: t.shape for n, t in after["networks"].items()}:
        raise SystemExit(f"{args.before} and {args.after} hold other variants")
    named = set(args.networks.split(","))
    if not named <= set(known):
        raise SystemExit(f"--networks {args.networks}: there are {', '.join(known)}")
    if args.out.exists():
        raise SystemExit(f"{args.out} is there already")
    for name, tensor in after["networks"].items():
        if name.split(".")[0] in named and tensor.is_floating_point():
            weights[name] = torch.lerp(weights[name], tensor, args.share)
    torch.save({**after, "networks": weights, "optimizer": None}, args.out)


main()

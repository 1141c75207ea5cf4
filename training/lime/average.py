#!/usr/bin/env python3
"""The mean of two trainings, one of which went on from the other: average.py BEFORE.pt AFTER.pt --networks specular,mirror --out OUT.pt

Where a training taught what another corpus wants, weights between its first and its last often do both better than either
(Wortsman et al., Robust fine-tuning of zero-shot models, 2022). Networks that are not named are those of BEFORE.
"""
import argparse
import pathlib

import torch

from lime.networks import Networks


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", type=pathlib.Path, help="checkpoint of train.py")
    parser.add_argument("after", type=pathlib.Path)
    parser.add_argument("--networks", required=True, help="those that are averaged, separated by commas")
    parser.add_argument("--share", type=float, default=0.5, help="of AFTER; %(default)s")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    args = parser.parse_args()
    before, after = (torch.load(path, map_location="cpu") for path in (args.before, args.after))
    if before["variant"] != after["variant"]:
        raise SystemExit(f"{args.before} and {args.after} hold other variants: {before['variant']}, {after['variant']}")
    named, known = set(args.networks.split(",")), Networks(**before["variant"]).parts()
    if not named <= set(known):
        raise SystemExit(f"--networks {args.networks}: there are {', '.join(known)}")
    if args.out.exists():
        raise SystemExit(f"{args.out} is there already")
    weights = dict(before["networks"])
    for name, tensor in after["networks"].items():
        if name.split(".")[0] in named and tensor.is_floating_point():
            weights[name] = torch.lerp(weights[name], tensor, args.share)
    torch.save({**after, "networks": weights, "optimizer": None}, args.out)


main()

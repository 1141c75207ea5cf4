#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Curves of runs: curves.py RUN… --out curves.png. Loss and WHDR on held-out examples relative to the fitted prior; confusion of couples; training loss of
pictures with truth, and of couples (dashed)."""
import argparse
import json
import pathlib

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402  (the backend comes first)

KINDS = ("traced", "flat", "procedural")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", type=pathlib.Path, nargs="+")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("curves.png"))
    args = parser.parse_args()
    figure, axes = pyplot.subplots(1, 4, figsize=(20, 4.5))
    for number, run in enumerate(args.runs):
        rows = [json.loads(line) for line in (run / "log.jsonl").read_text().splitlines()]
        fitted = next(r["fitted"] for r in rows if "fitted" in r)
        tests = [r for r in rows if "held_out" in r]
        for axis, which in zip(axes, (0, 1)):
            for kind, style in zip(KINDS, ("-", "--", ":")):
                if kind in fitted:
                    points = [(0, 1.0)] + [(r["step"], r["held_out"][kind][which] / fitted[kind][which]) for r in tests]
                    axis.plot(*zip(*points), style, color=f"C{number}", label=f"{run.name} {kind}")
        if "couples" in fitted:
            axes[2].plot(*zip((0, fitted["couples"][2]), *((r["step"], r["held_out"]["couples"][2]) for r in tests)), color=f"C{number}", label=run.name)
        trained = [r for r in rows if "loss" in r]
        for losses, style in zip(zip(*(r["loss"] for r in trained)), ("-", "--")):
            axes[3].plot([r["step"] for r in trained], losses, style, color=f"C{number}", label=run.name)
    for axis, title in zip(axes, ("held-out loss / that of the fitted prior", "held-out WHDR / that of the fitted prior", "confusion of held-out couples", "training loss")):
        axis.set_title(title)
        axis.set_xlabel("steps")
        axis.legend(fontsize=6)
    figure.tight_layout()
    figure.savefig(args.out, dpi=90)


if __name__ == "__main__":
    main()

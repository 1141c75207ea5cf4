#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Draws error against run time, by the size of the square and the width of SpecularNet: trade.py. The numbers are those of the
model card's two tables (sizes.py and widths.py print them); writes docs/images/limematerial-trade.svg."""
import argparse
import pathlib

import matplotlib

matplotlib.use("svg")
from matplotlib import pyplot  # noqa: E402

from lime import corpus  # noqa: E402

TICKS = (5, 10, 20, 40, 80)  # ms


def table(card, title):
    """Cells of the first table behind a title, without its head."""
    lines = card.split(f"### {title}\n")[1].split("\n#")[0].splitlines()
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("|")]
    return rows[2:]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--card", type=pathlib.Path, default=corpus.ROOT / "models/lime/README.md")
    parser.add_argument("--out", type=pathlib.Path, default=corpus.ROOT / "docs/images/limematerial-trade.svg")
    args = parser.parse_args()
    card = args.card.read_text()
    pyplot.rcParams.update({"svg.hashsalt": "lime", "svg.fonttype": "none", "font.size": 9})
    figure, (sizes, widths) = pyplot.subplots(1, 2, figsize=(8, 3), layout="constrained")

    def line(axes, times, errors, names, label):
        axes.plot(times, errors, "o-", label=label, markersize=4)
        for time, error, name in zip(times, errors, names):
            axes.annotate(name, (time, error), (4, 4), textcoords="offset points", fontsize=7)

    rows = table(card, "By the size of the square that is looked at")
    times = [[float(t) for t in row[-1].split(",")] for row in rows]
    sides = [row[0].split()[0] for row in rows]
    for i, network in ((1, "specular"), (2, "mirror")):  # behind segmentation, whose error is of another kind
        line(sizes, [t[i] for t in times], [float(row[i + 1]) for row in rows], sides, f"{network} (trained at 128)")
    sizes.set(title="Side of the square", xlabel="ms", ylabel="mean absolute error of the code", xscale="log")
    rows = table(card, "By the width of SpecularNet")
    line(widths, [float(row[3]) for row in rows], [float(row[2]) for row in rows], [f"{row[1]} GFLOP" for row in rows],
         "specular, after 9 thousand samples")
    widths.set(title="Width", xlabel="ms", xscale="log")
    for axes in (sizes, widths):
        axes.set_xlim(3.5, 110)
        axes.margins(y=0.12)
        axes.set_xticks(TICKS, TICKS)
        axes.minorticks_off()
        axes.legend(fontsize=7, loc="upper right")
        axes.grid(alpha=0.3)
    figure.savefig(args.out, metadata={"Date": None})


main()

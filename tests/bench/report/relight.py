# SPDX-License-Identifier: LGPL-2.1-or-later
"""docs/images/relighting-curves.svg, from the table that relight-curves prints: relight.py FILE.md TO.svg"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot as plt


def rows_of(path):
    for line in pathlib.Path(path).read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if line.startswith("|") and len(cells) == 7 and cells[6].endswith("%"):
            yield {"method": cells[0], "size": cells[1], "lights": cells[3], "ms": float(cells[4]), "light_ms": float(cells[5]),
                   "error": float(cells[6].rstrip(" %"))}


def main(source, to):
    rows = list(rows_of(source))
    sizes = list(dict.fromkeys(row["size"] for row in rows))
    methods = list(dict.fromkeys(row["method"] for row in rows))
    plt.rcParams["svg.hashsalt"] = "relight"
    figure, axes = plt.subplots(1, len(sizes), sharey=True, figsize=(4.2 * len(sizes), 4.2))
    for ax, size in zip(axes, sizes):
        for number, method in enumerate(methods):
            here = [row for row in rows if row["size"] == size and row["method"] == method]
            color = f"C{number}"
            ax.plot([r["ms"] for r in here], [r["error"] for r in here], "*" if len(here) == 1 else "o-", color=color, label=method,
                    markersize=11 if len(here) == 1 else 4)
            ax.plot([r["light_ms"] for r in here], [r["error"] for r in here], "x:", color=color, alpha=0.5, markersize=4)
            for r in here if len(here) > 1 else []:
                ax.annotate(r["lights"], (r["ms"], r["error"]), textcoords="offset points", xytext=(3, 4), fontsize=7, color=color)
        ax.set_xscale("log")
        ax.set_title(size.replace(" x ", " × "))
        ax.set_xlabel("ms a frame; dotted: where only the light changes")
        ax.grid(True, which="both", linewidth=0.3)
    axes[0].set_ylabel("error of the relit picture, % of its mean")
    axes[0].legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(to, metadata={"Date": None})


if __name__ == "__main__":
    main(*sys.argv[1:])

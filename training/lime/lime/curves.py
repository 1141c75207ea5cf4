# SPDX-License-Identifier: LGPL-2.1-or-later
"""Loss curves of a training as a picture."""
import matplotlib
import records

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402  (the backend comes first)


TERMS = {"mask", "specular", "mirror", "albedo", "exponent", "rendering", "rendering_albedo"}


def plot(log, picture):
    """One panel per loss term over minutes; held-out samples as dots; stages by shade."""
    seen = [r for r in records.read(log) if "stage" in r]
    terms = sorted({k for r in seen for k in r} & TERMS)
    if not terms:
        return
    figure, axes = pyplot.subplots(len(terms), 1, figsize=(8, 2.2 * len(terms)), sharex=True, squeeze=False)
    order = list(dict.fromkeys(r["stage"] for r in seen))
    for term, (axis,) in zip(terms, axes):
        for number, stage in enumerate(order):
            color = f"C{number}"
            points = [(r["minutes"], r[term]) for r in seen if r["stage"] == stage and term in r]
            held = [(r["minutes"], r["held_out_" + term]) for r in seen
                    if r["stage"] == stage and "held_out_" + term in r]
            if points:
                axis.plot(*zip(*points), color=color, label=stage)
            if held:
                axis.plot(*zip(*held), "o", color=color, markersize=3)
        axis.set_ylabel(term)
        axis.set_yscale("log")
        axis.legend(fontsize=6)
    axes[-1][0].set_xlabel("minutes of training (dots: held-out samples)")
    figure.tight_layout()
    figure.savefig(picture, dpi=90)
    pyplot.close(figure)

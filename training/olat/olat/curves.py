# SPDX-License-Identifier: LGPL-2.1-or-later
"""Loss curves of a training as a picture."""
import matplotlib
import records

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402  (the backend comes first)

TERMS = ("direction", "photometric", "relighting", "perceptual", "held_out_code", "held_out_linear")


def plot(log, picture):
    """One panel per term over minutes."""
    seen = records.read(log)
    terms = [t for t in TERMS if any(t in r for r in seen)]
    if not terms:
        return
    figure, axes = pyplot.subplots(len(terms), 1, figsize=(8, 2.2 * len(terms)), squeeze=False)
    for term, (axis,) in zip(terms, axes):
        axis.plot(*zip(*[(r["minutes"], r[term]) for r in seen if term in r]))
        axis.set_ylabel(term)
        axis.set_yscale("log")
    axes[-1][0].set_xlabel("minutes of training")
    figure.tight_layout()
    figure.savefig(picture, dpi=90)
    pyplot.close(figure)

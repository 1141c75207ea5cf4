# SPDX-License-Identifier: LGPL-2.1-or-later
"""docs/images/edits.jpg, from the strips that edit-bench --png writes: edits.py STRIPS FILE.jpg"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.image
import matplotlib.pyplot as plt

WIDTH = 320
# Strip and, of it, (title, place); places as edit-bench orders them.
RECOLOR = [("before", 0), ("repainted, rendered again", 1), ("recolored, intrinsicdecomp", 5), ("recolored, globalintrinsic", 7)]
DESPILL = [("before, background replaced", -1), ("rendered before gray", 1), ("ffmpeg despill", 2), ("globalintrinsic, despilled", 6)]
ROWS = [("red_wall,_blue", RECOLOR), ("orange_floor,_green", RECOLOR), ("green_screen,_gray", DESPILL)]


def main(folder, to):
    figure, axes = plt.subplots(len(ROWS), 4, figsize=(9.6, 2.0 * len(ROWS)))
    for row, (name, columns) in zip(axes, ROWS):
        strip = matplotlib.image.imread(pathlib.Path(folder) / f"{name}.png")
        parts = [strip[:, x:x + WIDTH] for x in range(0, strip.shape[1], WIDTH)]
        for ax, (title, place) in zip(row, columns):
            ax.imshow(parts[place])
            ax.set_axis_off()
            ax.set_title(title, fontsize=8, pad=3)
    figure.subplots_adjust(left=0.005, right=0.995, top=0.96, bottom=0.005, wspace=0.02, hspace=0.12)
    figure.savefig(to, dpi=120, pil_kwargs={"quality": 88})


main(*sys.argv[1:])

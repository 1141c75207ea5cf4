# SPDX-License-Identifier: LGPL-2.1-or-later
"""Labels that stand beside what they name and keep out of each other's way."""
import numpy as np

# Where a label may stand, in points from what it names: (right, up, horizontal alignment).
BESIDE = [(8, 0, "left"), (7, 8, "left"), (7, -8, "left"), (-8, 0, "right"), (-7, 8, "right"), (-7, -8, "right"),
          (8, 16, "left"), (8, -16, "left"), (0, 12, "center"), (0, -12, "center"), (8, 26, "left"), (8, -26, "left"),
          (8, 36, "left"), (8, -36, "left"),
          (0, 24, "center"), (0, -24, "center"), (-8, 26, "right"), (-8, -26, "right"), (0, 40, "center"), (0, -40, "center")]
BELOW = [(0, -13, "center"), (-9, -11, "right"), (9, -11, "left"), (0, -22, "center"), (0, 13, "center"),
         (-10, 8, "right"), (10, 9, "left"), (0, -31, "center"), (0, 22, "center"), (0, -40, "center")]
ABOVE = [(0, 8, "center"), (0, -9, "center"), (-6, 6, "right"), (6, 6, "left"), (0, 16, "center"), (0, -17, "center")]


class Labels:
    """Of one axes. Say first what must stay visible (`avoid`), then the labels, the important ones first; the limits of
    the axes must be final."""

    def __init__(self, ax):
        self.ax = ax
        self.boxes = []  # left, bottom, right, top in pixels
        self.scale = ax.figure.dpi / 72

    def avoid(self, x, y, points=4):
        px, py = self.ax.transData.transform((x, y))
        r = points * self.scale
        self.boxes.append((px - r, py - r, px + r, py + r))

    def avoid_line(self, xs, ys, points=1.5):
        """Keeps off the middle of a polygonal line, too."""
        for (x0, y0), (x1, y1) in zip(zip(xs, ys), zip(xs[1:], ys[1:])):
            a, b = self.ax.transData.transform([(x0, y0), (x1, y1)])
            steps = max(2, int(abs(b - a).max() / (6 * self.scale)))
            for k in range(steps + 1):
                px, py = a + (b - a) * k / steps
                r = points * self.scale
                self.boxes.append((px - r, py - r, px + r, py + r))

    def overlap(self, box):
        """Area that a box shares with others, and what lies outside of the axes."""
        boxes = np.array(self.boxes or np.empty((0, 4)))
        wide = np.minimum(boxes[:, 2], box[2]) - np.maximum(boxes[:, 0], box[0])
        high = np.minimum(boxes[:, 3], box[3]) - np.maximum(boxes[:, 1], box[1])
        met = (wide >= 0) & (high >= 0)
        area = float((np.maximum(wide, 1) * np.maximum(high, 1))[met].sum())
        x0, y0, x1, y1 = self.ax.bbox.extents
        inside = max(0, min(x1, box[2]) - max(x0, box[0])) * max(0, min(y1, box[3]) - max(y0, box[1]))
        return area + 4 * ((box[2] - box[0]) * (box[3] - box[1]) - inside)

    def put(self, x, y, text, color, places=BESIDE, size=8, weight="normal"):
        px, py = self.ax.transData.transform((x, y))
        width, height = (0.60 if weight == "bold" else 0.55) * size * len(text) * self.scale, 1.15 * size * self.scale
        best = None
        for rank, (right, up, align) in enumerate(places):
            left = px + right * self.scale - {"left": 0, "center": width / 2, "right": width}[align]
            middle = py + up * self.scale
            box = (left, middle - height / 2, left + width, middle + height / 2)
            cost = self.overlap(box) + rank * 0.5
            if best is None or cost < best[0]:
                best = (cost, right, up, align, box)
        _, right, up, align, box = best
        self.boxes.append(box)
        far = abs(up) > 16
        self.ax.annotate(text, (x, y), (right, up), textcoords="offset points", fontsize=size, color=color, ha=align,
                         va="center", fontweight=weight, zorder=6,
                         bbox={"facecolor": "white", "alpha": 0.65, "edgecolor": "none", "pad": 0.4},
                         arrowprops={"arrowstyle": "-", "color": color, "lw": 0.5, "alpha": 0.6} if far else None)

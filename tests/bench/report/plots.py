# SPDX-License-Identifier: LGPL-2.1-or-later
"""The report's plots, as PNG. Colors are Okabe and Ito's, which colorblind people can tell apart; every curve
also has a marker of its own and is labeled where it lies."""
import math

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams.update({
    "font.family": "DejaVu Sans", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "grid.color": "#e4e4e4", "grid.linewidth": 0.6, "axes.edgecolor": "#666666",
    "axes.axisbelow": True, "xtick.color": "#444444", "ytick.color": "#444444", "axes.titlesize": 10,
    "axes.titleweight": "bold", "axes.titlelocation": "left"})
import matplotlib.pyplot as plt
from matplotlib import ticker

import summary
import tables
from labels import ABOVE, BELOW, Labels

INK, FAINT = "#222222", "#8a8a8a"
STYLES = {"intrinsicdecomp": ("#0072B2", "o"), "globalintrinsic": ("#E69F00", "p"), "globalintrinsicthesis": ("#7A5C00", "H"),
          "thesis PCG": ("#D55E00", "s"), "thesis Schwarz": ("#CC79A7", "D"),
          "same energy, CPU CG": ("#56B4E9", "v"), "same energy, CPU Cholesky": ("#56B4E9", "^"),
          "gray Retinex": ("#009E73", "P"), "color Retinex": ("#009E73", "X"),
          "fast global smoother": ("#8a8a8a", "<"), "domain transform": ("#8a8a8a", ">"),
          "guided filter": ("#8a8a8a", "h"), "l0 smoothing": ("#8a8a8a", "d"), "R = I / max_c I": ("#222222", "*"),
          "constant shading": ("#222222", "_"), "constant reflectance": ("#222222", "|")}
SPARE = [("#F0E442", "H"), ("#000000", "8")]  # methods to come
# The curves that are joined in the main diagrams; a method that is not here shows all of its points.
MAIN = {"intrinsicdecomp": "quality", "globalintrinsic": "quality", "thesis PCG": "iterations", "thesis Schwarz": "iterations",
        "same energy, CPU CG": "tolerance"}
SIDE = ["adaptive", "without", "weights", "guess", "keyframes", "resolution", "levels", "coarse cycles", "cycles", "base colors",
        "with", "video", "video quality"]  # have plots of their own
LMSE = "LMSE (k = 20)"
TIME_NAMES = {"wall_ms": "milliseconds on the clock, 320×240", "device_ms": "milliseconds on the device, 320×240",
              "processor_ms": "milliseconds of processor time, 320×240"}


def style(method):
    if method not in STYLES:
        STYLES[method] = SPARE[len(STYLES) % len(SPARE)]
    return STYLES[method]


def plain_log(axis, ratio):
    """A logarithmic axis with few, plain numbers."""
    subs = (1,) if ratio > 300 else (1, 2, 5) if ratio > 8 else (1, 1.5, 2, 3, 4, 5, 6, 8)
    axis.set_major_locator(ticker.LogLocator(base=10, subs=subs))
    axis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(ticker.NullFormatter())


def finish_axes(ax, xs, ys, xlabel, ylabel):
    """Limits that leave room for names, on the right above all."""
    ax.set_xscale("log")
    ax.set_yscale("log")
    xs, ys = [x for x in xs if x > 0], [y for y in ys if y > 0]
    wide, high = max(1.5, max(xs) / min(xs)), max(1.2, max(ys) / min(ys))
    ax.set_xlim(min(xs) / wide ** 0.06, max(xs) * wide ** 0.22)
    ax.set_ylim(min(ys) / high ** 0.14, max(ys) * high ** 0.12)
    plain_log(ax.xaxis, wide)
    plain_log(ax.yaxis, high)
    ax.set_xlabel(xlabel)
    ax.set_ylabel(ylabel)


def extent(points, error, time):
    return [v for p in points for v in p[time][:3] if v > 0], [p[error] for p in points]


def usable(points, error, time):
    return [p for p in points if p[time] and p[error]]


def draw_curve(ax, points, error, time, labels, line="-"):
    """Points with the quartiles of their times, joined."""
    if not points:
        return
    color, marker = style(points[0]["method"])
    x, y = [p[time][1] for p in points], [p[error] for p in points]
    spread = [[p[time][1] - p[time][0] for p in points], [p[time][2] - p[time][1] for p in points]]
    ax.errorbar(x, y, xerr=spread, fmt="none", ecolor=color, alpha=0.35, elinewidth=2.2, zorder=2)
    ax.plot(x, y, line, color=color, marker=marker, markersize=5 if len(points) > 1 else 7, linewidth=1.4, zorder=3, markeredgecolor="white",
            markeredgewidth=0.5)
    labels.avoid_line(x, y)
    for a, b in zip(x, y):
        labels.avoid(a, b)


def mark_presets(ax, points, error, time, labels):
    for p in points:
        if p["preset"] and p["curve"] == MAIN.get(p["method"]):
            color, _ = style(p["method"])
            ax.plot(p[time][1], p[error], "o", markersize=11, markerfacecolor="none", markeredgecolor=color,
                    markeredgewidth=1.3, zorder=4)
            labels.put(p[time][1], p[error], p["preset"], color, BELOW, 7, "bold" if p["base"] else "normal")


def name_curves(points, error, time, labels):
    """A curve's name stands at its slow end."""
    for method in dict.fromkeys(p["method"] for p in points):
        end = max((p for p in points if p["method"] == method), key=lambda p: p[time][1])
        labels.put(end[time][1], end[error], method, style(method)[0])


def mark_front(ax, points, error, time, labels):
    front = summary.front(points, error, time)
    if not front:
        return
    xs, ys = [front[0][time][1]], [front[0][error]]
    for p in front[1:]:
        xs += [p[time][1], p[time][1]]
        ys += [ys[-1], p[error]]
    ax.plot(xs + [ax.get_xlim()[1]], ys + [ys[-1]], color=INK, linewidth=5, alpha=0.10, solid_joinstyle="miter", zorder=1)
    labels.put(ax.get_xlim()[1], ys[-1], "Pareto front", FAINT, [(-4, -8, "right"), (-4, 8, "right"), (-4, -18, "right")], 7)


def save(figure, folder, name):
    figure.savefig(folder / f"{name}.png", dpi=140, bbox_inches="tight", facecolor="white")
    plt.close(figure)


def main_points(points, error, time, peers):
    """What the main diagrams show: the main curves of methods, and of each peer the setting with the least error, so that
    nobody profits from a bad choice of ours."""
    shown, best = [], {}
    for p in usable(points, error, time):
        if p["curve"] in SIDE:
            continue
        if p["method"] in MAIN:
            if p["curve"] == MAIN[p["method"]]:
                shown.append(p)
        elif peers is None or p["method"] in peers:
            if p["method"] not in best or p[error] < best[p["method"]][error]:
                best[p["method"]] = p
    return shown, list(best.values())


def draw_work_precision(ax, points, error, time, peers=None):
    curves, singles = main_points(points, error, time, peers)
    if not curves + singles:
        return False
    finish_axes(ax, *extent(curves + singles, error, time), TIME_NAMES[time], LMSE)
    labels = Labels(ax)
    for method in dict.fromkeys(p["method"] for p in curves):
        draw_curve(ax, sorted((p for p in curves if p["method"] == method), key=lambda p: p["order"]), error, time, labels)
    for p in singles:
        draw_curve(ax, [p], error, time, labels)
    mark_front(ax, curves + singles, error, time, labels)
    mark_presets(ax, curves, error, time, labels)
    name_curves(curves + singles, error, time, labels)
    return True


def work_precision(points, folder, title):
    figure, ax = plt.subplots(figsize=(9, 5.6))
    draw_work_precision(ax, points, "lmse20", "wall_ms")
    ax.set_ylabel("error to ground truth: " + LMSE)
    ax.set_title(title, pad=12)
    save(figure, folder, "work-precision")


def regimes(by_regime, folder):
    """Small multiples: one panel a regime."""
    names = [n for n, points in by_regime.items() if usable(points, "lmse20", "wall_ms")]
    if not names:
        return False
    columns = min(2, len(names))
    rows = math.ceil(len(names) / columns)
    figure, axes = plt.subplots(rows, columns, squeeze=False, figsize=(5.2 * columns, 3.7 * rows))
    for ax, name in zip(axes.flat, names):
        draw_work_precision(ax, by_regime[name], "lmse20", "wall_ms", ("R = I / max_c I", "color Retinex", "gray Retinex"))
        scenes = max(p["scenes"] for p in by_regime[name])
        ax.set_title(f"{name} ({scenes} scene{'s' if scenes > 1 else ''})")
    for ax in axes.flat[len(names):]:
        ax.axis("off")
    figure.tight_layout()
    save(figure, folder, "regimes")
    return True


def adaptivity(entries, clock, folder):
    """What skipping work saves: time with it over time without, by scene, a panel for each method."""
    ratio = clock.replace("_ms", "_ratio")
    panels = {}
    for e in entries:
        if e.get(ratio):
            panels.setdefault(e["element"], {})[f"{e['scene']}, {e['width']}×{e['height']}"] = e[ratio]
    if not panels:
        return False
    panels = dict(sorted(panels.items(), key=lambda p: tables.OURS.index(p[0]) if p[0] in tables.OURS else len(tables.OURS)))
    scenes = sorted({s for of in panels.values() for s in of}, key=lambda s: -next(of[s][1] for of in panels.values() if s in of))
    figure, axes = plt.subplots(1, len(panels), squeeze=False, sharey=True, figsize=(4.2 + 4 * len(panels), 0.46 * len(scenes) + 1.3))
    name = {"processor_ms": "processor time", "device_ms": "device time"}[clock]
    most = max(r[2] for of in panels.values() for r in of.values())
    for ax, (method, of) in zip(axes.flat, panels.items()):
        for k, scene in enumerate(scenes):
            if scene not in of:
                continue
            low, middle, high = of[scene]
            color = "#0072B2" if high < 1 else "#D55E00" if low > 1 else FAINT
            ax.plot([low, high], [k, k], color=color, linewidth=4, alpha=0.35, solid_capstyle="butt")
            ax.plot(middle, k, "o", color=color, markersize=6)
            ax.annotate(f"{1 / middle:.{2 if middle > 0.1 else 0}f}× faster" if middle < 1 else f"{middle:.2f}× the time", (middle, k), (0, 9),
                        textcoords="offset points", fontsize=7, color=color, ha="center", va="center")
        ax.axvline(1, color=INK, linewidth=0.8)
        ax.set_yticks(range(len(scenes)), scenes)
        ax.set_ylim(-0.6, len(scenes) - 0.3)
        ax.set_xlim(0, max(1.2, most * 1.05))
        ax.grid(axis="y", visible=False)
        ax.set_title(method)
    figure.supxlabel(f"{name} with adaptive=true over that without; median of interleaved pairs, 95 % interval", fontsize=9)
    figure.suptitle("Time saved by skipping work")
    figure.tight_layout()
    save(figure, folder, "adaptivity")
    return True


def sizes(elements, folder):
    """Milliseconds a frame by size, through the elements."""
    figure, ax = plt.subplots(figsize=(8, 4))
    finish_axes(ax, [e["width"] * e["height"] for e in elements], [e["wall_ms"] for e in elements], "size of a frame",
                "milliseconds a frame, memory to memory")
    labels = Labels(ax)
    methods = {"intrinsicdecompthesis": "thesis PCG", "intrinsicdecomp quality=low": "same energy, CPU CG"}
    for rate in (25, 50):
        ax.axhline(1000 / rate, color=FAINT, linewidth=0.8, linestyle="--")
        ax.annotate(f"{rate} frames a second", (ax.get_xlim()[1], 1000 / rate), (-2, 5), textcoords="offset points",
                    fontsize=7, color=FAINT, ha="right")
    lines = {}
    for e in elements:
        lines.setdefault(e["element"], []).append(e)
    for element, line in lines.items():
        x, y = [e["width"] * e["height"] for e in line], [e["wall_ms"] for e in line]
        color, marker = style(methods.get(element, element))
        ax.plot(x, y, "-", marker=marker, color=color, linewidth=1.4)
        labels.avoid_line(x, y)
    for element, line in lines.items():
        color, _ = style(methods.get(element, element))
        labels.put(line[-1]["width"] * line[-1]["height"], line[-1]["wall_ms"], element, color)
        for e in line:
            labels.put(e["width"] * e["height"], e["wall_ms"], f"{e['wall_ms']:.0f} ms", color, ABOVE, 7)
    ticks = list(dict.fromkeys((e["width"], e["height"]) for e in elements))
    ax.xaxis.set_major_locator(ticker.FixedLocator([w * h for w, h in ticks]))
    ax.xaxis.set_major_formatter(ticker.FixedFormatter([f"{w}×{h}" for w, h in ticks]))
    ax.xaxis.set_minor_locator(ticker.NullLocator())
    ax.set_title("Through the elements")
    save(figure, folder, "sizes")


def quality_panel(ax, points, error, ylabel, time, front_of=None):
    """Curves of quality levels with presets; the front is that of `front_of` alone, if given."""
    points = usable(points, error, time)
    finish_axes(ax, *extent(points, error, time), TIME_NAMES[time], ylabel)
    labels = Labels(ax)
    for method in dict.fromkeys(p["method"] for p in points):
        draw_curve(ax, sorted((p for p in points if p["method"] == method), key=lambda p: p["order"]), error, time, labels)
    mark_front(ax, [p for p in points if front_of in (None, p["method"])], error, time, labels)
    for p in points:
        if p["preset"]:
            color, _ = style(p["method"])
            ax.plot(p[time][1], p[error], "o", markersize=11, markerfacecolor="none", markeredgecolor=color, markeredgewidth=1.3)
            labels.put(p[time][1], p[error], p["preset"], color, BELOW, 7, "bold" if p["preset"] == "medium" else "normal")
    name_curves(points, error, time, labels)


def fronts(videos, regimes, time, folder):
    """What presets buy that LMSE of single stills does not show."""
    ours = ("intrinsicdecomp", "globalintrinsic")
    panels = [("Flicker, own videos", [p for p in videos if p["method"] in ours], "flicker", "flicker: standard deviation of ln R over time")]
    for regime, heading in (("MIT objects", "Real objects (MIT)"), ("hard shadow", "Hard shadows")):
        panels.append((heading, [p for p in regimes.get(regime, []) if p["method"] in ours and p["curve"] == "quality"], "lmse20", LMSE))
    panels = [panel for panel in panels if len(usable(panel[1], panel[2], time)) > 2]
    if not panels:
        return False
    figure, axes = plt.subplots(1, len(panels), squeeze=False, figsize=(4.9 * len(panels), 4.3))
    for ax, (heading, points, error, ylabel) in zip(axes.flat, panels):
        quality_panel(ax, points, error, ylabel, time, "intrinsicdecomp")
        ax.set_title(heading)
    figure.tight_layout()
    save(figure, folder, "fronts")
    return True

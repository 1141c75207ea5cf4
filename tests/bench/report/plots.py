"""The report's plots, as PNG and SVG. Colors are Okabe and Ito's, which colorblind people can tell apart; every curve
also has a marker of its own and is labeled where it lies."""
import math

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams.update({
    "font.family": "DejaVu Sans", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "grid.color": "#e4e4e4", "grid.linewidth": 0.6, "axes.edgecolor": "#666666",
    "axes.axisbelow": True, "xtick.color": "#444444", "ytick.color": "#444444", "axes.titlesize": 10,
    "axes.titleweight": "bold", "axes.titlelocation": "left", "svg.hashsalt": "gst-inverse", "svg.fonttype": "none"})
import matplotlib.pyplot as plt
from matplotlib import patheffects, ticker

import summary

INK, FAINT = "#222222", "#8a8a8a"
HALO = [patheffects.withStroke(linewidth=2.5, foreground="white")]  # keeps texts readable over lines
STYLES = {"intrinsicdecomp": ("#0072B2", "o"), "thesis PCG": ("#D55E00", "s"), "thesis Schwarz": ("#CC79A7", "D"),
          "same energy, CPU CG": ("#56B4E9", "v"), "same energy, CPU Cholesky": ("#56B4E9", "^"),
          "gray Retinex": ("#009E73", "P"), "color Retinex": ("#009E73", "X"),
          "fast global smoother": ("#8a8a8a", "<"), "domain transform": ("#8a8a8a", ">"),
          "guided filter": ("#8a8a8a", "h"), "l0 smoothing": ("#8a8a8a", "d"), "R = I / max_c I": ("#222222", "*"),
          "constant shading": ("#222222", "_"), "constant reflectance": ("#222222", "|")}
SPARE = [("#E69F00", "p"), ("#F0E442", "H"), ("#000000", "8")]  # methods to come
MAIN = {"intrinsicdecomp": "cycles", "thesis PCG": "iterations", "thesis Schwarz": "iterations",
        "same energy, CPU CG": "tolerance"}
ERROR_NAMES = {"lmse20": "LMSE (k = 20)", "mse": "scale-invariant MSE", "dssim": "DSSIM",
               "to_converged": "distance to the converged solution, rms of ln R"}


def style(method):
    if method not in STYLES:
        STYLES[method] = SPARE[len(STYLES) % len(SPARE)]
    return STYLES[method]


def number(value, _=None):
    return f"{value:g}"


def plain_log(axis, ratio):
    """A logarithmic axis with few, plain numbers."""
    axis.set_major_locator(ticker.LogLocator(base=10, subs=(1, 2, 5) if ratio < 200 else (1,)))
    axis.set_major_formatter(ticker.FuncFormatter(number))
    axis.set_minor_formatter(ticker.NullFormatter())


def finish_axes(ax, xs, ys, xlabel, ylabel):
    ax.set_xscale("log")
    ax.set_yscale("log")
    xs, ys = [x for x in xs if x > 0], [y for y in ys if y > 0]
    span = max(1.5, max(xs) / min(xs))
    ax.set_xlim(min(xs) / span ** 0.06, max(xs) * span ** 0.22)  # names stand on the right
    span = max(1.2, max(ys) / min(ys))
    ax.set_ylim(min(ys) / span ** 0.12, max(ys) * span ** 0.12)
    plain_log(ax.xaxis, max(xs) / min(xs))
    plain_log(ax.yaxis, max(ys) / min(ys))
    ax.set_xlabel(xlabel)
    ax.set_ylabel(ylabel)


def curve_of(points, method, curve):
    """A method's points along a curve in its order, the default last where it is not one of them."""
    return sorted((p for p in points if p["method"] == method and (p["curve"] == curve or p["base"]) and p["wall_ms"]),
                  key=lambda p: p["order"] if p["curve"] == curve else math.inf)


def draw_curve(ax, points, error, method, time, line="-", labels=True, faint=False):
    color, marker = style(method)
    points = [p for p in points if p[time] and p[error]]
    if not points:
        return
    x, y = [p[time][1] for p in points], [p[error] for p in points]
    spread = [[p[time][1] - p[time][0] for p in points], [p[time][2] - p[time][1] for p in points]]
    ax.errorbar(x, y, xerr=spread, fmt="none", ecolor=color, alpha=0.35, elinewidth=2.2, capsize=0, zorder=2)
    ax.plot(x, y, line, color=color, marker=marker, markersize=4.5, linewidth=1.4, alpha=0.55 if faint else 1, zorder=3,
            markeredgecolor="white", markeredgewidth=0.5)
    if labels:
        for p, a, b in zip(points, x, y):
            ax.annotate(p["setting"], (a, b), (0, 5), textcoords="offset points", fontsize=6.5, color=color,
                        ha="center", va="bottom", path_effects=HALO, zorder=6)


def name_at(ax, x, y, text, color, offset=(7, 0), ha="left", size=8, weight="normal"):
    ax.annotate(text, (x, y), offset, textcoords="offset points", fontsize=size, color=color, ha=ha, va="center",
                fontweight=weight, zorder=6, path_effects=HALO)


def spread_labels(ax, labels):
    """Puts texts (x, y, text, color) right of their points, moved apart vertically where they would overlap. Call when
    the axes' limits are final."""
    figure = ax.figure
    placed = []
    for x, y, text, color in sorted(labels, key=lambda l: l[1]):
        px, py = ax.transData.transform((x, y))
        width, height = 5.2 * len(text) * figure.dpi / 100, 11 * figure.dpi / 100
        target = py
        for (qx, qy, qwidth) in placed:
            if px < qx + qwidth and qx < px + width and abs(target - qy) < height:
                target = max(target, qy + height)
        placed.append((px, target, width))
        moved = (target - py) * 72 / figure.dpi
        ax.annotate(text, (x, y), (8, moved), textcoords="offset points", fontsize=7.5, color=color, va="center",
                    ha="left", arrowprops={"arrowstyle": "-", "color": color, "lw": 0.4, "alpha": 0.6}
                    if abs(moved) > 6 else None, zorder=6, path_effects=HALO)


def mark_presets(ax, points, error, time):
    for p in points:
        if p["preset"] and p[time] and p[error] and p["curve"] in MAIN.values():
            color, _ = style(p["method"])
            ax.plot(p[time][1], p[error], "o", markersize=11, markerfacecolor="none", markeredgecolor=color,
                    markeredgewidth=1.3, zorder=4)
            ax.annotate(p["preset"], (p[time][1], p[error]), (0, -9), textcoords="offset points", fontsize=7,
                        color=color, ha="center", va="top", fontweight="bold" if p["base"] else "normal", zorder=6,
                        path_effects=HALO)


def mark_front(ax, points, error, time):
    front = summary.front(points, error, time)
    if not front:
        return
    xs, ys = [front[0][time][1]], [front[0][error]]
    for p in front[1:]:
        xs += [p[time][1], p[time][1]]
        ys += [ys[-1], p[error]]
    ax.plot(xs + [ax.get_xlim()[1]], ys + [ys[-1]], color=INK, linewidth=5, alpha=0.10, solid_joinstyle="miter", zorder=1)
    ax.annotate("Pareto front", (ax.get_xlim()[1], ys[-1]), (-4, -8), textcoords="offset points", fontsize=7, color=FAINT,
                va="center", ha="right", path_effects=HALO)


def extent(points, error, time):
    usable = [p for p in points if p[time] and p[error]]
    return [v for p in usable for v in p[time][:3] if v > 0], [p[error] for p in usable]


def save(figure, folder, name):
    figure.savefig(folder / f"{name}.png", dpi=160, bbox_inches="tight", facecolor="white")
    figure.savefig(folder / f"{name}.svg", bbox_inches="tight", facecolor="white",
                   metadata={"Date": None, "Creator": None})
    plt.close(figure)
    svg = folder / f"{name}.svg"  # no trailing blanks in the repository
    svg.write_text("\n".join(line.rstrip() for line in svg.read_text().splitlines()) + "\n")


def draw_work_precision(ax, points, error, time, all_peers=True):
    """All methods: curves of the main settings, the rest as single points."""
    kept = [p for p in points if p["curve"] == MAIN.get(p["method"], p["curve"]) or p["base"]]
    if not all_peers:
        kept = [p for p in kept if p["method"] in MAIN or p["method"] in ("R = I / max_c I", "color Retinex",
                                                                         "gray Retinex")]
    kept = [p for p in kept if p["curve"] not in ("without", "keyframes") and p[time] and p[error]]
    # Of peers' points only the best one of each is shown, so that nobody profits from a bad choice of ours.
    best = {}
    for p in kept:
        if p["method"] not in MAIN and (p["method"] not in best or p[error] < best[p["method"]][error]):
            best[p["method"]] = p
    shown = [p for p in kept if p["method"] in MAIN] + list(best.values())
    if not shown:
        return False
    xs, ys = extent(shown, error, time)
    finish_axes(ax, xs, ys, "", "")
    labels = []
    for method, curve in MAIN.items():
        own = [p for p in curve_of(shown, method, curve) if p[error]]
        draw_curve(ax, own, error, method, time, labels=False)
        if own:
            end = max(own, key=lambda p: p[time][1])
            labels.append((end[time][1], end[error], method, style(method)[0]))
    for p in best.values():
        color, marker = style(p["method"])
        ax.errorbar(p[time][1], p[error], xerr=[[p[time][1] - p[time][0]], [p[time][2] - p[time][1]]], fmt=marker,
                    color=color, markersize=6, elinewidth=2.2, ecolor=color, alpha=0.9, zorder=3)
        labels.append((p[time][1], p[error], p["method"], color))
    mark_presets(ax, shown, error, time)
    mark_front(ax, shown, error, time)
    spread_labels(ax, labels)
    return True


TIME_NAMES = {"wall_ms": "milliseconds on the clock, 320×240", "device_ms": "milliseconds on the device, 320×240",
              "processor_ms": "milliseconds of processor time, 320×240"}


def work_precision(points, folder, title):
    figure, ax = plt.subplots(figsize=(9, 5.4))
    draw_work_precision(ax, points, "lmse20", "wall_ms")
    ax.set_xlabel(TIME_NAMES["wall_ms"])
    ax.set_ylabel("error to ground truth: " + ERROR_NAMES["lmse20"])
    ax.set_title(title, pad=12)
    save(figure, folder, "work-precision")


def device_time(points, folder):
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.2))
    own = [p for p in points if p["method"] in MAIN and p["curve"] == MAIN[p["method"]]]
    for ax, time in zip(axes, ("device_ms", "processor_ms")):
        shown = [p for p in own if p[time] and p["lmse20"]]
        if not shown:
            continue
        finish_axes(ax, *extent(shown, "lmse20", time), TIME_NAMES[time], ERROR_NAMES["lmse20"])
        labels = []
        for method, curve in MAIN.items():
            line = sorted((p for p in shown if p["method"] == method), key=lambda p: p["order"])
            draw_curve(ax, line, "lmse20", method, time, labels=False)
            if line:
                labels.append((line[-1][time][1], line[-1]["lmse20"], method, style(method)[0]))
        mark_presets(ax, shown, "lmse20", time)
        spread_labels(ax, labels)
    axes[0].set_title("By the device's clock")
    axes[1].set_title("By processor time, all threads")
    figure.tight_layout()
    save(figure, folder, "device-time")


def convergence(points, folder):
    figure, ax = plt.subplots(figsize=(9, 4.6))
    shown = [p for p in points if p["to_converged"] and p["wall_ms"] and p["curve"] in
             ("cycles", "iterations", "tolerance")]
    if not shown:
        plt.close(figure)
        return False
    finish_axes(ax, *extent(shown, "to_converged", "wall_ms"), TIME_NAMES["wall_ms"], ERROR_NAMES["to_converged"])
    labels = []
    for method in dict.fromkeys(p["method"] for p in shown):
        line = sorted((p for p in shown if p["method"] == method), key=lambda p: p["order"])
        draw_curve(ax, line, "to_converged", method, "wall_ms")
        end = line[-1]
        labels.append((end["wall_ms"][1], end["to_converged"], method, style(method)[0]))
    mark_presets(ax, shown, "to_converged", "wall_ms")
    spread_labels(ax, labels)
    ax.set_title("How far from done: distance to each method's own converged solution")
    save(figure, folder, "convergence")
    return True


def knobs(points, folder):
    """What else can be turned, from each method's default."""
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.4), sharey=True)
    ours = ("intrinsicdecomp", "thesis PCG", "thesis Schwarz")
    lines = [[(m, MAIN[m], "-"), (m, "resolution", "--"), (m, "levels", ":"), (m, "coarse cycles", "-.")] for m in ours]
    shown = [p for p in points if p["method"] in ours and p["lmse20"] and p["wall_ms"] and
             p["curve"] in {c for line in lines for _, c, _ in line}]
    if not shown:
        plt.close(figure)
        return
    for ax, methods, title in ((axes[0], ours[:1], "intrinsicdecomp"), (axes[1], ours[1:], "the thesis' method")):
        some = [p for p in shown if p["method"] in methods]
        finish_axes(ax, extent(some, "lmse20", "wall_ms")[0], extent(shown, "lmse20", "wall_ms")[1],
                    TIME_NAMES["wall_ms"], ERROR_NAMES["lmse20"] if ax is axes[0] else "")
        labels = []
        for line in lines:
            for method, curve, dash in line:
                along = curve_of(some, method, curve)
                if len(along) < 2 or method not in methods:
                    continue
                draw_curve(ax, along, "lmse20", method, "wall_ms", dash, labels=False)
                for p in along:
                    if p["curve"] == curve and (curve != MAIN[method] or p["order"] in (1, 8, 24, 16, 128, 256)):
                        name_at(ax, p["wall_ms"][1], p["lmse20"], p["setting"], style(method)[0], (0, 7), "center", 6.5)
                far = max((p for p in along if p["curve"] == curve),
                          key=lambda p: abs(p["order"] - 4) if curve == MAIN[method] else abs(p["order"]))
                name = curve if len(methods) == 1 else f"{method.split()[1]}: {curve}"
                labels.append((far["wall_ms"][1], far["lmse20"], name, style(method)[0]))
        spread_labels(ax, labels)
        ax.set_title(title)
    figure.tight_layout()
    save(figure, folder, "knobs")


def regimes(by_regime, folder):
    """Small multiples: one panel a regime."""
    names = [n for n, points in by_regime.items() if points]
    if not names:
        return False
    columns = min(2, len(names))
    figure, axes = plt.subplots(math.ceil(len(names) / columns), columns, squeeze=False,
                                figsize=(5.2 * columns, 3.9 * math.ceil(len(names) / columns)))
    for ax, name in zip(axes.flat, names):
        if draw_work_precision(ax, by_regime[name], "lmse20", "wall_ms", all_peers=False):
            ax.set_title(f"{name} ({max(p['scenes'] for p in by_regime[name])} scenes)")
            ax.set_xlabel(TIME_NAMES["wall_ms"])
            ax.set_ylabel(ERROR_NAMES["lmse20"])
    for ax in axes.flat[len(names):]:
        ax.axis("off")
    figure.tight_layout()
    save(figure, folder, "regimes")
    return True


def adaptivity(entries, folder):
    """What leaving out saves: time with it over time without, by scene."""
    entries = [e for e in entries if e["wall_ratio"] and e["video"]]
    if not entries:
        return False
    entries = sorted(entries, key=lambda e: e["wall_ratio"][1])
    figure, ax = plt.subplots(figsize=(8, 0.34 * len(entries) + 1.2))
    for k, e in enumerate(entries):
        low, middle, high = e["wall_ratio"]
        color = "#0072B2" if high < 1 else "#D55E00" if low > 1 else FAINT
        ax.plot([low, high], [k, k], color=color, linewidth=3, alpha=0.35, solid_capstyle="butt")
        ax.plot(middle, k, "o", color=color, markersize=6)
        name_at(ax, middle, k, f"{1 / middle:.2f}× faster" if middle < 1 else f"{middle:.2f}× the time", color, (0, 9),
                "center", 7)
    ax.axvline(1, color=INK, linewidth=0.8)
    ax.set_yticks(range(len(entries)), [f"{e['scene']}{'' if e['set'] == 'own' else ' (' + e['set'] + ')'}: {e['regime']}"
                                        for e in entries])
    ax.set_ylim(-0.7, len(entries) - 0.2)
    ax.set_xlim(0, max(1.2, max(e["wall_ratio"][2] for e in entries) * 1.05))
    ax.grid(axis="y", visible=False)
    ax.set_xlabel("time with adaptive=true over time without; median of interleaved pairs, 95 % interval")
    ax.set_title("What leaving out saves")
    save(figure, folder, "adaptivity")
    return True


def sizes(elements, folder):
    """Milliseconds a frame by size, through the elements."""
    figure, ax = plt.subplots(figsize=(8, 4))
    names = {"intrinsicdecomp": "intrinsicdecomp", "intrinsicdecompthesis": "thesis PCG"}
    xs, ys, labels = [], [], []
    for element in dict.fromkeys(e["element"] for e in elements):
        line = [e for e in elements if e["element"] == element]
        x, y = [e["width"] * e["height"] / 1e6 for e in line], [e["wall_ms"] for e in line]
        color, marker = style(names.get(element, element))
        ax.plot(x, y, "-", marker=marker, color=color, linewidth=1.4)
        for a, b in zip(x, y):
            name_at(ax, a, b, f"{b:.0f} ms", color, (0, 9), "center", 7)
        labels.append((x[-1], y[-1], element, color))
        xs += x
        ys += y
    finish_axes(ax, xs, ys, "size of a frame", "milliseconds a frame, memory to memory")
    for rate in (25, 50):
        ax.axhline(1000 / rate, color=FAINT, linewidth=0.8, linestyle="--")
        ax.annotate(f"{rate} frames a second", (ax.get_xlim()[0], 1000 / rate), (4, 4), textcoords="offset points",
                    fontsize=7, color=FAINT)
    ticks = dict.fromkeys((e["width"], e["height"]) for e in elements)
    ax.xaxis.set_major_locator(ticker.FixedLocator([w * h / 1e6 for w, h in ticks]))
    ax.xaxis.set_major_formatter(ticker.FixedFormatter([f"{w}×{h}" for w, h in ticks]))
    ax.xaxis.set_minor_locator(ticker.NullLocator())
    spread_labels(ax, labels)
    ax.set_title("Through the elements")
    save(figure, folder, "sizes")


def conditions(extremes, folder):
    cases = extremes["cases"]
    figure, ax = plt.subplots(figsize=(8, 4))
    for field, color, marker, name in (("digits_plain", "#D55E00", "s", "plain"),
                                       ("digits_preconditioned", "#0072B2", "o", "preconditioned")):
        line = sorted((c["condition"], c[field]) for c in cases if c.get(field) is not None)
        if not line:
            continue
        ax.plot(*zip(*line), marker=marker, color=color, linestyle="none", alpha=0.8)
        name_at(ax, *line[-1], name, color)
    ax.set_xscale("log")
    ax.set_xlabel("condition number of the normal equations")
    ax.set_ylabel("correct decimal digits in single precision")
    ax.set_title("Condition number against digits kept")
    save(figure, folder, "conditions")

# SPDX-License-Identifier: LGPL-2.1-or-later
"""More plots: fronts by what people see in video, methods that know of bounced light, what base colors cost, and frame
times while something else is decided."""
from matplotlib import pyplot as plt

import light
import plots
import summary
from labels import BELOW, Labels


def quality_panel(ax, points, error, ylabel, time, front_of=None):
    """Curves of quality levels with presets; the front is that of `front_of` alone, if given."""
    points = plots.usable(points, error, time)
    plots.finish_axes(ax, *plots.extent(points, error, time), plots.TIME_NAMES[time], ylabel)
    labels = Labels(ax)
    for method in dict.fromkeys(p["method"] for p in points):
        plots.draw_curve(ax, sorted((p for p in points if p["method"] == method), key=lambda p: p["order"]), error, time, labels)
    plots.mark_front(ax, [p for p in points if front_of in (None, p["method"])], error, time, labels)
    for p in points:
        if p["preset"]:
            color, _ = plots.style(p["method"])
            ax.plot(p[time][1], p[error], "o", markersize=11, markerfacecolor="none", markeredgecolor=color, markeredgewidth=1.3)
            labels.put(p[time][1], p[error], p["preset"], color, BELOW, 7, "bold" if p["preset"] == "medium" else "normal")
    plots.name_curves(points, error, time, labels)


def fronts(videos, regimes, time, folder):
    """What presets buy that LMSE of single stills does not show."""
    ours = ("intrinsicdecomp", "globalintrinsic")
    panels = [("Flicker, own videos", [p for p in videos if p["method"] in ours], "flicker", "flicker: standard deviation of ln R over time")]
    for regime, heading in (("MIT objects", "Real objects (MIT)"), ("hard shadow" + summary.MARK, "Hard shadows" + summary.MARK)):
        panels.append((heading, [p for p in regimes.get(regime, []) if p["method"] in ours and p["curve"] == "quality"], "lmse20", plots.LMSE))
    panels = [panel for panel in panels if len(plots.usable(panel[1], panel[2], time)) > 2]
    if not panels:
        return False
    figure, axes = plt.subplots(1, len(panels), squeeze=False, figsize=(4.9 * len(panels), 4.3))
    for ax, (heading, points, error, ylabel) in zip(axes.flat, panels):
        quality_panel(ax, points, error, ylabel, time, "intrinsicdecomp")
        ax.set_title(heading)
    figure.tight_layout()
    plots.save(figure, folder, "fronts")
    return True


def work_precision(rows, device, time, folder):
    """Methods that know of bounced light, on the scenes whose direct and bounced light are known."""
    some = [r for r in rows if r["method"] in (light.THESIS, "globalintrinsic", "intrinsicdecomp", "guessed indirect light")
            and r["curve"] in ("quality", "guess")]
    points = summary.points(some, device=device)
    if not any(p["method"] == light.THESIS for p in points):
        return False
    figure, axes = plt.subplots(1, 2, figsize=(10.5, 4.6))
    for ax, (error, heading) in zip(axes, (("lmse20_R", "Reflectance, in color"), ("ind", "Indirect light"))):
        here = plots.usable(points, error, time)
        plots.finish_axes(ax, *plots.extent(here, error, time), plots.TIME_NAMES[time],
                          plots.LMSE if error == "lmse20_R" else "squared error relative to the truth, own scale")
        labels = Labels(ax)
        curves = [p for p in here if p["curve"] == "quality"]
        for method in dict.fromkeys(p["method"] for p in curves):
            plots.draw_curve(ax, sorted((p for p in curves if p["method"] == method), key=lambda p: p["order"]), error, time, labels)
        for p in here:
            if p["curve"] == "guess":
                ax.plot(p[time][1], p[error], "*", color=plots.FAINT, markersize=9)
                labels.put(p[time][1], p[error], p["setting"], plots.FAINT, size=7.5)
            elif p["preset"]:
                color, _ = plots.style(p["method"])
                ax.plot(p[time][1], p[error], "o", markersize=11, markerfacecolor="none", markeredgecolor=color, markeredgewidth=1.3)
                labels.put(p[time][1], p[error], p["preset"], color, BELOW, 7, "bold" if p["base"] else "normal")
        plots.name_curves(curves, error, time, labels)
        ax.set_title(heading)
    figure.tight_layout()
    plots.save(figure, folder, "light")
    return True


def colors(entries, folder):
    """Memory and time by base colors."""
    entries = light.of_lines(entries)
    if not entries:
        return False
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 3.6))
    styles = {"globalintrinsicthesis": light.THESIS, "globalintrinsic with layers of light": "globalintrinsic"}
    for ax, (field, ylabel) in zip(axes, (("device_bytes_per_pixel", "device bytes a pixel"), ("processor_ms", "processor ms a frame, 320×240"))):
        for name, method in styles.items():
            line = sorted((e["colors"], e[field]) for e in entries if e["name"] == name)
            if line:
                color, marker = plots.style(method)
                ax.plot(*zip(*line), "-", color=color, marker=marker, label=name)
        ax.set_xlabel("base colors looked for (K)")
        ax.set_ylabel(ylabel)
        if field == "device_bytes_per_pixel":
            ax.set_ylim(0)
        else:
            ax.set_yscale("log")
            plots.plain_log(ax.yaxis, 1000)
    axes[0].legend(frameon=False, labelcolor="linecolor", fontsize=8)
    axes[0].set_title("Memory")
    axes[1].set_title("Time")
    figure.tight_layout()
    plots.save(figure, folder, "colors")
    return True


def background(found, folder):
    """Histograms of frame times, one for each kind, above each other."""
    kinds = [(name, times) for name, times in found["times_ms"].items() if times]
    if not kinds:
        return False
    most = max(max(times) for _, times in kinds)
    edges = [most * 1.02 * k / 40 for k in range(41)]
    figure, axes = plt.subplots(len(kinds), 1, sharex=True, figsize=(8, 1.4 * len(kinds) + 0.9))
    names = {"alone": "nothing else under way", "refining": "base colors are refined", "correcting": "a region's color is decided"}
    hues = {"alone": plots.FAINT, "refining": "#0072B2", "correcting": "#E69F00"}
    for ax, (name, times) in zip(axes if len(kinds) > 1 else [axes], kinds):
        ax.hist(times, bins=edges, color=hues[name])
        middle = sorted(times)[len(times) // 2]
        ax.axvline(middle, color=plots.INK, linewidth=1)
        ax.annotate(f"median {middle:.0f} ms", (middle, 1), (4, -4), xycoords=("data", "axes fraction"), textcoords="offset points",
                    fontsize=7.5, va="top")
        ax.annotate(f"{names[name]} ({len(times)} frames)", (0.99, 0.9), xycoords="axes fraction", fontsize=8, va="top", ha="right", color=hues[name],
                    fontweight="bold")
        ax.set_ylabel("frames")
        ax.set_ylim(0, 1.35 * ax.get_ylim()[1])
        ax.yaxis.set_major_locator(plots.ticker.MaxNLocator(3, integer=True))
    figure.axes[-1].set_xlabel(f"milliseconds a frame, {found['width']}×{found['height']}, system memory to system memory")
    figure.axes[0].set_xlim(0, edges[-1])
    figure.axes[0].set_title("Frame times of globalintrinsicthesis while the background is at work")
    figure.tight_layout()
    plots.save(figure, folder, "background")
    return True

# SPDX-License-Identifier: LGPL-2.1-or-later
"""From raw samples to figures: medians with quartiles, means of errors, fronts.

Everything here takes and gives plain dictionaries, as results.json has them.
"""
import math
import random
import statistics

PIXELS = 320 * 240  # times are given for frames of this size
ERRORS = ["lmse20", "lmse10", "mse", "dssim", "ms_ssim", "psnr", "whdr", "ind", "dirJ", "indJ", "tint", "lmse20_R", "lmse20_S"]
# What a method tells of a frame beside its layers: errors of base colors, clicks, how many layers there are.
FIGURES = ["base_before", "base_after", "clicks", "clicks_right", "misclustered", "refining_frames", "layers"]
TIMES = ["wall_ms", "processor_ms", "device_ms"]


def quartiles(samples):
    """[first quartile, median, third quartile, count] of what is not None; None where nothing is left."""
    values = sorted(v for v in samples if v is not None)
    if not values:
        return None
    if len(values) == 1:
        return [values[0]] * 3 + [1]
    low, middle, high = statistics.quantiles(values, n=4, method="inclusive")
    return [low, middle, high, len(values)]


def key_of(row):
    return (row["method"], row["curve"], row["setting"], row["device"], row["set"], row["scene"], row["video"])


def merged(passes):
    """The rows of several passes over the same settings as one: samples together, errors of whoever has them."""
    rows = {}
    for one in passes:
        for row in one["rows"]:
            known = rows.setdefault(key_of(row), row)
            if known is row:
                continue
            for name in TIMES:
                known[name] += row[name]
            for name, values in row["stages_ms"].items():
                known["stages_ms"].setdefault(name, []).extend(values)
            for name in ERRORS + FIGURES + ["to_converged", "flicker", "jitter"]:
                if name in row and name not in known:
                    known[name] = row[name]
    return list(rows.values())


def mean(values):
    values = [v for v in values if v is not None]
    return statistics.fmean(values) if values else None


def condensed(row):
    """A row with samples turned into quartiles and errors into means over frames."""
    out = {k: v for k, v in row.items() if k not in TIMES + ERRORS + FIGURES + ["to_converged", "stages_ms"]}
    for name in TIMES:
        out[name] = quartiles(row[name])
    out["stages_ms"] = {n: quartiles(v)[1] for n, v in row["stages_ms"].items() if quartiles(v)}
    for name in ERRORS + FIGURES + ["to_converged"]:
        if name in row:
            out[name] = mean(row[name])
    return out


def points(rows, video=False, sets=None, regime=None, device=None):
    """One point for each method, curve and setting: means of errors over scenes (each weighs the same), times of all
    scenes together for frames of PIXELS pixels."""
    groups = {}
    for row in rows:
        if row["video"] != video or (sets and row["set"] not in sets) or (regime and row["regime"] != regime):
            continue
        if device and row["device"] not in (device, "processor"):
            continue
        groups.setdefault((row["device"], row["method"], row["curve"], row["setting"]), []).append(row)
    scenes = {}
    for (on, *_), group in groups.items():
        scenes.setdefault(on, set()).update((r["set"], r["scene"]) for r in group)
    out = []
    for (on, method, curve, setting), group in groups.items():
        if len(group) < len(scenes[on]):
            continue  # errors over different scenes cannot be compared
        point = {"device": on, "method": method, "curve": curve, "setting": setting, "order": group[0]["order"],
                 "preset": group[0]["preset"], "base": group[0]["base"], "parameters": group[0]["parameters"],
                 "scenes": len(group)}
        for name in ERRORS + ["to_converged", "flicker", "jitter"]:
            point[name] = mean(r.get(name) for r in group)
        for name in TIMES:
            scaled = [[q * PIXELS / (r["width"] * r["height"]) for q in r[name][:3]] for r in group if r[name]]
            point[name] = [statistics.median(c) for c in zip(*scaled)] if scaled else None
        out.append(point)
    return sorted(out, key=lambda p: (p["method"], p["curve"], p["order"]))


def front(all_points, error, time="wall_ms"):
    """The points that no other beats in both time and error, by time."""
    usable = [p for p in all_points if p[time] and p[error] is not None]
    best, out = math.inf, []
    for p in sorted(usable, key=lambda p: (p[time][1], p[error])):
        if p[error] < best:
            best = p[error]
            out.append(p)
    return out


def steady_time(device):
    """The clock to trust for fine differences: a software device's processor time, which other work hardly disturbs; a
    GPU's own clock."""
    return "processor_ms" if "llvmpipe" in device else "device_ms"


def bootstrap_ratio(ours, theirs, rounds=1000):
    """Median of paired ratios and its 95 % interval [low, median, high]; None where there are no pairs."""
    pairs = [a / b for a, b in zip(ours, theirs) if a is not None and b]
    if not pairs:
        return None
    draw = random.Random(1)
    medians = sorted(statistics.median(draw.choices(pairs, k=len(pairs))) for _ in range(rounds))
    return [medians[int(0.025 * rounds)], statistics.median(pairs), medians[int(0.975 * rounds)]]


def against_off(rows):
    """What leaving out saves through the elements: each setting of a scene and size against "off", by pairs of frames."""
    def place(row):
        return row["element"], row["scene"], row["width"], row["height"]
    off = {place(r): r for r in rows if r["setting"] == "off"}
    out = []
    for row in rows:
        other = off.get(place(row))
        if row["setting"] == "off" or not other:
            continue
        entry = {k: row[k] for k in ("element", "scene", "width", "height", "frames", "setting")}
        entry["pairs"] = min(len(r["wall_ms"]) for r in (other, row))
        for name in ("wall_ms", "processor_ms"):
            entry[name] = [quartiles(r[name])[1] for r in (other, row)]
            entry[name.replace("_ms", "_ratio")] = bootstrap_ratio(row[name], other[name])
        out.append(entry)
    return out

# SPDX-License-Identifier: LGPL-2.1-or-later
"""Compares two results: what got better or worse by more than the noise, one line for each setting and measure."""
import statistics

# Relative changes of time that count. Other work disturbs a software device's clock far more than its processor time.
FLOORS = {"software": {"processor_ms": 0.08, "wall_ms": 0.25}, "gpu": {"device_ms": 0.08, "wall_ms": 0.15}}
ERROR_FLOOR = 0.005   # relative: kernels of one machine give the same bits, those of two nearly so
LEAST_ERROR = 1e-4    # absolute
AGREEMENT = 0.75      # share of scenes whose quartiles of time lie apart, all in the same direction
ERRORS = ["lmse20", "mse", "dssim", "whdr", "to_converged", "flicker", "jitter", "ind", "dirJ", "indJ", "tint"]


def rows_by_key(results):
    return {(r["method"], r["curve"], r["setting"], r["device"], r["set"], r["scene"], r["video"]): r
            for r in results["rows"]}


BUSY = 2.5            # load above which the clock tells more of other work than of ours,
BUSY_FLOOR = 0.6      # and threads of a software device that wait for each other take up to this much more processor time


def disturbance(pairs, families, time):
    """How much slower the machine is now at what no change of ours touches: the median ratio of times of peers; 1 where
    there are few in common."""
    ratios = [b[time][1] / a[time][1] for key, (a, b) in pairs.items()
              if families.get(key[0], {}).get("family") == "peer" and a[time] and b[time]]
    return statistics.median(ratios) if len(ratios) >= 5 else 1.0


def time_change(group, time, floor, machine):
    """Median ratio over scenes, and how many scenes' quartiles lie apart that way; None where it is noise."""
    usable = [(a[time], b[time]) for a, b in group if a[time] and b[time]]
    if not usable:
        return None
    ratio = statistics.median(b[1] / a[1] / machine for a, b in usable)
    apart = [b[0] > a[2] * machine if ratio > 1 else b[2] < a[0] * machine for a, b in usable]
    if abs(ratio - 1) <= floor or sum(apart) < AGREEMENT * len(usable):
        return None
    return ratio, f"{time[:-3]} time × {ratio:.2f} ({len(usable)} scenes)"


def error_change(group, error):
    """Ratio of the means over scenes; None where they are as good as equal."""
    usable = [(a[error], b[error]) for a, b in group if a.get(error) is not None and b.get(error) is not None]
    if not usable:
        return None
    before, after = (statistics.fmean(side) for side in zip(*usable))
    if abs(after - before) <= max(LEAST_ERROR, ERROR_FLOOR * before):
        return None
    ratio = after / before if before > 0 else float("inf")
    return ratio, f"{error} {before:.4f} → {after:.4f} (× {ratio:.3f}, {len(usable)} scenes)"


def compare(before, after):
    """Lines of text, the largest changes first, and a last line that counts."""
    old, new = rows_by_key(before), rows_by_key(after)
    pairs = {key: (old[key], new[key]) for key in old.keys() & new.keys()}
    machine = disturbance(pairs, after["methods"], "processor_ms")
    load = max(r.get("machine", {}).get(f"load_{w}", 0) for r in (before, after) for w in ("before", "after"))
    groups = {}
    for key in sorted(pairs):
        method, curve, setting, device, _, _, video = key
        groups.setdefault((method, curve, setting, device, video), []).append(pairs[key])
    found = []
    for (method, curve, setting, device, video), group in groups.items():
        changes = [error_change(group, e) for e in ERRORS]
        if device != "processor":
            floors = FLOORS["software" if "llvmpipe" in device else "gpu"]
            if load > BUSY:
                floors = {time: max(floor, BUSY_FLOOR if time == "processor_ms" else 0)
                          for time, floor in floors.items() if time != "wall_ms"}
            changes += [time_change(group, time, floor, machine) for time, floor in floors.items()]
        name = f"{method}, {curve} {setting}{', videos' if video else ''} ({device.split(' (')[0]})"
        found += [(ratio, f"  {name}: {text}") for ratio, text in filter(None, changes)]
    worse = [line for ratio, line in sorted(found, reverse=True) if ratio > 1]
    better = [line for ratio, line in sorted(found) if ratio < 1]
    def settings(rows, others):
        known = {key[:3] for key in others}
        return sorted({f"{key[0]}, {key[1]} {key[2]}" for key in rows if key[:3] not in known})

    lines = [f"rows in common: {len(pairs)}; only before: {len(old) - len(pairs)}; only now: {len(new) - len(pairs)}",
             *(f"gone: {name}" for name in settings(old, new)), *(f"new: {name}" for name in settings(new, old)),
             f"the machine takes {machine:.2f} times as long as then (median of the peers); times are corrected for that"]
    if load > BUSY:
        lines.append(f"clocks are not compared, as other work kept the machine busy in one of the runs (load {load:.1f}), "
                     f"and processor time only where it changed by more than {100 * BUSY_FLOOR:.0f} %")
    return lines + ["worse:", *worse, "better:", *better,
                    f"{len(worse)} worse, {len(better)} better; the rest is the same within the noise"]

# SPDX-License-Identifier: LGPL-2.1-or-later
"""How sure differences between methods are: bootstrap intervals over scenes, regime by regime."""
import random
import statistics

OURS = ("intrinsicdecomp", "medium")
THESIS = ("thesis PCG", "medium")
MIN_SCENES = 3  # of fewer an interval says too little to decide


def bootstrap_mean(values, rounds=4000):
    """[2.5 % quantile, mean, 97.5 % quantile] of the mean over values that are drawn again with replacement, always in the
    same way; None of fewer than two."""
    if len(values) < 2:
        return None
    draw = random.Random(1)
    means = sorted(statistics.fmean(draw.choices(values, k=len(values))) for _ in range(rounds))
    return [means[int(0.025 * rounds)], statistics.fmean(values), means[int(0.975 * rounds) - 1]]


def bootstrap_share(counts, rounds=4000):
    """The same of sum over sum of (part, whole) that are drawn again together, one for each picture."""
    counts = list(counts)
    if len(counts) < 2:
        return None
    def share(drawn):
        return sum(part for part, _ in drawn) / sum(whole for _, whole in drawn)
    draw = random.Random(1)
    shares = sorted(share(draw.choices(counts, k=len(counts))) for _ in range(rounds))
    return [shares[int(0.025 * rounds)], share(counts), shares[int(0.975 * rounds) - 1]]


def differences(ours, theirs):
    """Of errors by scene, ours minus theirs where both are known: their mean, its interval, in how many scenes ours is less,
    and whether zero lies outside the interval (None: too few scenes to tell)."""
    pairs = [ours[scene] - theirs[scene] for scene in sorted(ours.keys() & theirs.keys())]
    if not pairs:
        return None
    interval = bootstrap_mean(pairs)
    return {"mean": statistics.fmean(pairs), "interval": interval, "scenes": len(pairs), "better": sum(d < 0 for d in pairs),
            "separated": interval[0] > 0 or interval[2] < 0 if len(pairs) >= MIN_SCENES else None}


def by_scene(rows, error):
    """Errors on stills by (set, scene), for each (method, curve, setting) and, where it is one, each (method, preset)."""
    found = {}
    for row in rows:
        if row["video"] or row.get(error) is None:
            continue
        for key in ((row["method"], row["curve"], row["setting"]), (row["method"], row["preset"])):
            if key[-1] or len(key) == 3:
                found.setdefault(key, {})[row["set"], row["scene"]] = row[error]
    return found


def best_baseline(found, scenes, families):
    """The other people's method or trivial answer, at whichever setting, with the least mean over all of these scenes; who
    minimizes the energy of `intrinsicdecomp` is none. None where there is none."""
    means = {key: statistics.fmean(values.values()) for key, values in found.items()
             if len(key) == 3 and families[key[0]]["family"] in ("peer", "trivial") and key[1] != "tolerance" and
             values.keys() == scenes}
    return min(means, key=means.get) if means else None


def by_regime(rows, families, error="lmse20"):
    """For each regime: `intrinsicdecomp` at its default, and what is left of it minus the thesis' method at its own and
    minus the best baseline."""
    out = {}
    for regime in dict.fromkeys(r["regime"] for r in rows if not r["video"]):
        found = by_scene([r for r in rows if r["regime"] == regime], error)
        ours = found.get(OURS)
        if not ours:
            continue
        entry = {"scenes": len(ours), "mean": statistics.fmean(ours.values()),
                 "interval": bootstrap_mean([ours[s] for s in sorted(ours)]),
                 "minus_thesis": differences(ours, found.get(THESIS, {}))}
        best = best_baseline(found, ours.keys(), families)
        if best:
            entry["baseline"] = {"method": best[0], "setting": best[2], "mean": statistics.fmean(found[best].values())}
            entry["minus_baseline"] = differences(ours, found[best])
        out[regime] = entry
    return out

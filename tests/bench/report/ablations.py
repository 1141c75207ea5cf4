# SPDX-License-Identifier: LGPL-2.1-or-later
"""What each term is worth: errors and times with one left out, and of weights that are chosen without a scene."""
import statistics

from summary import mean

OURS = "intrinsicdecomp"
CHOSEN = "b v g"  # of the curve "weights": as it ships


def ratio_of_times(rows, others, clock):
    """Median over scenes of rows' times over others' (both by scene); None where there are none."""
    pairs = [rows[s][clock][1] / others[s][clock][1] for s in rows.keys() & others.keys()
             if rows[s][clock] and others[s][clock]]
    return statistics.median(pairs) if pairs else None


def by_scene(rows):
    return {(r["set"], r["scene"]): r for r in rows}


def stills(rows, method, clock):
    """For each term left out of `method`, whole method first: {"term", "errors": {regime: LMSE}, "time": ratio to the whole}."""
    rows = [r for r in rows if r["method"] == method and not r["video"]]
    whole = by_scene(r for r in rows if r["base"])
    out = [{"term": "", "rows": whole}]
    for term in dict.fromkeys(r["setting"] for r in rows if r["curve"] == "without"):
        out.append({"term": term, "rows": by_scene(r for r in rows if r["curve"] == "without" and r["setting"] == term)})
    if len(out) == 1 or not whole:
        return []
    common = set.intersection(*(set(e["rows"]) for e in out))
    regimes = dict.fromkeys(whole[s]["regime"] for s in whole if s in common)
    return [{"term": e["term"], "time": ratio_of_times(e["rows"], whole, clock),
             "errors": {n: mean(r["lmse20"] for s, r in e["rows"].items() if s in common and r["regime"] == n) for n in regimes},
             "scenes": {n: sum(whole[s]["regime"] == n for s in common) for n in regimes}} for e in out]


def leave_one_out(rows):
    """Every scene with the weights that are best on all others, regimes weighing the same: {regime: (as it ships, so chosen,
    best for that regime itself)} and how often which weights were chosen; None without the curve."""
    rows = [r for r in rows if r["method"] == OURS and r["curve"] == "weights" and not r["video"]]
    settings = {name: by_scene(r for r in rows if r["setting"] == name) for name in dict.fromkeys(r["setting"] for r in rows)}
    if CHOSEN not in settings:
        return None
    scenes = set.intersection(*(set(of) for of in settings.values()))
    regime = {s: settings[CHOSEN][s]["regime"] for s in scenes}

    def error(name, some):
        groups = {}
        for s in some:
            groups.setdefault(regime[s], []).append(settings[name][s]["lmse20"])
        return mean(mean(g) for g in groups.values())

    chosen = {s: min(settings, key=lambda n: (error(n, scenes - {s}), n != CHOSEN)) for s in scenes} if len(scenes) > 1 else {}
    if not chosen:
        return None
    picks = {}
    for name in chosen.values():
        picks[name] = picks.get(name, 0) + 1
    found = {}
    for name in sorted(set(regime.values())):
        here = [s for s in scenes if regime[s] == name]
        found[name] = {"scenes": len(here), "ships": error(CHOSEN, here),
                       "left_out": mean(settings[chosen[s]][s]["lmse20"] for s in here),
                       "best": min(error(n, here) for n in settings)}
    return {"regimes": found, "picks": picks, "settings": len(settings)}

#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The tables of docs/reference/accuracy.md and docs/notes/accuracy.md from a results.json of `./dev bench --full`.

    tests/bench/report/accuracy.py out/report/results.json [--page docs/reference/accuracy.md] [--page docs/notes/accuracy.md]

prints them; --page also writes each between the page's lines <!-- NAME --> and <!-- end -->, if it has them.
"""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import ablations
import intervals
import summary
import tables
import whdr
from tables import figure

REGIMES = ["own stills", "MIT objects", "diverse value", "near-constant value", "hard shadow"]
BASELINES = [("constant shading", "constant shading", ""), ("R = I / max_c I", "R = I / max_c I", ""),
             ("gray Retinex .1", "gray Retinex", "t .1"), ("color Retinex .5 .1", "color Retinex", "t .5, c .1"),
             ("thesis, chapter 3", "thesis PCG", None)]


WIDTHS = ["small", "medium", "large"]  # of networks of the prior, those that were there


def grouped(rows):
    """Rows with the project's own scenes as one regime."""
    return [{**r, "regime": "own stills"} if r["set"] == "own" else r for r in rows]


THESIS = [("thesis, chapter 3", None, None), ("Eq. 3.19 as printed", "IRLS weight", "printed"),
          ("without samples", "without", "samples"), ("as printed, without samples", "IRLS weight", "printed, without samples")]
CHAPTERS = [("thesis, chapter 3", "thesis PCG", None, None), ("thesis, chapter 5", "globalintrinsicthesis", None, None),
            ("chapter 5, base colors not refined", "globalintrinsicthesis", "without", "refinement")]


def by_scene(rows, method, setting=None, curve=None):
    """Rows of a method's setting, or of its default."""
    return {(r["set"], r["scene"]): r for r in rows if r["method"] == method and
            (r["base"] if setting is None else r["setting"] == setting and (r["curve"] == curve if curve else r["curve"] != "without"))}


def settings(rows):
    """(title, {scene: row}) of everything that the tables compare."""
    for title, method, setting in BASELINES:
        yield title, by_scene(rows, method, setting)
    yield "intrinsicdecomp", by_scene(rows, "intrinsicdecomp")
    for width in WIDTHS:
        if found := by_scene(rows, "intrinsicdecomp", width, "prior"):
            yield f"with a network, {width}", found


def stills(found):
    """Errors by regime of what is compared: pairs of a title and {scene: row}."""
    means = {n: {t: [summary.mean(r[k] for r in of.values() if r["regime"] == n) for k in ("lmse20", "mse", "dssim")]
                 for t, of in found} for n in REGIMES}
    least = {n: [min(m[k] for m in means[n].values()) for k in range(3)] for n in REGIMES}
    out = []
    for title, of in found:
        cells = [title]
        for n in REGIMES:
            values = [f"**{figure(v, d)}**" if v == b else figure(v, d)
                      for v, b, d in zip(means[n][title], least[n], (4, 3, 3))]
            interval = intervals.bootstrap_mean([r["lmse20"] for r in of.values() if r["regime"] == n])
            cells.append(f"{values[0]} [{figure(interval[0], 3)} {figure(interval[2], 3)}] / {values[1]} / {values[2]}")
        out.append(cells)
    return tables.table(["LMSE [95 %] / si-MSE / DSSIM"] + REGIMES, out)


def difference(a, b, regime):
    d = intervals.differences(*({s: r["lmse20"] for s, r in of.items() if r["regime"] == regime} for of in (a, b)))
    return tables.bracketed(d["mean"], d["interval"], "+")


def paired(found):
    ours = dict(found)["intrinsicdecomp"]
    return tables.table(["intrinsicdecomp minus"] + REGIMES,
                        [[title] + [difference(ours, of, n) for n in REGIMES] for title, of in found if of is not ours])


def thesis(rows):
    """Variants of the thesis' method, what each of its terms brings, and its two methods side by side."""
    found = [(title, by_scene(rows, "thesis PCG", setting, curve)) for title, curve, setting in THESIS]
    whole = found[0][1]
    minus = tables.table(["minus the thesis"] + REGIMES, [[title] + [difference(of, whole, n) for n in REGIMES] for title, of in found[1:]])
    terms = tables.without([{**e, "time": None} for e in ablations.stills(rows, "thesis PCG", "wall_ms")])
    return (f"{stills(found)}\nLMSE minus that of the thesis, paired by scene [95 % interval]; negative is better:\n\n{minus}\n"
            f"One term removed:\n\n{terms}\n{chapters(rows)}")


def chapters(rows):
    """LMSE of reflectance and of colored shading where the truth has the color of light: wrong colors count."""
    found = [(title, by_scene(rows, method, setting, curve)) for title, method, curve, setting in CHAPTERS]
    scenes = [s for s, r in found[1][1].items()]
    names = [n for n in REGIMES if any(found[1][1][s]["regime"] == n for s in scenes)]

    def cell(of, regime):
        some = [of[s] for s in scenes if of[s]["regime"] == regime]
        return " / ".join(figure(summary.mean(r[k] for r in some)) for k in ("lmse20_R", "lmse20_S"))

    return tables.table(["LMSE (k = 20), reflectance / colored shading"] + names, [[title] + [cell(of, n) for n in names] for title, of in found])


VIDEOS = [("thesis", "thesis PCG", "video", "4x8"), ("without anchor", "intrinsicdecomp", "without", "temporal anchor"),
          ("intrinsicdecomp", "intrinsicdecomp", "video quality", "2, 0.05"),
          *((f"with a network, {width}", "intrinsicdecomp", "prior", width) for width in WIDTHS)]


def sequences(rows):
    """LMSE of the sequences, and flicker and jitter of those with constant true reflectance."""
    rows = {(r["set"], r["scene"], r["method"], r["curve"], r["setting"]): r for r in rows if r["video"]}
    scenes = sorted(dict.fromkeys(k[:2] for k in rows), key=lambda s: s[0] != "own")

    def name(s):
        light = (s[0], "slow light") in scenes  # made of sequences where nothing but the light changes
        return ", ".join([s[0], s[1] if s[1] != "video" else "moving light" if light else "things move"])

    def cell(row):
        return ", ".join(figure(row[k]) for k in ("lmse20", "flicker", "jitter") if row.get(k) is not None)

    measured = [v for v in VIDEOS if any(k[2:] == tuple(v[1:]) for k in rows)]
    return tables.table(["sequence", "thesis: LMSE, flicker, jitter"] + [v[0] for v in measured[1:]],
                        [[name(s)] + [cell(rows[(*s, *key)]) for _, *key in measured] for s in scenes])


def main(path, *more):
    pages, _ = tables.pages_of(more)
    results = json.loads(pathlib.Path(path).read_text())
    rows = grouped(results["rows"])
    single = [r for r in rows if not r["video"]]
    if not any(r["curve"] == "weights" for r in single):
        sys.exit(f"{path} is not of a --full run with given data")
    alone, commit, found = ablations.leave_one_out(single), results["machine"]["commit"], list(settings(single))
    parts = {"stills": f"Measured at commit {commit}.\n\n{stills(found)}",
             "paired": f"Measured at commit {commit}.\n\n{paired(found)}",
             "thesis": f"Measured at commit {commit}.\n\n{thesis(single)}",
             "terms": tables.without(ablations.stills(single, "intrinsicdecomp", summary.steady_time(results["device"]))) +
             "\nThree weights chosen for each scene on all other scenes (27 settings):\n\n" + tables.left_out(alone),
             "sequences": sequences(rows)}
    if results.get("photographs"):
        parts = {**whdr.parts(results["photographs"], commit), **parts}
    print("\n".join(parts.values()))
    tables.insert(pages, parts)


if __name__ == "__main__":
    main(*sys.argv[1:])

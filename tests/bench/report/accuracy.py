#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Prints the tables of docs/reference/accuracy.md from a results.json of `./dev bench --full`.

    tests/bench/report/accuracy.py out/report/results.json
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

GIVEN = "diverse value, given"
REGIMES = ["own stills", "MIT objects", GIVEN, "near-constant value", "hard shadow"]
BASELINES = [("constant shading", "constant shading", ""), ("constant reflectance", "constant reflectance", ""),
             ("R = I / max_c I", "R = I / max_c I", ""), ("gray Retinex .1", "gray Retinex", "t .1"),
             ("color Retinex .5 .1", "color Retinex", "t .5, c .1"), ("color Retinex, chroma", "color Retinex", "c .1")]


def grouped(rows):
    """Rows with the project's own scenes as one regime."""
    names = {"diverse value": GIVEN}
    return [{**r, "regime": "own stills" if r["set"] == "own" else names.get(r["regime"], r["regime"])} for r in rows]


def by_scene(rows, method, setting=None):
    """Rows of a method's setting, or of its default."""
    return {(r["set"], r["scene"]): r for r in rows if r["method"] == method and
            (r["base"] if setting is None else r["setting"] == setting and r["curve"] != "without")}


def settings(rows):
    """(title, {scene: row}) of everything that the tables compare."""
    for title, method, setting in BASELINES:
        yield title, by_scene(rows, method, setting)
    yield "thesis (chapter 3)", by_scene(rows, "thesis PCG")
    for term in dict.fromkeys(r["setting"] for r in rows if r["method"] == "thesis PCG" and r["curve"] == "without"):
        yield f"… without {term}", {(r["set"], r["scene"]): r for r in rows if r["method"] == "thesis PCG" and
                                    r["curve"] == "without" and r["setting"] == term}
    yield "intrinsicdecomp", by_scene(rows, "intrinsicdecomp")


def stills(rows):
    found = list(settings(rows))
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


def paired(rows):
    ours = by_scene(rows, "intrinsicdecomp")
    out = []
    for title, of in settings(rows):
        if title == "intrinsicdecomp":
            continue
        cells = [title.replace("… ", "thesis ").replace(" (chapter 3)", "")]
        for n in REGIMES:
            d = intervals.differences({s: r["lmse20"] for s, r in ours.items() if r["regime"] == n},
                                      {s: r["lmse20"] for s, r in of.items() if r["regime"] == n})
            cells.append(tables.bracketed(d["mean"], d["interval"], "+"))
        out.append(cells)
    return tables.table(["intrinsicdecomp minus"] + REGIMES, out)


VIDEOS = [("input", "constant shading", "only", ""), ("thesis, no keyframes", "thesis PCG", "keyframes", "none"),
          ("thesis", "thesis PCG", "video", "4x8"), ("intrinsicdecomp, anchor off", "intrinsicdecomp", "without", "temporal anchor"),
          ("intrinsicdecomp", "intrinsicdecomp", "video quality", "2, 0.05")]


def sequences(rows):
    """Sequences with constant true reflectance: LMSE, flicker and jitter; of the others LMSE."""
    rows = {(r["set"], r["scene"], r["method"], r["curve"], r["setting"]): r for r in rows if r["video"]}
    scenes = dict.fromkeys(k[:2] for k in rows)
    still = [s for s in scenes if rows[(*s, *VIDEOS[-1][1:])].get("flicker") is not None]
    def name(s):
        light = (s[0], "slow light") in scenes  # made of sequences where nothing but the light changes
        if s[0] == "own":
            return s[1]
        return f"{s[0]}, " + (s[1] if s[1] != "video" else "moving light" if light else "things move")
    out = [[name(s), title, "" if title == "input" else figure(r["lmse20"]),
            figure(r["flicker"]), figure(r["jitter"])]
           for s in still for title, *key in VIDEOS for r in [rows[(*s, *key)]]]
    text = tables.table(["sequence", "", "LMSE", "flicker", "jitter"], out)
    moving = [s for s in scenes if s not in still]
    lines = [[title] + [figure(rows[(*s, *key)]["lmse20"]) for s in moving] for title, *key in VIDEOS[1:]]
    return text + "\nThe camera moves, LMSE:\n\n" + tables.table([""] + [s[1] if s[0] == "own" else s[0] for s in moving], lines)


def main():
    results = json.loads(pathlib.Path(sys.argv[1]).read_text())
    rows = grouped(results["rows"])
    single = [r for r in rows if not r["video"]]
    if not any(r["curve"] == "weights" for r in single):
        sys.exit(f"{sys.argv[1]} is not of a --full run with given data")
    if results.get("photographs"):
        print(whdr.table(results["photographs"]))
    print(stills(single))
    print(paired(single))
    print(tables.without(ablations.stills(single, "intrinsicdecomp", summary.steady_time(results["device"]))))
    alone = ablations.leave_one_out(single)
    print(tables.left_out(alone), alone["picks"], sep="\n", end="\n\n")
    print(sequences(sorted(rows, key=lambda r: r["set"] != "own")))


main()

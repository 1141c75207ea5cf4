# SPDX-License-Identifier: LGPL-2.1-or-later
"""The table "Measured" of docs/reference/methods/globalintrinsic.md, from what bench-methods and bench-peers wrote:
layers.py FILE.json …   Videos: means over the frames that were judged; the MIT set: means over its objects, each a still."""
import json
import math
import pathlib
import sys

import summary
import tables

FIELDS = [("lmse20_R", "R"), ("lmse20_S", "S"), ("lmse20_dir", "direct"), ("ind", "ind"), ("dirJ", "dirJ"), ("indJ", "indJ"), ("tint", "tint")]
SCENES = ["cornell", "room", "courtyard", "desk_rgbd", "lightchange", "room_values", "lightchange_values"]
METHODS = {"intrinsicdecomp": "intrinsicdecomp", "guessed indirect light, constant gray": "intrinsicdecomp, constant gray",
           "guessed indirect light, blurred frame": "intrinsicdecomp, blurred image", "globalintrinsic": "globalintrinsic", "thesis PCG": "thesis",
           "R = I / max_c I": "R = I / max_c I"}


def title(row):
    if row["method"] == "guessed indirect light":
        return f"{row['method']}, {row['setting']}"
    chosen = row["method"] == "R = I / max_c I" or row["preset"] == "medium" or \
        (row["method"] == "thesis PCG" and row["setting"] == "4x8")
    return row["method"] if chosen else ""


def main(paths):
    found, without = {}, {}
    for path in paths:
        for row in json.loads(pathlib.Path(path).read_text())["rows"]:
            scene, row = row["set"], summary.condensed(row)
            if (row["video"] and row["scene"] != "video") or row["video"] == (scene == "mit"):
                continue
            if row["curve"] in ("without", "adaptive") and row["method"] != "thesis PCG":
                if row["method"] == "globalintrinsic":
                    without.setdefault(row["setting"], {})[scene] = row
                continue
            if title(row) in METHODS:
                found.setdefault((scene, title(row)), []).append(row)
    out, last = [], None
    for scene in SCENES + ["mit"]:
        least = {f: min((summary.mean(r.get(f) for r in rows) for (s, _), rows in found.items()
                         if s == scene and rows[0].get(f) is not None), default=None) for f, _ in FIELDS}
        for method, name in METHODS.items():
            rows = found.get((scene, method))
            if rows and not (scene != "mit" and method == "intrinsicdecomp"):  # as with constant gray
                values = {f: summary.mean(r.get(f) for r in rows) for f, _ in FIELDS}
                out.append([scene if scene != last else "", name] + [f"**{tables.figure(v)}**" if v is not None and v == least[f] else tables.figure(v)
                                            for f, v in values.items()])
                last = scene
    print(tables.table(["", ""] + [n for _, n in FIELDS], out))
    def means(per_scene):
        return [tables.figure(math.exp(summary.mean(math.log(per_scene[s][f]) for s in SCENES))) if all(
            s in per_scene and per_scene[s].get(f) for s in SCENES) else "–" for f, _ in FIELDS]
    rows = [[name] + means({s: found[s, m][0] for s in SCENES if (s, m) in found}) for m, name in METHODS.items()
            if m != "intrinsicdecomp"]
    rows += [[f"globalintrinsic without {part}"] + means(of) for part, of in without.items()]
    print(tables.table(["geometric mean of the seven"] + [n for _, n in FIELDS], rows))


main(sys.argv[1:])

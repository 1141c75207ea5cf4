#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Paint or light, on photographs that nobody rendered: one table of baselines, the thesis and elements.

    ./dev shell -c 'python3 tests/bench/real [--data ../shared/data] [ELEMENTS …]'

Each row is a baseline or elements of a launch line. Needs python3-gi, python3-opencv, python3-numpy and python3-scipy.
"""
import argparse
import json
import pathlib
import sys

import added
import measures
import numpy as np
from methods import BASELINES, methods

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "report"))  # before PyTables, which has a module of that name
import tables

ELEMENTS = ("intrinsicdecompthesis", "globalintrinsicthesis", "intrinsicdecomp", "globalintrinsic")
HEAD = ("", "light / paint added", "confusion", "lamps / paint", "confusion", "change / contrast", "index", "WHDR δ .10 / best", "AUC", "chroma")


def shown(value):
    return f"{value:.3f}".replace("0.", ".", 1)


def best(pairs):
    return min(measures.whdr(pairs, delta) for delta in measures.DELTAS)


def measured(method, data, photographs, lamps):
    """All measures of a method, by name."""
    found = {}
    for name, cases in (("added", added.on_photographs(data / "real_pairs_2", photographs)), ("lamps", added.with_depth(data / "rgbd/measure", lamps))):
        shares = measures.shares(method, cases)
        found[name] = {"light": np.mean(shares["light"]), "paint": np.mean(shares["paint"]), "confusion": measures.confusion(shares),
                       "cases": [len(shares[kind]) for kind in ("light", "paint")]}
    series = {folder.name: measures.constancy(method, folder) for folder in sorted((data / "series").iterdir())}
    found["series"] = {name: {"change": change, "contrast": contrast, "index": change / contrast} for name, (change, contrast) in series.items()}
    pairs, chroma = measures.ratios(method, data / "real_pairs_2")
    found["pairs"] = {"at": measures.whdr(pairs, measures.DELTA), "best": best(pairs), "auc": measures.area_under_curve(pairs), "chroma": chroma}
    return found


def row(name, found):
    mean = {key: np.mean([s[key] for s in found["series"].values()]) for key in ("change", "contrast", "index")}
    cells = [name]
    for of in (found["added"], found["lamps"]):
        cells += [f"{shown(of['light'])} / {shown(of['paint'])}", shown(of["confusion"])]
    cells += [f"{shown(mean['change'])} / {shown(mean['contrast'])}", shown(mean["index"])]
    pairs = found["pairs"]
    return [*cells, f"{shown(pairs['at'])} / {shown(pairs['best'])}", shown(pairs["auc"]), shown(pairs["chroma"])]


def main():
    parser = argparse.ArgumentParser(prog="tests/bench/real", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("elements", nargs="*", default=ELEMENTS, help="elements of a launch line; by default %(default)s")
    parser.add_argument("--data", type=pathlib.Path, default=pathlib.Path("../shared/data"), help="real_pairs_2, rgbd/measure and series (default %(default)s)")
    parser.add_argument("--photographs", type=int, default=58, help="that light and paint are added to (default %(default)s)")
    parser.add_argument("--lamps", type=int, default=2, help="on each picture with depth (default %(default)s)")
    parser.add_argument("--no-baselines", action="store_true", help="measure the elements only")
    parser.add_argument("--page", type=pathlib.Path, help="also write the table between the page's lines <!-- real --> and <!-- end -->")
    parser.add_argument("--json", type=pathlib.Path, help="also write all figures to a file")
    args = parser.parse_args()
    print(tables.table(HEAD, []), end="", flush=True)
    results, rows = {}, []
    for name, method in methods(args.elements).items():
        if name in BASELINES and args.no_baselines:
            continue
        results[name] = measured(method, args.data, args.photographs, args.lamps)
        rows.append(row(name, results[name]))
        print(tables.table(HEAD, rows).splitlines()[-1], flush=True)
        if args.json:
            args.json.write_text(json.dumps(results, indent=1, default=float))
    if args.page:
        args.page.write_text(tables.inserted(args.page.read_text(), "real", tables.table(HEAD, rows)))


if __name__ == "__main__":
    main()

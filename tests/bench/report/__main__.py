# SPDX-License-Identifier: LGPL-2.1-or-later
"""Measures every method and writes a report: ./dev bench [--full] [--data DIR] [--publish] …"""
import argparse
import json
import pathlib
import sys

import brief
import intervals
import measure
import progress as progress_bar
import summary


def options():
    parser = argparse.ArgumentParser(prog="./dev bench", description="error against run time of every method")
    parser.add_argument("build", type=pathlib.Path, help=argparse.SUPPRESS)
    parser.add_argument("--full", action="store_true",
                        help="two frames and the video of every given sequence, every setting, every size: some thirty minutes")
    parser.add_argument("--resume", action="store_true", help="go on where an interrupted run with the same options stopped")
    parser.add_argument("--data", type=pathlib.Path, default=pathlib.Path("../shared/data"), metavar="DIR",
                        help="ground truth (default ../shared/data): MIT-like objects and rendered sequences in it")
    parser.add_argument("--only", action="append", default=[], metavar="METHOD", help="measure these methods only")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/report"), metavar="DIR",
                        help="where the report goes (default out/report, which git ignores)")
    parser.add_argument("--publish", action="store_true", help="also write the committed report, docs/report")
    parser.add_argument("--plots-only", action="store_true", help="draw again from the report's results.json")
    given = parser.parse_args()
    if given.publish and not (given.full or given.plots_only):
        parser.error("--publish needs a --full run")
    return given


def summarize(results):
    rows = results["rows"]
    own = summary.points(rows, sets={"own"}, device=results["device"])
    names = dict.fromkeys(r["regime"] for r in rows if not r["video"])
    videos = summary.points([r for r in rows if r["curve"] == "video quality"], video=True, sets={"own"})
    results["summary"] = {
        "own": own,
        "regimes": {n: summary.points(rows, regime=n, device=results["device"]) for n in names},
        "intervals": intervals.by_regime(rows, results["methods"]),
        "videos": videos}


def picture(folder, work):
    """The layers that methods make of one own still, side by side, where they were kept."""
    scene = work / "scenes-own" / "own-still_life.f32"
    columns = [("truth", None)]
    for title, name in [("intrinsicdecomp", "intrinsicdecomp-quality-4"), ("thesis", "thesis_PCG-iterations-4x8"),
                        ("color Retinex", "color_Retinex-thresholds-t_.5,_c_.1"),
                        ("R = I / max_c I", "R_=_I___max_c_I-only-")]:
        dump = work / "layers" / f"own-still_life-{name}.f32"
        if dump.exists():
            columns.append((title, dump))
    if not scene.exists() or len(columns) == 1:
        return False
    import picture as pictures
    pictures.layers(scene, columns, folder, "layers")
    return True


def main():
    given = options()
    work = pathlib.Path("out/bench")
    work.mkdir(parents=True, exist_ok=True)
    given.out.mkdir(parents=True, exist_ok=True)
    path = given.out / "results.json"
    bar = progress_bar.Progress(*measure.expected(given.full))
    if given.plots_only:
        results = json.loads(path.read_text())
    else:
        try:
            results = measure.run(given.build, work, given.data, given.full, bar, given.only, given.resume)
        except measure.Failed as failure:
            sys.exit(f"\n{failure}")
        except KeyboardInterrupt:
            sys.exit("\ninterrupted; with --resume the same command goes on from here")
    bar.begin("plots and page")
    summarize(results)
    measure.write(results, path)
    picture(given.out, work)
    for folder in [given.out] + [pathlib.Path("docs/report")] * given.publish:
        brief.publish(results, folder, given.out / "layers.jpg")
    bar.end()
    print(f"{given.out}/README.md")
    if not given.data.is_dir() and not given.plots_only:
        print(results["data"])


main()

# SPDX-License-Identifier: LGPL-2.1-or-later
"""Measures every method and writes a report: ./dev bench [--full] [--data DIR] [--publish] [--against FILE] …"""
import argparse
import json
import multiprocessing
import pathlib
import sys

import ablations
import against
import brief
import intervals
import light
import measure
import page
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
    parser.add_argument("--against", type=pathlib.Path, metavar="FILE",
                        help="an earlier results.json: print what got better or worse")
    parser.add_argument("--add", type=pathlib.Path, action="append", default=[], metavar="FILE",
                        help="what bench-methods wrote on another machine, for a column of its own; or an earlier results.json, "
                        "from which tables are kept that this run does not make (those of --full)")
    parser.add_argument("--only", action="append", default=[], metavar="METHOD", help="measure these methods only")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/report"), metavar="DIR",
                        help="where the report goes (default out/report, which git ignores)")
    parser.add_argument("--publish", action="store_true", help="also write the short page that is committed, docs/report")
    parser.add_argument("--plots-only", action="store_true", help="draw again from the report's results.json")
    given = parser.parse_args()
    if given.publish and not (given.full or given.plots_only):
        parser.error("--publish needs a --full run")
    return given


def summarize(results):
    rows = results["rows"] = summary.marked(results["rows"])
    own = summary.points(rows, sets={"own"}, device=results["device"])
    names = sorted(dict.fromkeys(r["regime"] for r in rows if not r["video"]), key=lambda n: n.endswith(summary.MARK))
    videos = summary.points([r for r in rows if r["curve"] == "video quality"], video=True, sets={"own"})
    clock = summary.steady_time(results["device"])
    curve = [p for p in own if p["method"] == "intrinsicdecomp" and p["curve"] == "cycles"]
    results["summary"] = {
        "own": own,
        "regimes": {n: summary.points(rows, regime=n, device=results["device"]) for n in names},
        "intervals": intervals.by_regime(rows, results["methods"]),
        "front": [[p["method"], p["curve"], p["setting"]] for p in summary.front(own, "lmse20")],
        "videos": videos,
        "knee": [p["setting"] for p in summary.knee(curve, "lmse20", clock)]}


def add(results, paths):
    """Files from other machines become columns; of earlier reports is kept what this one lacks."""
    results["others"], results["kept"] = [], None
    for path in paths:
        given = json.loads(path.read_text())
        if "summary" not in given:
            rows = [summary.condensed(r) for r in given["rows"]]
            points = summary.points(rows, sets={"own"}, device=given["device"])
            results["others"].append({"device": given["device"], "points": points})
            continue
        results["others"] += given.get("others", [])
        if not given["full"]:
            results["kept"] = given.get("kept")  # what it had kept itself
            continue
        sizes = {(e["element"], e["width"], e["height"]) for e in results["elements"]}
        results["kept"] = {"commit": given["machine"]["commit"], "device": given["device"],
                           "rows": [r for r in given["rows"] if ablations.wanted(r) or light.wanted(r)],
                           "by_colors": given.get("by_colors"), "background": given.get("background"),
                           "through_elements": given.get("through_elements"),
                           "elements": [e for e in given["elements"] if (e["element"], e["width"], e["height"]) not in sizes]}


def draw(results, folder, work):
    """Draws what there is to draw, on all cores; returns what was drawn, by name."""
    import plots  # after measuring, as it takes a second
    import plots_light
    import tables
    own, clock, kept = results["summary"]["own"], summary.steady_time(results["device"]), results.get("kept") or {}
    left_out = results["adaptivity"] + [{**e, "setting": f"adaptive={e['setting']}"} for e in results.get("through_elements") or []]
    held = results.get("background") or kept.get("background")
    jobs = {"work_precision": lambda: plots.work_precision(own, folder, f"What a millisecond buys on {results['device'].split(' (')[0]}"),
            "convergence": lambda: plots.convergence(own, folder),
            "adaptivity": lambda: plots.adaptivity(left_out, clock, folder),
            "regimes": lambda: plots.regimes(results["summary"]["regimes"], folder),
            "fronts": lambda: plots_light.fronts(results["summary"]["videos"], results["summary"]["regimes"], clock, folder),
            "light": lambda: plots_light.work_precision(light.chosen(results)[0], results["device"], clock, folder),
            "colors": lambda: plots_light.colors(results.get("by_colors") or kept.get("by_colors") or [], folder),
            "background": lambda: bool(held) and plots_light.background(held, folder),
            "knobs": lambda: plots.knobs(own, clock, folder),
            "other_clocks": lambda: plots.other_clocks(own, folder),
            "sizes": lambda: plots.sizes(tables.all_elements(results), folder),
            "conditions": lambda: bool(results["extremes"]) and plots.conditions(results["extremes"]["cases"], folder),
            "picture": lambda: picture(folder, work)}
    waiting.update(jobs)
    with multiprocessing.get_context("fork").Pool() as pool:  # which inherits what is waiting
        has = dict(zip(jobs, pool.map(job, jobs, chunksize=1)))
    has["picture"] = has["picture"] or (folder / "layers.jpg").exists()
    return has


waiting = {}  # what the pool is to draw, by name


def job(name):
    return bool(waiting[name]())


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
    before = json.loads(given.against.read_text()) if given.against else None
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
    if given.add or not given.plots_only:
        add(results, given.add)
    measure.write(results, path)
    page.write(results, given.out, draw(results, given.out, work))
    if given.publish:
        brief.publish(results, pathlib.Path("docs/report"), given.out / "layers.jpg")
    bar.end()
    print(f"{given.out}/README.md")
    if not given.data.is_dir() and not given.plots_only:
        print(results["data"])
    if before:
        print("\n".join(against.compare(before, results)))


main()

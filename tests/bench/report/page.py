# SPDX-License-Identifier: LGPL-2.1-or-later
"""The full report, out/report/README.md: every table of a run. The short page that is committed is brief.py's."""
import ablations
import light
import summary
from tables import (adaptivity, all_elements, by_device, by_parts, by_regime, by_regime_intervals, elements, everybody, exchange, extremes, folded, headline,
                    quality_by_regime, layers_beyond_two, left_out, left_out_where, other_measures, parts_of_elements, through_elements, videos, without, without_on_videos)


def terms(results):
    """The section on what each term contributes; empty if no term was removed."""
    kept = results.get("kept")
    rows = kept["rows"] if kept else results["rows"]
    clock = summary.steady_time(results["device"])
    out = ["## What each term contributes\n"]
    ours = ablations.stills(rows, "intrinsicdecomp", clock)
    if not ours:
        return ""
    if kept:
        out.append(f"From an earlier `--full` run (commit {kept['commit']}), which has more frames.\n")
    out.append("One term of `intrinsicdecomp` removed, everything else as shipped; in brackets the number of scenes, and the change "
               "of the error. The prior was fitted with all terms in place: a small loss means that others replace the term, "
               "and a gain in one regime costs another. *Paint* and *light on edges* are the two halves of the edge prior, "
               "each at a thousandth of its weight; *value* pins the largest channel, *chroma* joins equal colors.\n\n" + without(ours))
    video = ablations.videos(rows, clock)
    if video:
        out.append("\nTerms that only videos have:\n\n" + without_on_videos(video))
    thesis = ablations.stills(rows, "thesis PCG", clock)
    if thesis:
        out.append("\nThe same of the thesis' method:\n\n" + without(thesis))
    alone = ablations.leave_one_out(rows)
    if alone:
        picks = ", ".join(f"`{n.replace(' ', ' ')}` {c} times" for n, c in sorted(alone["picks"].items(), key=lambda i: -i[1]))
        out.append(f"\n### Weights chosen without the scene\n\nThe weights that are set by hand (b of light, v of value, g of chroma), half, "
                   f"once and twice each: {alone['settings']} settings. Every scene is scored with the one that is best on all others, regimes "
                   f"weighing the same; if that is worse than what ships, tuning them says little about new scenes.\n\n" + left_out(alone) +
                   f"\nChosen: {picks} (`b v g`: as it ships).\n")
    return "\n".join(out)


def failures(results):
    if not results.get("failures"):
        return ""
    lines = [f"- {f['part'] if 'part' in f else f['method'] + ' ' + f['curve'] + ' ' + f['setting'] + ', ' + f['set'] + ' ' + f['scene']}: "
             f"{f['why'].strip().splitlines()[-1]}" for f in results["failures"]]
    return "## What failed\n\nEverything else was measured:\n\n" + "\n".join(lines) + "\n"


def why_medium(stills, videos, has, regimes):
    """What the default buys beside the preset below it, in figures of this run."""
    def preset(points, curve, name):
        return next((p for p in points if p["method"] == "intrinsicdecomp" and p["curve"] == curve and p["preset"] == name), None)
    low, medium = preset(stills, "quality", "low"), preset(stills, "quality", "medium")
    low_video, medium_video = preset(videos, "video quality", "low"), preset(videos, "video quality", "medium")
    wanted = [low, medium, low_video, medium_video]
    if not all(wanted) or None in (low["to_converged"], medium["to_converged"], low_video["flicker"], medium_video["flicker"]):
        return ""
    if medium["lmse20"] <= low["lmse20"] or medium_video["flicker"] >= low_video["flicker"]:
        return ""  # then the front shows it
    text = (f"\nBy LMSE of these few scenes alone `low` would do ({low['lmse20']:.4f} against {medium['lmse20']:.4f} on stills): `medium`, the "
            "default, does not lie on the front above. ")
    if has.get("fronts"):
        text += ("LMSE of single stills does not show this:\n\n![Fronts](fronts.png)\n\n*Flicker, hard shadows and real "
                 "objects against time; the gray band is the front of `intrinsicdecomp`'s levels.*\n\n")
    return text + (f"For its additional time `medium` gives steadiness (flicker {medium_video['flicker']:.4f} against "
                   f"{low_video['flicker']:.4f}), nearness to the converged solution ({medium['to_converged']:.3f} against "
                   f"{low['to_converged']:.3f}), and full resolution of shadows and small objects" + sharper(regimes) + ".\n")


def sharper(regimes):
    """LMSE of both presets on hard shadows and real objects, in brackets; empty where they were not measured."""
    out = []
    for regime, name in (("hard shadow" + summary.MARK, "hard shadows" + summary.MARK), ("MIT objects", "real objects")):
        low, medium = (next((p["lmse20"] for p in regimes.get(regime, []) if p["method"] == "intrinsicdecomp" and p["curve"] == "quality" and
                             p["preset"] == preset), None) for preset in ("low", "medium"))
        if low and medium:
            out.append(f"{name} {medium:.4f} against {low:.4f}")
    return f" ({', '.join(out)})" if out else ""


def leaving_out(results, has):
    """The section on adaptivity: through the element, of the kernels by scene with errors, and part by part."""
    entries, whole = results["adaptivity"], results.get("through_elements") or []
    kept = (results.get("kept") or {}).get("through_elements") or []
    out = ["## Skipped work\n"]
    if has["adaptivity"]:
        out.append("![Adaptivity](adaptivity.png)\n")
    if whole:
        out.append("Whole elements, NV12 in system memory in and out, frames 25 and later of a video (`globalintrinsic`: 57 and later if much is "
                   "skipped): a repeated frame, a ball that moves over a still picture (a tenth of the width), the same picture under sensor noise "
                   "(every pixel changes), the clip (light moves everywhere). Bold: three times faster or more.\n\n" + through_elements(whole))
        parts = parts_of_elements(whole) or parts_of_elements(kept)
        if parts:
            out.append("Each property of `intrinsicdecomp` alone (all others 0), and all but it, processor time in relation to `adaptive=false`. Parts "
                       "depend on each other: a tile is skipped only when its edges are reused and its cycles have converged.\n\n" + parts)
    out.append("The kernels alone at 320×240, videos of at least 48 frames (shorter ones are played forth and back; errors are of the last pass). The "
               "first frames of a video test what can be skipped, which costs some percent; only the first two frames are excluded.\n")
    for method in dict.fromkeys(e["method"] for e in entries):
        of = [e for e in entries if e["method"] == method]
        out.append(f"**`{method}`**" + (": light's color and amount are reused too if the scene is static; `tint` and `indJ` as in *Indirect light*"
                                        if method == "globalintrinsic" else "") + "\n\n" + adaptivity(of))
        clock = "processor_ratio" if any(e["processor_ratio"] for e in of) else "device_ratio"
        parts = by_parts([e for e in of if e[clock]], clock, left_out_where)
        if parts:
            out.append(folded(f"Each part of {method} alone", parts + "\n" + by_parts(of, "lmse20_added", left_out_where)))
    out.append("Frames of all settings take turns, forth and back; ratios are medians of pairs, intervals bootstrapped.\n")
    return "\n".join(out)


def write(results, folder, has):
    """`has` names the plots that were drawn."""
    rows, points = results["rows"], results["summary"]["own"]
    machine = results["machine"]
    knee = results["summary"]["knee"]
    knee = " to ".join(dict.fromkeys([knee[0], knee[-1]])) if knee else None
    out = ["""# Error against run time

Every method, its peers and answers without a solve, on one machine in one run. Made by
`./dev bench""" + (" --full" if results["full"] else "") + "`; every figure is in [results.json](results.json).\n"]
    out.append(headline(points) + "\n")
    out.append("![Error against run time](work-precision.png)\n\n"
               "*Mean over the project's own four stills. Left is faster, down is better; both axes are logarithmic. Circles: "
               "`quality` presets, the default in bold. Bars: quartiles of run time. The gray band is the Pareto front. "
               "Of a peer's settings the one with the least error is shown.*\n")
    if has["picture"]:
        out.append("![Layers](layers.jpg)\n\n*The still life: truth, and each method at its default (scaled to the truth by "
                   "least squares).*\n")
    out.append("## Quality levels\n\nThe levels of `intrinsicdecomp` as shipped: presets (`quality`), and the levels between them that the rate "
               "controller (`target-fps`, `latency-budget`) uses. Single frames, own stills:\n\n" + exchange(points, "quality") +
               "\nFrames that continue a video, own videos:\n\n" +
               exchange(results["summary"]["videos"], "video quality") + why_medium(points, results["summary"]["videos"], has, results["summary"]["regimes"]) +
               "\n## Each further cycle\n\nThe solve alone, at full resolution and with every cycle run:\n\n" +
               exchange(points, "cycles"))
    if knee:
        out.append("The knee of this curve (the points farthest below the line between its ends, in logarithms of error and "
                   f"{'processor' if 'llvmpipe' in results['device'] else 'device'} time) lies at **{knee} cycles**; the "
                   "default is 2 for frames with history, which start near their solution, and 4 for frames without.\n")
    if has["convergence"]:
        out.append("![Convergence](convergence.png)\n\n"
                   "*Distance to the method's own converged solution (200 cycles; the thesis' 24×16 and 32×8 iterations) in "
                   "natural log units: 0.01 is one percent. The processor's solvers minimize `intrinsicdecomp`'s energy "
                   "independently, in double precision, and are measured against the device's converged solution: the "
                   "end of their curve shows how well the two agree.*\n")
    out.append("![Other settings](knobs.png)\n\n*Other settings: resolution (shading enlarged with or without the full frame "
               "as a guide, reflectance from the full frame) and pyramid levels, each from the default.*\n")
    out.append("## Everybody\n\n" + everybody(points, results["methods"]) +
               "\nMeans over the own stills. `low` to `best`: presets. LMSE 20 and 10: windows of 20 (Grosse et al.) and 10 pixels (the "
               "thesis). Errors are means of reflectance and shading and invariant to scale; smaller is better except for MS-SSIM. "
               "A dash: nothing to measure. WHDR: share of 2000 pairs of points in wrong order of reflectance. Of a filter's strengths the one "
               "with the smallest LMSE is shown.\n")
    if has["regimes"]:
        out.append("## By regime\n\n![By regime](regimes.png)\n\n" + by_regime(results["summary"]["regimes"]) +
                   "\n<details><summary>By scale-invariant MSE and DSSIM</summary>\n\n" + other_measures(results["summary"]["regimes"]) +
                   "\n</details>\n\nOwn and given data together. No method is best everywhere: constant answers win if their assumption "
                   "is true (R = I / max_c I on palettes of one value). **†: training sets of `intrinsicdecomp`; their figures are optimistic** "
                   "([accuracy](../../docs/reference/accuracy.md)). It was never trained on the own set.\n")
    if results["summary"]["intervals"]:
        out.append("Uncertainty at `quality=medium`: brackets are 95 % bootstrap intervals over scenes, differences are "
                   "paired by scene, negative is better:\n\n" + by_regime_intervals(results["summary"]["intervals"]) +
                   "\nBest baseline: the best peer or constant answer in that regime at its best setting, which favors it. Separated: zero "
                   "lies outside the interval. Under six scenes even full agreement is weak evidence; under four the interval "
                   "is only the range; under three no statement is made.\n")
    levels = quality_by_regime(results["summary"]["regimes"])
    if levels:
        out.append("The quality levels, LMSE (k = 20) / DSSIM:\n\n" + levels)
    out.append(f"Given data: {results['data']}.\n")
    worth = terms(results)
    if worth:
        out.append(worth)
    known = light.paint_and_light(results)
    if known:
        out.append(known)
    if has.get("light"):
        out.append("![Methods with indirect light](light.png)\n\n*Mean over cornell †, room † and the own stills: the levels of the methods that separate "
                   "indirect light; stars: guesses without a solve.*\n")
    beyond = layers_beyond_two(rows, results["methods"])
    if beyond:
        out.append(beyond)
    out.append("## Videos\n\n" + videos(rows) +
               "\nFlicker: standard deviation over time of ln reflectance where the truth stands still, one factor a frame "
               "removed; jitter: the same from frame to frame only. LMSE is that of every third frame." +
               (" Given sequences under *slow light* have five interpolated steps for every one of theirs, those under *noise* are "
                "their first frame eight times under shot and read noise; true reflectance stands still in both."
                if any(r["scene"] == "slow light" for r in rows) else "") + "\n")
    out.append(leaving_out(results, has))
    out.append("## Condition number and digits\n\n")
    if results["extremes"]:
        out.append("![Condition numbers](conditions.png)\n\n*Each solver of `tests/extremes` in single precision against double "
                   "precision.*\n\n<details><summary>All cases</summary>\n\n" +
                   extremes(results["extremes"]["cases"]) + "\n</details>\n")
    else:
        out.append("Not measured in this run: `tests/extremes` was not built.\n")
    out.append("## Through the elements\n\n![Sizes](sizes.png)\n\n" + elements(all_elements(results)) +
               "\nFrames of the bundled clip as NV12 from system memory to system memory." +
               (f" Sizes with an asterisk: from an earlier `--full` run (commit {results['kept']['commit']}).\n"
                if (results.get("kept") or {}).get("elements") else "\n"))
    base_colors = light.costs(results, has)
    if base_colors:
        out.append(base_colors)
    out.append("## By other clocks\n\n![Device and processor time](other-clocks.png)\n")
    out.append("## By device\n\n" + by_device(results))
    for other in results.get("others") or []:
        out.append(f"### Each step on {other['device']}\n\n" + exchange(other["points"], "quality"))
    failed = failures(results)
    if failed:
        out.append(failed)
    load = max(machine["load_before"], machine["load_after"])
    out.append(f"""## How it was made

`./dev bench` takes a bit more than a minute on two idle cores, `./dev bench --full` some thirty minutes: two frames and the whole video of every given
sequence, every setting, every size. `--publish` also writes the short page that is committed, `docs/report`. `--resume` continues an interrupted run. `--data DIR` names another folder of ground truth,
`--against FILE` prints what got better or worse since an earlier `results.json`, `--add FILE` keeps the tables of an earlier `--full`
run's `results.json` that this run does not make, or adds a device on which `bench-methods` ran (it needs no more than libvulkan and
`scenes`: see `tests/bench/methods/methods_main.cpp`).

- Device: {results['device']}; {machine['processor']}, {machine['cores']} cores; {machine['system']}; commit {machine['commit']}.
""" + (f"- Measuring took {machine['seconds'] / 60:.1f} minutes.\n" if machine.get("seconds") else "") + f"""\
- The machine's load was {machine['load_before']:.1f} before and {machine['load_after']:.1f} after""" +
               (" — **other work ran meanwhile: trust ratios and processor time only**.\n" if load > 2.5 else ".\n") +
               """- All settings take turns on every frame""" + (", and programs take turns, twice" if results["full"] else "") + """; run time is the median. It is that of the
  method alone, from linear pixels in memory to layers in memory; conversion is in *Through the elements*.
""" + ("" if results["full"] else "- Distance to the converged solution is that of the first own still; with `--full` the mean over them.\n") + """- Own data: four stills and five videos of 320×240, rendered by the build (`tests/bench/scenes/own_scenes.cpp`). They are few, and
  **the ranking on them depends on their light**: in a first version of flatter light, without the clay scene, constant
  shading and Retinex scored best. Nothing was fitted to them.
- Metrics: `tests/bench/metrics/`; tested against closed forms and scikit-image.
""")
    (folder / "README.md").write_text("\n".join(out))

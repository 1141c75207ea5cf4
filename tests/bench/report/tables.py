# SPDX-License-Identifier: LGPL-2.1-or-later
"""The tables of the report's page, as Markdown: figures in, text out."""
import summary

OURS = ["intrinsicdecomp", "globalintrinsic", "thesis PCG", "thesis Schwarz"]
QUALITIES = ["low", "medium", "high", "best"]


def figure(value, digits=4):
    """.0297 as papers write it; a dash for what was not measured."""
    if value is None:
        return "–"
    text = f"{round(value, digits) + 0.0:.{digits}f}"
    if float(text) == 0:
        return "0"
    return text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) else text


def time(quartiles, scale=1):
    if not quartiles:
        return "–"
    middle = quartiles[1] * scale
    return f"{middle:.1f}" if middle < 100 else f"{middle:.0f}"


def spread(quartiles):
    return f"{time(quartiles)} ({quartiles[0]:.3g}…{quartiles[2]:.3g})" if quartiles else "–"


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(str(c) for c in row) + " |" for row in rows]) + "\n"


def find(points, method, base=False, **wanted):
    for p in points:
        if p["method"] == method and (not base or p["base"]) and all(p[k] == v for k, v in wanted.items()):
            return p
    return None


def headline(points):
    ours, thesis = find(points, "intrinsicdecomp", True), find(points, "thesis PCG", True)
    if not ours or not thesis or not ours["wall_ms"] or not thesis["wall_ms"]:
        return ""
    cpu = find(points, "same energy, CPU CG", setting="1e-2")
    text = (f"**At its default `intrinsicdecomp` takes {time(ours['wall_ms'])} ms for a frame of 320×240 and leaves an LMSE "
            f"of {figure(ours['lmse20'])}; the thesis' method takes {time(thesis['wall_ms'])} ms "
            f"({thesis['wall_ms'][1] / ours['wall_ms'][1]:.0f}×) and leaves {figure(thesis['lmse20'])}.**")
    if cpu and cpu["wall_ms"]:
        text += (f" A straightforward solver of the same energy on the processor (Eigen, double precision) takes "
                 f"{time(cpu['wall_ms'])} ms ({cpu['wall_ms'][1] / ours['wall_ms'][1]:.0f}×) to come within "
                 f"{figure(cpu['to_converged'])} of the solution, against {figure(ours['to_converged'])}.")
    return text


def exchange(points, along):
    """What each further step along a curve of intrinsicdecomp costs and brings."""
    curve = sorted((p for p in points if p["method"] == "intrinsicdecomp" and p["curve"] == along and p["wall_ms"]),
                   key=lambda p: p["order"])
    heads = {"quality": "resolution, cycles", "video quality": "resolution, warm cycles, edge-tolerance",
             "cycles": "cycles (all run)"}
    rows = []
    for before, p in zip([None] + curve, curve):
        gain = "" if before is None else f"{100 * (p['lmse20'] / before['lmse20'] - 1):+.1f} %"
        cost = "" if before is None else f"{p['processor_ms'][1] - before['processor_ms'][1]:+.1f} ms"
        name = f"`{p['preset']}`{' (default)' if p['preset'] == 'medium' else ''}" if p["preset"] else ""
        last = [figure(p["flicker"]), figure(p["jitter"])] if along == "video quality" else [figure(p["to_converged"])]
        rows.append([p["setting"], name, spread(p["wall_ms"]), time(p["device_ms"]), time(p["processor_ms"]),
                     figure(p["lmse20"])] + last + [cost, gain])
    if along == "cycles":
        rows = [row[:1] + row[2:] for row in rows]
    head = [heads[along], "`quality`", "ms on the clock (quartiles)", "on the device", "of the processor", "LMSE"]
    if along == "cycles":
        head.remove("`quality`")
    return table(head + (["flicker", "jitter"] if along == "video quality" else ["to converged"]) +
                 ["step costs (processor)", "step brings"], rows)


def everybody(points, methods):
    rows = []
    for method in dict.fromkeys(p["method"] for p in points):
        some = [p for p in points if p["method"] == method and p["lmse20"] is not None and p["curve"] not in
                ("adaptive", "without", "weights", "guess", "resolution", "levels", "coarse cycles", "cycles", "base colors")]
        some = [p for p in some if p["preset"] or p["base"] or method not in OURS]
        if method not in OURS and len(some) > 1 and "same energy" not in method:
            some = [min(some, key=lambda p: p["lmse20"])]  # nobody shall profit from a bad choice of ours
        for p in sorted(some, key=lambda p: p["order"]):
            name = f"`{p['preset']}`" if p["preset"] else p["setting"]
            rows.append((methods[method]["family"], [f"{method}{' ' + name if name else ''}", spread(p["wall_ms"]),
                         time(p["device_ms"]), time(p["processor_ms"]), figure(p["lmse20"]), figure(p["lmse10"]),
                         figure(p["mse"]), figure(p["dssim"]), figure(p["ms_ssim"], 3), figure(p["whdr"], 3)]))
    order = {"method": 0, "peer": 1, "trivial": 2}
    rows.sort(key=lambda r: order[r[0]])
    return table(["", "ms (quartiles)", "device ms", "processor ms", "LMSE 20", "LMSE 10", "si-MSE", "DSSIM", "MS-SSIM",
                  "WHDR"], [r for _, r in rows])


def by_regime(panels):
    names = [n for n, points in panels.items() if points]
    chosen = {}
    for name in names:
        for p in panels[name]:
            shown = p["base"] or (p["method"] not in OURS and p["curve"] != "tolerance")
            if shown and p["lmse20"] is not None:
                best = chosen.setdefault(p["method"], {})
                if name not in best or p["lmse20"] < best[name]:
                    best[name] = p["lmse20"]
    least = {n: min(v[n] for v in chosen.values() if n in v) for n in names}
    rows = []
    for method, values in chosen.items():
        rows.append([method] + [f"**{figure(values[n])}**" if values.get(n) == least[n] else figure(values.get(n))
                                for n in names])
    return table(["LMSE (k = 20)"] + names, rows)


def other_measures(panels):
    """Scale-invariant MSE and DSSIM, which may judge otherwise, regime by regime."""
    names = [n for n, points in panels.items() if points]
    rows = {}
    for n in names:
        best = {}
        for p in panels[n]:
            if (p["base"] or (p["method"] not in OURS and p["curve"] != "tolerance")) and p["mse"] is not None:
                if p["method"] not in best or p["lmse20"] < best[p["method"]]["lmse20"]:
                    best[p["method"]] = p
        for method, p in best.items():
            rows.setdefault(method, {})[n] = f"{figure(p['mse'], 3)} / {figure(p['dssim'], 3)}"
    return table(["si-MSE / DSSIM"] + names, [[m] + [of.get(n, "–") for n in names] for m, of in rows.items()])


def bracketed(mean, interval, sign=""):
    """.0401 [.0215, .0592]; with sign "+" differences; no brackets where too few scenes give no interval."""
    def text(value):
        digits = figure(abs(value))
        return ("−" if value < 0 else sign) + digits if digits != "0" else digits
    return text(mean) + (f" [{text(interval[0])}, {text(interval[2])}]" if interval else "")


def by_regime_intervals(entries):
    def against(difference):
        if not difference:
            return ["–"] * 3
        verdict = {None: "too few scenes", True: "yes", False: "no"}[difference["separated"]]
        return [bracketed(difference["mean"], difference["interval"], "+"),
                f"{difference['better']} of {difference['scenes']}", verdict]
    rows = []
    for regime, e in entries.items():
        baseline = e.get("baseline")
        rows.append([regime, bracketed(e["mean"], e["interval"])] + against(e["minus_thesis"]) +
                    [f"{baseline['method']}{' ' + baseline['setting'] if baseline['setting'] else ''}: "
                     f"{figure(baseline['mean'])}" if baseline else "–"] + against(e.get("minus_baseline")))
    return table(["LMSE (k = 20)", "intrinsicdecomp", "minus thesis", "better in", "separated", "best baseline",
                  "minus it", "better in", "separated"], rows)


def given_video(row):
    """The name of a given sequence, and under what it is shown if not as it is."""
    return summary.mark(row["set"]) + ("" if row["scene"] == "video" else f", {row['scene']}")


def folded(title, text):
    return f"\n<details><summary>{title}</summary>\n\n{text}\n</details>\n"


def videos(rows):
    """The project's own, and those that were given, out of sight until they are asked for."""
    rows = [r for r in rows if r["video"] and r.get("flicker") is not None and r.get("lmse20") is not None and
            (r["curve"] not in ("adaptive", "video quality") or r["preset"]) and
            (r["curve"] != "without" or r["setting"] == "temporal anchor") and r["curve"] != "base colors" and
            r["method"] not in ("constant reflectance", "R = I / max_c I")]
    own, given = [], []
    for r in sorted(rows, key=lambda r: (r["set"], r["scene"])):
        name = r["method"] + ((f", `{r['preset']}`" if r["preset"] else f", {r['curve']} {r['setting']}") if r["method"] in OURS else "")
        if r["method"] == "constant shading":
            name = "the input itself"
        (own if r["set"] == "own" else given).append(
            [r["scene"] if r["set"] == "own" else given_video(r), name, time(r["wall_ms"]), figure(r["lmse20"]),
             figure(r["flicker"]), figure(r["jitter"])])
    head = ["video", "method", "ms", "LMSE", "flicker", "jitter"]
    return table(head, own) + (folded("Given sequences", table(head, given)) if given else "")


def left_out_where(entry):
    """An entry's scene and what happens in it."""
    if "regime" not in entry:
        return f"{entry['scene']}, {entry['width']}×{entry['height']}, element"
    return f"{entry['scene'] if entry['set'] == 'own' else given_video(entry)}: {entry['regime']}"


def ratio(found, digits=2):
    """.41 (≤ .45): a ratio of times and its 95 % bound."""
    return f"{figure(found[1], digits)} (≤ {figure(found[2], digits)})" if found else "–"


def times_faster(found):
    """In bold where it is three times or more."""
    if not found or not found[1]:
        return "–"
    text = f"{1 / found[1]:.1f}×" if 1 / found[1] < 100 else f"{1 / found[1]:.0f}×"
    return f"**{text}**" if 1 / found[1] >= 3 else text


def added(value):
    """+.0006, of an error."""
    return "–" if value is None else figure(abs(value)) if figure(value) == "0" else ("−" if value < 0 else "+") + figure(abs(value))


def by_parts(entries, field, where):
    """Ratios of processor times, or errors added, a row for each scene of which parts were measured, a column for each part
    that is left out alone."""
    def cell(entry):
        value = entry.get(field) if entry else None
        return added(value) if field.endswith("_added") else figure(value[1], 2) if value else "–"
    settings = [s for s in dict.fromkeys(e["setting"].removeprefix("adaptive=") for e in entries) if s != "on"]
    if not settings:
        return ""
    rows = {}
    for e in entries:
        rows.setdefault(where(e), {})[e["setting"].removeprefix("adaptive=")] = e
    head = {"processor_ratio": "processor time", "device_ratio": "device time", "lmse20_added": "LMSE added"}[field]
    return table([head, "all"] + settings,
                 [[name] + [cell(of.get(s)) for s in ["on"] + settings] for name, of in rows.items() if len(of) > 1])


def element_of(entry):
    """The element of an entry of through_elements; earlier reports had but one."""
    return entry.get("element", "intrinsicdecomp")


def parts_of_elements(entries):
    """Ratios of processor time, a row for each part, a column for each scene: the part alone / all but it; of the element of
    which parts were measured."""
    measured = {element_of(e) for e in entries if e["setting"] != "on"}
    entries = [e for e in entries if element_of(e) in measured]
    rows, scenes = {}, {}
    for e in entries:
        part, slot = e["setting"].removeprefix("all but "), e["setting"].startswith("all but ")
        if part != "on" and e["processor_ratio"]:
            scenes[left_out_where(e)] = None
            rows.setdefault(part, {}).setdefault(left_out_where(e), [None, None])[slot] = e["processor_ratio"][1]
    whole = {left_out_where(e): e["processor_ratio"][1] for e in entries if e["setting"] == "on" and e["processor_ratio"]}
    if not rows:
        return ""
    out = [["all"] + [figure(whole.get(s), 2) for s in scenes]]
    for part, of in rows.items():
        cells = [of.get(s) or [None, None] for s in scenes]
        out.append([part] + [figure(alone, 2) + (f" / {figure(others, 2)}" if others is not None else "") for alone, others in cells])
    return table(["alone / all but it"] + list(scenes), out)


def through_elements(entries):
    rows = []
    for e in (e for e in entries if e["setting"] == "on"):
        wall, cpu = e["wall_ms"], e["processor_ms"]
        rows.append([f"`{element_of(e)}`", e["scene"], f"{e['width']}×{e['height']}", e.get("pairs", "–"), f"{wall[0]:.1f} → {wall[1]:.1f}", f"{cpu[0]:.1f} → {cpu[1]:.1f}",
                     ratio(e["processor_ratio"], 3), times_faster(e["processor_ratio"])])
    return table(["element", "scene", "size", "pairs", "ms without → with", "processor ms", "ratio (95 % bound)", "faster"], rows)


def adaptivity(entries):
    """What leaving out saves by scene, all of it together, and what it does to errors: of light, too, of a method that knows
    its color."""
    entries = [e for e in entries if e["wall_ratio"] and e["setting"] == "adaptive=on"]
    errors = {"lmse20": "LMSE", "flicker": "flicker", "tint": "`tint`", "indJ": "`indJ`"}
    errors = {n: t for n, t in errors.items() if n in ("lmse20", "flicker") or any(f"{n}_added" in e for e in entries)}
    rows = []
    for e in entries:
        low, middle, high = e["wall_ratio"]
        rows.append([(e["scene"] if e["set"] == "own" else given_video(e)), e["regime"], e["pairs"],
                     f"{time([0, e['wall_ms'][0]])} → {time([0, e['wall_ms'][1]])}" if None not in e["wall_ms"] else "–",
                     f"{100 * (1 - middle):.0f} % ({100 * (1 - high):.0f}…{100 * (1 - low):.0f})",
                     ratio(e["processor_ratio"]), times_faster(e["processor_ratio"])] +
                    [added(e.get(f"{n}_added")) for n in errors])
    return table(["scene", "what happens", "pairs", "ms without → with", "time saved (95 %)", "processor-time ratio (95 % bound)",
                  "faster"] + [f"{t} added" for t in errors.values()], rows)


def extremes(cases):
    rows = [[c["name"], f"{c['condition']:.1e}", figure(c.get("digits_plain"), 1), figure(c.get("digits_preconditioned"), 1)]
            for c in sorted(cases, key=lambda c: c["condition"])]
    return table(["case", "condition number", "digits kept, plain", "preconditioned"], rows)


def elements(entries):
    rows = [[f"`{e['element']}`", f"{e['width']}×{e['height']}{'*' if e.get('kept') else ''}", f"{e['wall_ms']:.1f}", f"{e['processor_ms']:.1f}",
             f"{e['device_ms']:.1f}", f"{1000 / e['wall_ms']:.{0 if e['wall_ms'] < 100 else 1}f}", f"{e['first_frame_ms']:.0f}",
             f"{e['device_bytes_per_pixel']:.0f}"] for e in entries]
    return table(["element", "size", "ms a frame", "processor ms", "device ms", "frames a second", "first frame, ms",
                  "device bytes a pixel"], rows)


def all_elements(results):
    """This run's, and those that were kept of an earlier one."""
    kept = (results.get("kept") or {}).get("elements", [])
    return sorted(results["elements"] + [{**e, "kept": True} for e in kept], key=lambda e: (e["element"], e["width"]))


def signed(value, digits=0):
    """−12 %, of a ratio."""
    percent = 100 * (value - 1)
    return f"{percent:+.{digits}f} %".replace("-", "−") if round(percent, digits) else "0 %"


def without(entries):
    """Errors with one term left out, regime by regime, what that makes of the error, and of the time."""
    if not entries:
        return ""
    whole, rows = entries[0], []
    for e in entries:
        cells = [figure(v) + ("" if e is whole or not whole["errors"][n] else f" ({signed(v / whole['errors'][n])})")
                 for n, v in e["errors"].items()]
        rows.append([f"without {e['term']}" if e["term"] else "whole"] + cells +
                    ["" if e is whole or not e["time"] else signed(e["time"])])
    return table(["LMSE (k = 20)"] + [f"{n} ({c})" for n, c in whole["scenes"].items()] + ["time"], rows)


def without_on_videos(entries):
    own, given = [], []
    for scene in entries[0]["figures"]:
        for e in entries:
            f = e["figures"][scene]
            if f["flicker"] is not None:  # else the camera moves
                name = scene[1] if scene[0] == "own" else given_video({"set": scene[0], "scene": scene[1]})
                (own if scene[0] == "own" else given).append(
                    [name, f"without {e['term']}" if e["term"] else "whole", figure(f["lmse20"]), figure(f["flicker"]), figure(f["jitter"])])
    head = ["video", "", "LMSE", "flicker", "jitter"]
    return table(head, own) + (folded("Given sequences", table(head, given)) if given else "")


def left_out(found):
    rows = [[f"{n} ({e['scenes']})", figure(e["ships"]), figure(e["left_out"]), figure(e["best"])] for n, e in found["regimes"].items()]
    return table(["LMSE (k = 20)", "as shipped", "chosen without the scene", "best for the regime itself"], rows)


def layers_beyond_two(rows, methods):
    """Errors of direct and indirect light, once a method tells them apart; beside it guesses that need no solve."""
    rows = [r for r in rows if not r["video"] and r.get("ind") is not None]
    if not any(methods[r["method"]]["family"] == "method" for r in rows):
        return ""
    scenes = dict.fromkeys((r["set"], r["scene"]) for r in rows)
    groups = {}
    for r in rows:
        groups.setdefault((r["method"], r["curve"], r["setting"]), {})[r["set"], r["scene"]] = r
    shown = [(key, of) for key, of in groups.items() if methods[key[0]]["family"] != "method" or key[1] in ("with", "without") or any(
        r["base"] or r["preset"] for r in of.values())]
    shown.sort(key=lambda g: (methods[g[0][0]]["family"] != "method", g[0][:2], next(iter(g[1].values()))["order"]))
    def name(key, of):
        preset = next((r["preset"] for r in of.values() if r["preset"]), "")
        return f"{key[0]} `{preset}`" if preset else f"{key[0]} {key[1]} {key[2]}" if key[1] in ("with", "without") else ": ".join(n for n in (key[0], key[2]) if n)
    out, means = [], {}
    for field, title in (("ind", "Indirect light, at its own best scale (`ind`)"), ("indJ", "Indirect light, at the scale of the whole shading (`indJ`)"),
                         ("dirJ", "Direct light, at that scale (`dirJ`)"), ("tint", "Color of the shading (`tint`), rms of ln chroma")):
        least = {s: min((of[s][field] for _, of in shown if s in of), default=None) for s in scenes}
        table_rows = []
        for key, of in shown:
            cells = [f"**{figure(of[s][field])}**" if s in of and of[s][field] == least[s] else figure(of[s][field] if s in of else None)
                     for s in scenes]
            table_rows.append([name(key, of), figure(summary.mean(r[field] for r in of.values()) if len(of) == len(scenes) else None)] +
                              cells)
        out.append(folded(title, table([title, "mean"] + [summary.mark(a) if a != "own" else b for a, b in scenes], table_rows)))
        for row in table_rows:
            means.setdefault(row[0], []).append(row[1])
    return ("## Indirect light\n\nShading is the sum of direct light and of light from other surfaces, both RGB; errors are squared, relative "
            "to the squared truth: 0 is perfect, 1 as bad as black. Guesses are a share of `intrinsicdecomp`'s shading. Means over all scenes, "
            "of the methods that were measured on all of them:\n\n" +
            table(["mean", "`ind`", "`indJ`", "`dirJ`", "`tint`"], [[n, *v] for n, v in means.items() if set(v) != {"–"}]) + "".join(out))


def by_device(results):
    """Run times of presets on every device that was measured."""
    columns = [(results["device"], results["summary"]["own"])] + [(o["device"], o["points"]) for o in results.get("others") or []]
    if len(columns) < 2:
        return ("One device so far. `bench-methods` needs no more than libvulkan and the scenes: run it on another machine "
                "(`tests/bench/methods/methods_main.cpp`), and `--add FILE` gives that device a column here.\n")
    curves = {"intrinsicdecomp": "quality", "globalintrinsic": "quality", "thesis PCG": "iterations", "thesis Schwarz": "iterations"}
    rows = []
    for p in columns[0][1]:
        if p["curve"] != curves.get(p["method"]) or not (p["preset"] or p["base"]) or not p["wall_ms"]:
            continue
        cells = []
        for _, points in columns:
            q = find(points, p["method"], curve=p["curve"], setting=p["setting"])
            cells += [time(q["wall_ms"]), time(q["device_ms"]), figure(q["lmse20"])] if q else ["–"] * 3
        rows.append([p["method"] + (f" `{p['preset']}`" if p["preset"] else f" {p['setting']}")] + cells)
    heads = [f"{d.split(' (')[0]}: {what}" for d, _ in columns for what in ("ms", "device ms", "LMSE")]
    return table(["320×240, own stills"] + heads, rows)


def quality_by_regime(panels):
    """The quality levels on all data."""
    names = [n for n, points in panels.items() if any(p["curve"] == "quality" for p in points)]
    levels = {}
    for n in names:
        for p in panels[n]:
            if p["method"] == "intrinsicdecomp" and p["curve"] == "quality":
                levels.setdefault((p["order"], p["setting"], p["preset"]), {})[n] = p
    levels = {level: of for level, of in levels.items() if len(of) == len(names)}
    if len(levels) < 5:  # presets alone
        return ""
    rows = [[setting, f"`{preset}`" if preset else ""] + [f"{figure(of[n]['lmse20'])} / {figure(of[n]['dssim'], 3)}" 
                                                          for n in names] for (_, setting, preset), of in sorted(levels.items())]
    return table(["resolution, cycles", "`quality`"] + names, rows)

# SPDX-License-Identifier: LGPL-2.1-or-later
"""The report's sections on methods with indirect light: errors of reflectance and of layers of light, base colors and marks,
what each base color costs, and whether frames wait for background work."""
import statistics

import summary
from tables import figure, table, time

GROUPS = {"cornell": summary.mark("cornell"), "room": summary.mark("room"), "own": "own stills"}
COLUMNS = [("lmse20_R", "LMSE R"), ("lmse20_S", "S"), ("lmse20_dir", "direct"), ("mse_R", "si-MSE R"), ("mse_S", "S"),
           ("dssim_R", "DSSIM R"), ("dssim_S", "S"), ("ind", "`ind`"), ("indJ", "`indJ`"), ("dirJ", "`dirJ`")]
THESIS = "globalintrinsicthesis"
# Of a method that has several settings the one that is shown.
SHOWN = {"constant reflectance": "", "constant shading": "", "R = I / max_c I": "", "gray Retinex": "t .1",
         "color Retinex": "t .5, c .1", "thesis PCG": "4x8"}
ORDER = [*SHOWN, "intrinsicdecomp", "guessed indirect light", "globalintrinsic", THESIS]


def title(row):
    """What a row is called in these tables; empty where it is not shown."""
    method, curve, setting = row["method"], row["curve"], row["setting"]
    if method in SHOWN:
        return method if SHOWN[method] in ("", setting) and curve not in ("levels", "resolution", "without") else ""
    if method == "guessed indirect light":
        return f"intrinsicdecomp and {'constant gray' if 'gray' in setting else 'blurred image'} for indirect light"
    if method == THESIS and curve in ("with", "without"):
        return f"{method} {curve} {setting}"
    if method in ("intrinsicdecomp", "globalintrinsic", THESIS):
        return method if row["base"] else ""
    return ""


def wanted(row):
    """Whether these sections ask for a row; all must be of one run, as others take other frames of a scene."""
    quality = row["curve"] == "quality" and row["method"] in (THESIS, "globalintrinsic", "intrinsicdecomp")
    return not row["video"] and row["set"] in GROUPS and row.get("lmse20_R") is not None and (quality or bool(title(row)))


def chosen(results):
    """Rows of this run, or of an earlier --full run where this one has none of the thesis' method."""
    rows = [r for r in results["rows"] if wanted(r)]
    kept = results.get("kept")
    if kept and not any(r["method"] == THESIS for r in rows):
        return [r for r in kept["rows"] if wanted(r)], kept
    return rows, None


def by_group(rows):
    """{title: {group: means over its scenes}}, only of scenes that every title of a group has."""
    out = {}
    names = sorted({(ORDER.index(r["method"]), title(r)) for r in rows if title(r)})
    for group in GROUPS:
        here = [r for r in rows if r["set"] == group and title(r)]
        scenes = {r["scene"] for r in here}
        for _, name in names:
            some = [r for r in here if title(r) == name]
            if {r["scene"] for r in some} == scenes and some:
                fields = [f for f, _ in COLUMNS] + summary.FIGURES
                out.setdefault(name, {})[group] = {f: summary.mean(r.get(f) for r in some) for f in fields}
    return out


def errors(found):
    """One table for each group of scenes; the least of every column in bold."""
    out = []
    for group, heading in GROUPS.items():
        of = {name: groups[group] for name, groups in found.items() if group in groups}
        if not of:
            continue
        least = {f: min((v[f] for v in of.values() if v[f] is not None), default=None) for f, _ in COLUMNS}
        rows = [[name] + [f"**{figure(v[f])}**" if v[f] is not None and v[f] == least[f] else figure(v[f]) for f, _ in COLUMNS]
                for name, v in of.items()]
        out.append(table([f"**{heading}**"] + [n for _, n in COLUMNS], rows))
    return "\n".join(out)


def base_colors(found):
    """Errors of base colors before and after refinement, and what clicks are for."""
    rows = []
    for name, heading in ((THESIS, "as it is"), (f"{THESIS} with correction", "clicks, color chosen by sparsity")):
        for group, v in found.get(name, {}).items():
            if v["base_before"] is None:
                continue
            rows.append([GROUPS[group], heading, figure(v["base_before"], 3), figure(v["base_after"], 3), f"{100 * v['misclustered']:.1f} %", figure(v["clicks"], 1), figure(v["clicks_right"], 1), figure(v["layers"], 1)])
    rows.sort(key=lambda r: list(GROUPS.values()).index(r[0]))
    return table(["", "", "base colors before", "refined", "pixels of a wrong color", "clicks", "of them decided right", "layers"],
                 rows) if rows else ""


def paint_and_light(results):
    """The section's text; empty without rows."""
    rows, kept = chosen(results)
    found = by_group(rows)
    if not found:
        return ""
    out = ["## Reflectance and light\n"]
    if kept:
        out.append(f"From an earlier `--full` run (commit {kept['commit']}).\n")
    frames = max(r["frames"] for r in rows if r["set"] != "own") if any(r["set"] != "own" for r in rows) else 0
    out.append(f"Rendered scenes with known direct and indirect light: the sequences cornell † and room † ({frames} frame{'s' if frames > 1 else ''} of each, if "
               "available), and the project's own stills. R reflectance, S all light; one scale for all channels, so color errors count and figures are "
               "larger than above. LMSE with windows of 20 pixels; `ind`, `indJ` and `dirJ` as in "
               "*Indirect light*. At `quality=medium`.\n")
    out.append(errors(found))
    if THESIS in found:
        out.append("\n`globalintrinsicthesis` has its base colors before it is timed and scored, as in a running video. "
                   "*Without soft Retinex weight*: every pixel counts (`alpha-sr`). *With correction*: every region of half a percent of the frame or "
                   "more whose base color is wrong by the truth (.1 in ln chromaticity nearer to another) is marked, and the method chooses its "
                   "color (Eq. 5.11); *true colors*: the true one is given.\n")
    colors = base_colors(found)
    if colors:
        out.append("### Base colors before and after refinement\n\nDistance in chromaticity (mean 1) from the mean true paint of the pixels that "
                   "were given to each base color, as in Fig. 5.4, means over base colors and frames.\n\n" + colors + verdict(found))
    return "\n".join(out)


def verdict(found):
    """What refinement and marks change, in words."""
    def mean(name, field):
        return summary.mean(v[field] for v in found.get(name, {}).values())
    before, after = mean(THESIS, "base_before"), mean(THESIS, "base_after")
    plain, bare = mean(THESIS, "lmse20_R"), mean(f"{THESIS} with correction", "lmse20_R")
    if None in (before, after, plain, bare):
        return ""
    return (f"\nRefinement takes base colors {'nearer to' if after < before else 'away from'} the paint here ({before:.2f} → {after:.2f}): what is "
            f"refined is the color of the light in a layer, which the energy can mix freely. Marks change the error of reflectance from "
            f"{figure(plain)} to {figure(bare)}.\n")


def by_colors(entries):
    """What each base color costs, through the elements."""
    rows = []
    for name in dict.fromkeys(e["name"] for e in entries):
        some = [e for e in entries if e["name"] == name]
        for before, e in zip([None] + some, some):
            per = ""
            if before and e["layers"] > before["layers"]:
                per = f"{(e['device_bytes_per_pixel'] - before['device_bytes_per_pixel']) / (e['layers'] - before['layers']):.0f}"
            rows.append([f"`{name}`" if " " not in name else name, e["colors"], e["layers"], f"{e['device_bytes_per_pixel']:.0f}", per,
                         f"{e['wall_ms']:.1f}", f"{e['processor_ms']:.1f}"])
    return table(["", "`base-colors`", "found in this clip", "device bytes a pixel", "for each more", "ms a frame", "processor ms"], rows)


def of_lines(entries):
    """Entries of element-bench with the element's name in words and how many base colors were asked for."""
    out = []
    for e in entries:
        name = "globalintrinsicthesis" if e["element"].startswith(THESIS) else "globalintrinsic with layers of light"
        asked = next((int(w.split("=")[-1]) for w in e["element"].split() if "base-colors=" in w), None)
        out.append({**e, "name": name, "colors": asked})
    return out


def background(found):
    """How long frames take while something is decided beside them."""
    rows = []
    for name, times in found["times_ms"].items():
        if times:
            ordered = sorted(times)
            at = [ordered[round(share * (len(ordered) - 1))] for share in (0.5, 0.95, 1)]
            rows.append([{"alone": "nothing else", "refining": "base colors are refined", "correcting": "a region's color is decided"}[name],
                         len(times)] + [time([0, t]) for t in at])
    return table(["under way", "frames", "median ms", "95 %", "longest"], rows)


def held_up(found):
    """How much longer frames are with something under way, in words."""
    alone = sorted(found["times_ms"].get("alone") or [])
    if not alone:
        return ""
    middle, most = statistics.median(alone), alone[-1]
    parts = []
    for name, what in (("refining", "while base colors are refined"), ("correcting", "while a region's color is decided")):
        times = found["times_ms"].get(name)
        if times:
            above = sum(t > most for t in times)
            parts.append(f"{statistics.median(times) / middle:.2f} times as long {what} ({above} of {len(times)} frames longer than the longest without)")
    return "\nThe median frame takes " + ", ".join(parts) + ".\n" if parts else ""


def costs(results, has):
    """The section on base colors' costs and on frames that do not wait; empty without figures."""
    kept = results.get("kept") or {}
    colors = results.get("by_colors") or kept.get("by_colors") or []
    held = results.get("background") or kept.get("background")
    if not colors and not held:
        return ""
    out = ["## What base colors cost\n"]
    if not results.get("by_colors") and kept:
        out.append(f"From an earlier `--full` run (commit {kept['commit']}).\n")
    if colors:
        if has.get("colors"):
            out.append("![Base colors](colors.png)\n")
        out.append("Frames of the bundled clip at 320×240, through the elements. `globalintrinsicthesis` is built for as many layers as the scene "
                   "has, four to a plane; so memory and time go up in steps of four.\n\n" + by_colors(of_lines(colors)))
    if held:
        if has.get("background"):
            out.append("![Frame times](background.png)\n")
        at = f"{held['width']}×{held['height']}"
        out.append(f"Frames of `globalintrinsicthesis` while base colors are refined and while the color of a marked region is decided in the "
                   f"background: frames of the clip at {held['width']}×{held['height']}, blocks of each kind in turn, "
                   f"{held['refinements']} refinements and {held['decisions']} regions decided meanwhile.\n\n" + background(held) + held_up(held))
    return "\n".join(out)

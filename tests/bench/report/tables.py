# SPDX-License-Identifier: LGPL-2.1-or-later
"""Figures and tables of the report and of the accuracy page, as Markdown."""
import pathlib

import summary

FILTERS = ["domain transform", "fast global smoother", "guided filter", "l0 smoothing"]  # in the plot only
ENERGY_IN_PLOT = ["3e-2", "1e-3", "1e-5"]  # tolerances of "same energy", in the plot only
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


def inserted(page, name, text):
    """The page with the text between its lines <!-- name --> and <!-- end -->."""
    head, middle, rest = page.partition(f"<!-- {name} -->\n")
    _, end, tail = rest.partition("<!-- end -->\n")
    if not middle or not end:
        raise ValueError(f"the page lacks the lines <!-- {name} --> and <!-- end -->")
    return head + middle + text + end + tail


def pages_of(arguments):
    """The pages that leading `--page FILE` name, and the arguments after them."""
    pages = []
    while arguments[:1] == ("--page",):
        pages.append(pathlib.Path(arguments[1]))
        arguments = arguments[2:]
    return pages, arguments


def insert(pages, parts):
    """Writes {name: text} into the pages: each part where a page has its lines, and at least one part into each page."""
    for path in pages:
        page = path.read_text()
        names = [name for name in parts if f"<!-- {name} -->\n" in page]
        if not names:
            raise ValueError(f"{path} lacks lines <!-- NAME --> of {', '.join(parts)}")
        for name in names:
            page = inserted(page, name, parts[name])
        path.write_text(page)


def find(points, method, base=False, **wanted):
    for p in points:
        if p["method"] == method and (not base or p["base"]) and all(p[k] == v for k, v in wanted.items()):
            return p
    return None


def all_methods(points, methods):
    rows = []
    for method in dict.fromkeys(p["method"] for p in points):
        some = [p for p in points if p["method"] == method and method not in FILTERS and p["lmse20"] is not None and p["curve"] not in
                ("adaptive", "without", "weights", "guess", "resolution", "levels", "coarse cycles", "cycles", "base colors")]
        some = [p for p in some if p["base"] or method not in OURS and p["setting"] not in ENERGY_IN_PLOT]
        if method not in OURS and len(some) > 1 and "same energy" not in method:
            some = [min(some, key=lambda p: p["lmse20"])]  # so that a bad choice of ours does not count against it
        for p in sorted(some, key=lambda p: p["order"]):
            name = "" if method in OURS else p["setting"]
            rows.append((methods[method]["family"], [f"{method}{' ' + name if name else ''}", spread(p["wall_ms"]),
                         *(figure(p[k]) for k in ("lmse20", "mse", "dssim")), figure(p["whdr"], 3)]))
    order = {"method": 0, "peer": 1, "trivial": 2}
    rows.sort(key=lambda r: order[r[0]])
    return table(["", "ms (quartiles)", "LMSE (k = 20)", "si-MSE", "DSSIM", "WHDR"], [r for _, r in rows])


def bracketed(mean, interval, sign="", decimals=4):
    """.0401 [.0215, .0592]; with sign "+" differences; no brackets where too few scenes give no interval."""
    def text(value):
        digits = figure(abs(value), decimals)
        return ("−" if value < 0 else sign) + digits if digits != "0" else digits
    return text(mean) + (f" [{text(interval[0])}, {text(interval[2])}]" if interval else "")


def ratio(found, digits=2):
    """.41 (≤ .45): a ratio of times and its 95 % bound."""
    return f"{figure(found[1], digits)} (≤ {figure(found[2], digits)})" if found else "–"



def signed(value, digits=0):
    """−12 %, of a ratio."""
    percent = 100 * (value - 1)
    return f"{percent:+.{digits}f} %".replace("-", "−") if round(percent, digits) else "0 %"


def without(entries):
    """Errors with one term left out, regime by regime, what that makes of the error, and of the time, where it is known."""
    if not entries:
        return ""
    whole, rows, timed = entries[0], [], any(e["time"] for e in entries)
    for e in entries:
        cells = [figure(v) + ("" if e is whole or not whole["errors"][n] else f" ({signed(v / whole['errors'][n])})")
                 for n, v in e["errors"].items()]
        rows.append([f"without {e['term']}" if e["term"] else "whole"] + cells +
                    (["" if e is whole or not e["time"] else signed(e["time"])] if timed else []))
    return table(["LMSE (k = 20)"] + [f"{n} ({c})" for n, c in whole["scenes"].items()] + (["time"] if timed else []), rows)


def left_out(found):
    rows = [[f"{n} ({e['scenes']})", figure(e["ships"]), figure(e["left_out"]), figure(e["best"])] for n, e in found["regimes"].items()]
    return table(["LMSE (k = 20)", "as shipped", "chosen without the scene", "best for the regime itself"], rows)

#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Reflectance on photographs whose pairs of points were judged by eye: WHDR (Bell et al. 2014).

    tests/bench/report/whdr.py build-bench ../shared/data/real_pairs [--page docs/reference/accuracy.md] [--page docs/notes/accuracy.md] [METHOD …]

runs the programs and prints the tables; --page also writes between a page's lines <!-- photographs --> and <!-- end --> the short table,
between <!-- judged --> and <!-- end --> all of them.
"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import intervals
import tables
from tables import figure

PROGRAMS = ["bench-methods", "bench-peers"]
DELTA = 0.1  # of Bell et al.: reflectances that differ by less are called equal
DELTAS = [k / 100 for k in range(5, 51)]
CHROMA = 16  # C*ab of the picture; a pair is achromatic if neither point is above
GROUPS = ["equal", "achromatic", "chromatic"]


def joined(results):
    """What several programs wrote about the same photographs, as one."""
    return {"pictures": results[0]["pictures"], "rows": [r for one in results for r in one["rows"]]}


def judgment(ratio, delta):
    """Which of two points is darker, from the ratio of their reflectances: 1, 2 or E (equal)."""
    return "1" if 1 / ratio > 1 + delta else "2" if ratio > 1 + delta else "E"


def pairs_of(pictures, ratios):
    """(picture, judged, group, ratio) of each pair; ratios by picture."""
    for picture in pictures:
        name = picture["picture"]
        for darker, chroma, ratio in zip(picture["darker"], picture["chroma"], ratios[name], strict=True):
            group = "equal" if darker == "E" else "achromatic" if chroma <= CHROMA else "chromatic"
            yield name, darker, group, ratio


def whdr(pairs, delta, group=None):
    """The share of pairs, of all or of a group, that are judged otherwise; None of no pairs."""
    wrong = [judgment(ratio, delta) != darker for _, darker, of, ratio in pairs if group in (None, of)]
    return sum(wrong) / len(wrong) if wrong else None


def wrong_order(pairs):
    """The share of unequal pairs whose other point is darker by more than DELTA."""
    reversed_ = [judgment(ratio, DELTA) not in (darker, "E") for _, darker, _, ratio in pairs if darker != "E"]
    return sum(reversed_) / len(reversed_) if reversed_ else None


def rms_of_equal(pairs):
    """Root mean square of ln ratio over equal pairs."""
    logs = [math.log(ratio) ** 2 for _, darker, _, ratio in pairs if darker == "E"]
    return math.sqrt(sum(logs) / len(logs)) if logs else None


def by_picture(pairs, delta):
    """{picture: (wrong, all)}."""
    counts = {}
    for name, darker, _, ratio in pairs:
        wrong, total = counts.get(name, (0, 0))
        counts[name] = (wrong + (judgment(ratio, delta) != darker), total + 1)
    return counts


def scores(pairs):
    """All measures of a method. The interval at the best delta keeps that delta."""
    best = min(DELTAS, key=lambda delta: whdr(pairs, delta))
    return {"best": best, "wrong_order": wrong_order(pairs), "rms": rms_of_equal(pairs),
            **{name: {"whdr": whdr(pairs, delta), "interval": intervals.bootstrap_share(by_picture(pairs, delta).values()),
                      **{group: whdr(pairs, delta, group) for group in GROUPS}} for name, delta in (("at_delta", DELTA), ("at_best", best))}}


def methods(found):
    """{(method, curve, setting): pairs} of those that were measured on all pictures."""
    ratios = {}
    for row in found["rows"]:
        ratios.setdefault((row["method"], row["curve"], row["setting"]), {})[row["picture"]] = row["ratios"]
    return {key: list(pairs_of(found["pictures"], of)) for key, of in ratios.items() if len(of) == len(found["pictures"])}


def titles(found):
    """{(method, curve, setting): title} of the rows of the table, in their order."""
    settings = {(r["method"], r["curve"], r["setting"]): r for r in found["rows"]}
    names = {"thesis PCG": "thesis, chapter 3", "globalintrinsicthesis": "thesis, chapter 5"}
    out, thesis, ours = {}, {}, {}
    for key, row in settings.items():
        method, curve, setting = key
        if row["base"]:
            (thesis if method in names else ours)[key] = names.get(method, method)
        elif (curve, setting) == ("without", "color of light"):
            ours[key] = f"{method}, gray light"
        elif curve == "prior":
            ours[key] = f"{method} with a network, {setting}"
        elif (method, curve) == ("intrinsicdecomp", "without"):
            ours[key] = f"{method} without {setting}"
        elif method == "thesis PCG":
            thesis[key] = f"{names[method]} without {setting.replace('printed, without', 'p/2,').replace('printed', 'p/2')}"
        elif row["preset"] and method in ("intrinsicdecomp", "globalintrinsic"):
            ours[key] = f"{method} `{row['preset']}`"
        elif curve in ("only", "thresholds") or method in tables.FILTERS:
            out[key] = f"{method} {setting}".strip()
    return {**out, **dict(sorted(thesis.items(), key=lambda item: item[1])), **ours}


def share(value):
    return figure(value, 3)


def is_variant(title):
    """Whether a row is of a setting beside the default, and no method of its own."""
    return "`" in title or " without " in title


def errors(all_pairs, names):
    rows = []
    for key, title in names.items():
        s = scores(all_pairs[key])
        cells = [title]
        for name in ("at_delta", "at_best"):
            at = s[name]
            cells += [f"{share(at['whdr'])} [{share(at['interval'][0])} {share(at['interval'][2])}]" +
                      (f" at {figure(s['best'], 2)}" if name == "at_best" else ""), " / ".join(share(at[g]) for g in GROUPS)]
        rows.append(cells + [share(s["wrong_order"]), share(s["rms"])])
    return tables.table(["", "WHDR, δ = .10 [95 %]", "equal / achromatic / chromatic", "WHDR, best δ [95 %]",
                         "equal / achromatic / chromatic", "wrong order", "rms of equal"], rows)


def wrong_by_picture(pairs):
    counts = sorted(by_picture(pairs, DELTA).items(), key=lambda item: -item[1][0] / item[1][1])
    return "Wrong pairs of `intrinsicdecomp` at δ = .10: " + ", ".join(
        f"{pathlib.Path(name).stem} {wrong} of {total}" for name, (wrong, total) in counts) + ".\n"


def counted(found, all_pairs):
    _, _, groups, _ = zip(*next(iter(all_pairs.values())))
    counts = ", ".join(f"{groups.count(g)} {'' if g == 'equal' else 'unequal '}{g}" for g in GROUPS)
    return f"{len(found['pictures'])} pictures, {len(groups)} pairs: {counts}.\n"


def table(found):
    """All tables: errors of methods and of other settings, and differences between methods."""
    all_pairs = methods(found)
    names = {key: title for key, title in titles(found).items() if key in all_pairs}
    whole, variants = ({k: t for k, t in names.items() if is_variant(t) == v} for v in (False, True))
    ours = next((key for key, title in whole.items() if title == "intrinsicdecomp"), None)
    own = [wrong_by_picture(all_pairs[ours]), differences(all_pairs, whole, ours)] if ours else []
    return "\n".join([counted(found, all_pairs), errors(all_pairs, whole), errors(all_pairs, variants), *own])


def short_table(found):
    """Of each method but smoothing filters, without other settings and groups of pairs."""
    all_pairs, rows = methods(found), []
    for key, title in titles(found).items():
        if key in all_pairs and key[0] not in tables.FILTERS and not is_variant(title):
            s = scores(all_pairs[key])
            rows.append([title, *(f"{share(s[at]['whdr'])} [{share(s[at]['interval'][0])} {share(s[at]['interval'][2])}]" for at in ("at_delta", "at_best")), share(s["rms"])])
    return counted(found, all_pairs) + "\n" + tables.table(["", "WHDR, δ = .10 [95 %]", "WHDR, best δ [95 %]", "rms of equal"], rows)


def parts(found, commit):
    """What pages show, by the names of their lines."""
    return {name: f"Measured at commit {commit}. {text(found)}" for name, text in (("photographs", short_table), ("judged", table))}


def differences(all_pairs, names, ours):
    """Of the default of intrinsicdecomp minus each other method, paired by picture."""
    rows = []
    for key, title in names.items():
        if key == ours:
            continue
        cells = [title]
        for delta_of in (lambda _: DELTA, lambda pairs: scores(pairs)["best"]):
            mine, theirs = (by_picture(all_pairs[k], delta_of(all_pairs[k])) for k in (ours, key))
            low, mean, high = intervals.bootstrap_share([(mine[p][0] - theirs[p][0], mine[p][1]) for p in mine])
            cells.append(tables.bracketed(mean, [low, mean, high], "+", 3))
        rows.append(cells)
    return tables.table(["intrinsicdecomp minus", "WHDR, δ = .10 [95 %]", "WHDR, best δ [95 %]"], rows)


def main(build, folder, *more):
    pages, only = tables.pages_of(more)
    found, options = [], [word for method in only for word in ("--only", method)]
    with tempfile.TemporaryDirectory() as temporary:
        for name in PROGRAMS:
            out = pathlib.Path(temporary) / f"{name}.json"
            subprocess.run([f"{build}/tests/bench/{name}", "--photographs", folder, *options, "--out", out], check=True)
            found.append(json.loads(out.read_text()))
    for failure in [f for one in found for f in one["failures"]]:
        print(failure, file=sys.stderr)
    commit = subprocess.run(["git", "describe", "--always", "--dirty"], stdout=subprocess.PIPE, text=True).stdout.strip()
    text = parts(joined(found), commit)
    print("\n".join(text.values()))
    tables.insert(pages, text)


if __name__ == "__main__":
    main(*sys.argv[1:])

# SPDX-License-Identifier: LGPL-2.1-or-later
"""Measures of reflectance on photographs. A `method` is a function of methods.py."""
import collections
import json
import pathlib

import cv2
import numpy as np
from added import reduced
from methods import linear

DARK = 2e-3  # of linear light, added before logarithms
DELTA = 0.1  # of Bell et al. (2014): reflectances that differ by less are called equal
DELTAS = [k / 100 for k in range(5, 51)]
SERIES_SIZE = 320  # of the longer side


def logs(picture):
    return np.log(picture.mean(2) + DARK)


def shares(method, cases):
    """{kind: the share of what was added that is in reflectance, by case}: the slope of the change of ln R by the added ln ratio. 0 is right for
    light, 1 for paint."""
    found = collections.defaultdict(list)
    for case in cases:
        change = (logs(method(case.after)) - logs(method(case.before)))[case.usable]
        added = case.ratio[case.usable]
        added = added - added.mean()
        found[case.kind].append(float((added * change).sum() / (added * added).sum()))
    return dict(found)


def confusion(found):
    """0: all light in shading and all paint in reflectance; .5: what does not ask has this."""
    return (np.mean(found["light"]) + 1 - np.mean(found["paint"])) / 2


def pictures(folder, size):
    files = sorted(f for f in pathlib.Path(folder).iterdir() if f.suffix.lower() in (".jpg", ".jpeg", ".png") and "mask" not in f.name)
    return [reduced(cv2.imread(str(f)), size) for f in files]


def constancy(method, folder):
    """(change, contrast) of one scene under several lights: rms change of ln R between two pictures over that of ln I, means removed; standard
    deviation of the series' mean ln R over that of its mean ln I. Their ratio is the index: 1 for R = I, 0 is right."""
    series = pictures(folder, SERIES_SIZE)
    usable = np.all([(p.max(2) < 250) & (p.min(2) > 8) for p in series], 0)
    lights, paints = ([logs(f(p))[usable] for p in series] for f in (linear, method))
    pairs = [(a, b) for a in range(len(series)) for b in range(a)]
    change = np.mean([(paints[a] - paints[b]).std() / (lights[a] - lights[b]).std() for a, b in pairs])
    return float(change), float(np.mean(paints, 0).std() / np.mean(lights, 0).std())


def patch(plane, pair, which):
    """3 x 3 pixels of a point of a judged pair."""
    x, y = pair[f"x{which}"], pair[f"y{which}"]
    return plane[y - 1 : y + 2, x - 1 : x + 2]


def judged(folder):
    """(picture, its pairs) of a folder with pairs.json."""
    for name, pairs in json.loads((pathlib.Path(folder) / "pairs.json").read_text()).items():
        yield cv2.imread(str(pathlib.Path(folder) / name)), pairs


def ratios(method, folder):
    """[(judged darker: 1, 2 or E for equal; ratio of reflectance)] of all pairs, and the standard deviation of chroma over the picture's, a mean:
    of ln R and ln I less their means over channels."""
    found, spreads = [], []
    for picture, pairs in judged(folder):
        reflectance = method(picture)
        found += [(p["darker"], max(patch(reflectance, p, 1).mean(), 1e-5) / max(patch(reflectance, p, 2).mean(), 1e-5)) for p in pairs]
        spread = [np.log(x + DARK) - np.log(x + DARK).mean(2, keepdims=True) for x in (reflectance, linear(picture))]
        of_r, of_i = (np.sqrt((s - s.mean((0, 1))).var((0, 1)).sum()) for s in spread)
        if of_i > 0.02:  # of a picture in color
            spreads.append(of_r / of_i)
    return found, float(np.mean(spreads))


def whdr(pairs, delta):
    """The share of pairs that are judged otherwise (weighted human disagreement rate of Bell et al. 2014, all weights 1)."""
    said = ["1" if 1 / ratio > 1 + delta else "2" if ratio > 1 + delta else "E" for _, ratio in pairs]
    return float(np.mean([s != darker for s, (darker, _) in zip(said, pairs)]))


def area_under_curve(pairs):
    """Of telling unequal pairs from equal ones by |ln ratio|: the share of (unequal, equal) whose unequal one is apart by more; .5 is chance."""
    apart = np.array([abs(np.log(ratio)) for _, ratio in pairs])
    equal = np.array([darker == "E" for darker, _ in pairs])
    above = apart[~equal][:, None] - apart[equal][None]
    return float(np.mean((above > 0) + 0.5 * (above == 0)))

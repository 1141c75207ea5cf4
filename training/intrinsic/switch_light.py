#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The change of reflectance when a light is switched off, on held-out samples (every fifth seed) with two lights or more.

    switch_light.py FOLDER [--element intrinsicdecomp] [--shots 1]

In each shot of 80 frames the light that gives nearest to half of the light goes out in frame 40. Prints the change of the picture, and of
reflectance from frames 30 … 39 to frames 70 … 79, with the slope of light found and with gray light: the deviation over the points of
ln brightness (without its mean, which is the output's scale) and of ln R/B, and the mean of ln R/B; all are 0 in the truth. Frames are equal
here and differ by noise in a camera, so nothing is reused (adaptive=false). Needs what score.py needs."""
import collections

import gi

gi.require_version("Gst", "1.0")
from gi.repository import Gst
import numpy as np

import mix
import sample as samples
import score

FRAMES, BEFORE, AFTER = 80, slice(30, 40), slice(70, 80)
DARK = 0.02  # least linear value of a point that counts


def shot(sample, seed):
    """A picture with all lights and one without one of them, 8-bit, and the points that both show; None if the sample has one light."""
    rng = np.random.default_rng([seed, sample["meta"]["seed"]])
    kinds = [g["kind"] for g in sample["meta"]["groups"]]
    if len(kinds) < 2:
        return None
    color, _ = mix.colors(kinds, rng)
    light = np.exp(rng.uniform(np.log(0.3), 0, len(kinds)))[:, None, None, None] * color[:, None, None] * sample["S"]
    light *= np.exp(-np.log(color).mean(0))
    mask = sample["mask"] > 0
    means = light[:, mask].mean((1, 2))
    out = int(np.argmin(np.abs(means / means.sum() - 0.5)))
    both = sample["R"] * light.sum(0)
    exposure = 0.85 / np.percentile(both.max(-1)[mask], 98)
    rest = (both - sample["R"] * light[out]) * exposure
    both *= exposure
    seen = mask & (both.max(-1) < 1) & (rest.min(-1) > DARK)
    pictures = [mix.photograph(p, np.random.default_rng(seed)) for p in (both, rest)]
    return (*pictures, seen) if seen.mean() > 0.2 else None


def change(before, after, seen):
    """Of points: deviation of the change of ln brightness and of ln R/B, and mean of the latter."""
    a, b = (np.log(np.maximum(x, 1e-4)) for x in (before, after))
    brightness, warmth = (b - a).mean(-1)[seen], ((b - a)[..., 0] - (b - a)[..., 2])[seen]
    return brightness.std(), warmth.std(), warmth.mean()


def main():
    parser = score.options(__doc__)
    parser.add_argument("--shots", type=int, default=1, help="of each sample")
    args = parser.parse_args()
    Gst.init(None)
    rows = collections.defaultdict(list)
    for scene in samples.held_out_of(args.folder):
        for seed in range(args.shots):
            found = shot(scene, seed)
            if found is None:
                continue
            before, after, seen = found
            rows["picture"].append(change(mix.linear(before / 255), mix.linear(after / 255), seen))
            for name, slope in (("found", "auto"), ("gray", 0)):
                frames = [before] * (FRAMES // 2) + [after] * (FRAMES // 2)
                r, _ = score.reflectances(frames, f"{args.element} adaptive=false", slope)
                rows[name].append(change(np.mean(r[BEFORE], 0), np.mean(r[AFTER], 0), seen))
    print("shots, deviation of ln brightness, deviation of ln R/B, |mean ln R/B|")
    for name, of in rows.items():
        print(f"{name:8} {len(of):4} " + " ".join(f"{v:.4f}" for v in np.abs(of).mean(0)))


if __name__ == "__main__":
    main()

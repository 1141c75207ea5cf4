#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A contact sheet: for each sample three mixtures, R, and the shading of the first mixture: sheet.py OUT.png FILE.npz…
With --slopes it prints how the slopes of the mixtures are distributed."""
import argparse

import cv2
import numpy as np

import mix
import sample as samples


def tile(picture, height=176):
    """Fits a picture of either orientation into one frame."""
    width = height * 4 // 3
    scale = min(height / picture.shape[0], width / picture.shape[1])
    small = cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    frame = np.full((height, width, 3), 0.1, np.float32)
    frame[: small.shape[0], : small.shape[1]] = small[:height, :width]
    return frame


def row(sample):
    mixtures = [mix.mix(sample, seed) for seed in range(3)]
    light = mixtures[0]["E"]
    shown = light / np.percentile(light[sample["mask"] > 0], 96)
    tiles = []
    for m in mixtures:
        frame = tile(m["image"] / np.float32(255))
        cv2.putText(frame, f"k {m['k']:+.2f}", (4, 170), cv2.FONT_HERSHEY_SIMPLEX, 0.45, (1, 1, 0), 1)
        tiles.append(frame)
    return np.concatenate([*tiles, tile(mix.srgb(sample["R"]).astype(np.float32)), tile(mix.srgb(shown).astype(np.float32))], 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out")
    parser.add_argument("files", nargs="+")
    parser.add_argument("--columns", type=int, default=1)
    parser.add_argument("--slopes", action="store_true")
    args = parser.parse_args()
    read = [samples.read(f) for f in args.files]
    rows = [row(s) for s in read]
    while len(rows) % args.columns:
        rows.append(np.zeros_like(rows[0]))
    grid = np.concatenate([np.concatenate(rows[i :: args.columns]) for i in range(args.columns)], 1)
    cv2.imwrite(args.out, np.round(255 * grid[..., ::-1]))
    if args.slopes:
        for kind in sorted({s["meta"]["kind"] for s in read}):
            found = [s for s in read if s["meta"]["kind"] == kind]
            slopes = [mix.mix(s, seed, 2) for s in found for seed in range(8)]
            print(
                f"{kind:7} {len(found):4} scenes, k at 5 25 50 75 95 %:",
                *(f"{v:+.2f}" for v in np.percentile([m["k"] for m in slopes], [5, 25, 50, 75, 95])),
                *(f"| {n} {np.median([m[n] for m in slopes]):.2f}" for n in ("m_rms", "axis", "g")),
            )


if __name__ == "__main__":
    main()

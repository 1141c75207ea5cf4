#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Steadiness of reflectance on real clips, which have no ground truth: what one surface point changes by over time.

    ./dev shell -c 'tests/bench/report/real_clips.py [--frames 130] [--size 480x270] --clips CLIP … --elements "intrinsicdecomp" NETWORK.onnx …'

A network is one that estimates reflectance (docs/reference/networks.md), run by OpenCV on each frame by itself.

Prints a table: rms change of ln R from frame to frame along dense optical flow (DIS), and over 60 frames along tracked points (Lucas and
Kanade), the median over points (all of the picture brightens or darkens) and the rms about it; mean over the clip. The input's own changes
are beside them; a dash where a clip is too short or too few points last. Contrast is the standard deviation of ln R inside of a frame, mean
over the clip: changes grow with it, and reflectance without any contrast never changes. R is the mean channel; points below .5 % of full scale
do not count.
Needs python3-opencv."""
import argparse
import pathlib
import subprocess
import tempfile

import cv2
import numpy as np

SPAN, EVERY = 60, 10  # frames that points are tracked over; between new points
DARK = 0.005
MIN_POINTS = 15


def linear(codes):
    x = codes / 255.0
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


def estimated(network, frame):
    """The reflectance that a network makes of a frame of at most 256 pixels a side, enlarged again."""
    height, width = frame.shape[:2]
    scale = 1 << max(0, int(np.ceil(np.log2(max(height, width) / 256))))
    small = (-(-width // scale), -(-height // scale))
    image = cv2.resize(frame, small, interpolation=cv2.INTER_AREA).astype(np.float32) / 255
    image = np.pad(image, ((0, -small[1] % 16), (0, -small[0] % 16), (0, 0)), mode="edge")
    network.setInput(np.ascontiguousarray(np.moveaxis(image, -1, 0)[None]))
    found = np.moveaxis(network.forward()[0], 0, -1)[: small[1], : small[0]]
    return cv2.resize(found, (width, height), interpolation=cv2.INTER_LINEAR)


def run(clip, size, count, element):
    """The clip's frames, 8 bits, and the reflectance of an element or a network, linear."""
    network = cv2.dnn.readNetFromONNX(element) if element.endswith(".onnx") else None
    width, height = size
    with tempfile.TemporaryDirectory() as folder:
        line = (
            f"filesrc location={clip} ! decodebin ! videoconvert ! videoscale add-borders=false ! video/x-raw,format=RGBA,width={width},"
            f"height={height},pixel-aspect-ratio=1/1 ! identity eos-after={count + 1} ! tee name=t ! queue ! filesink location={folder}/input"
        )
        if not network:
            line += (
                f" t. ! queue ! {element} ! intrinsicsplit name=s encoding=linear reflectance-scale=0.5 s.reflectance ! queue ! "
                f"video/x-raw,format=RGBA64_LE ! filesink location={folder}/reflectance"
            )
        subprocess.run(f"gst-launch-1.0 -q {line}", shell=True, check=True, timeout=600, stdout=subprocess.DEVNULL)
        frames = np.fromfile(f"{folder}/input", np.uint8).reshape(-1, height, width, 4)[..., :3]
        if network:
            return frames, np.array([estimated(network, frame) for frame in frames])
        reflectance = np.fromfile(f"{folder}/reflectance", "<u2").reshape(-1, height, width, 4)[..., :3] / (65535 * 0.5)
    n = min(len(frames), len(reflectance))
    return frames[:n], reflectance[:n]


def brightness(linear_picture):
    """Log of the mean channel, over 5 × 5 pixels."""
    return cv2.blur(np.log(linear_picture.mean(2) + 2e-3), (5, 5)).astype(np.float32)


def flow_changes(gray, planes, lit):
    """Rms change between consecutive frames of each list of planes along the flow, where it is consistent both ways."""
    flow = cv2.DISOpticalFlow_create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)
    grid = np.stack(np.meshgrid(np.arange(gray[0].shape[1]), np.arange(gray[0].shape[0])), -1).astype(np.float32)
    squares, count = np.zeros(len(planes)), 0
    for k in range(1, len(gray)):
        back, forth = flow.calc(gray[k], gray[k - 1], None), flow.calc(gray[k - 1], gray[k], None)
        there = grid + back

        def moved(x):
            return cv2.remap(x, there, None, cv2.INTER_LINEAR)

        inside = ((there >= 0) & (there <= np.array(gray[0].shape[::-1]) - 1)).all(-1)
        same = inside & (np.hypot(*np.moveaxis(back + moved(forth), -1, 0)) < 0.5) & lit[k] & lit[k - 1]
        count += same.sum()
        squares += [((of[k] - moved(of[k - 1]))[same] ** 2).sum() for of in planes]
    return np.sqrt(squares / max(count, 1))


def contrast(planes, lit):
    return np.mean([of[good].std() for of, good in zip(planes, lit)])


def tracked(gray, first):
    """Points of a frame where they are SPAN frames later: (before, after), those that are found again both ways."""
    start = cv2.goodFeaturesToTrack(gray[first], 400, 0.005, 8)
    if start is None:
        return np.zeros((0, 2)), np.zeros((0, 2))
    start = points = start.reshape(-1, 2)
    bounds = np.array(gray[0].shape[::-1]) - 5
    options = {"winSize": (15, 15), "maxLevel": 3}
    for k in range(first + 1, first + SPAN + 1):
        if not len(points):
            break
        there, found, _ = cv2.calcOpticalFlowPyrLK(gray[k - 1], gray[k], points[:, None], None, **options)
        again, found_again, _ = cv2.calcOpticalFlowPyrLK(gray[k], gray[k - 1], there, None, **options)
        there, again = there[:, 0], again[:, 0]
        good = (found[:, 0] & found_again[:, 0] > 0) & (np.hypot(*(again - points).T) < 0.4) & ((there > 4) & (there < bounds)).all(1)
        start, points = start[good], there[good]
    return start, points


def span_changes(gray, planes, lit):
    """Over SPAN frames, for each list of planes: |median over points|, and rms about it; means over the clip."""
    common, rest = [[] for _ in planes], [[] for _ in planes]
    for first in range(5, len(gray) - SPAN, EVERY):
        before, after = (np.rint(p).astype(int) for p in tracked(gray, first))
        seen = lit[first][before[:, 1], before[:, 0]] & lit[first + SPAN][after[:, 1], after[:, 0]]
        before, after = before[seen], after[seen]
        if len(before) < MIN_POINTS:
            continue
        for n, of in enumerate(planes):
            d = of[first + SPAN][after[:, 1], after[:, 0]] - of[first][before[:, 1], before[:, 0]]
            common[n].append(abs(np.median(d)))
            rest[n].append(np.sqrt(np.mean((d - np.median(d)) ** 2)))
    return [(np.mean(c) if c else np.nan, np.mean(r) if r else np.nan) for c, r in zip(common, rest)]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=130)
    parser.add_argument("--size", default="480x270")
    parser.add_argument("--clips", nargs="+", type=pathlib.Path, required=True)
    parser.add_argument("--elements", nargs="+", default=["intrinsicdecomp"])
    args = parser.parse_args()
    size = tuple(int(n) for n in args.size.split("x"))
    print("| clip | element | frame to frame: ln R (input) | 60 frames, all: ln R (input) | about that: ln R (input) | contrast: ln R (input) |\n|---|---|---|---|---|---|")
    for clip in args.clips:
        planes = []
        for element in args.elements:
            frames, reflectance = run(clip, size, args.frames, element)
            planes.append([brightness(r) for r in reflectance])
        planes.append([brightness(linear(f)) for f in frames])
        count = min(len(of) for of in planes)  # a run may end a frame early
        planes, frames = [of[:count] for of in planes], frames[:count]
        gray = [cv2.cvtColor(f, cv2.COLOR_RGB2GRAY) for f in frames]
        lit = [linear(f).mean(2) > DARK for f in frames]
        # Points move alike for all elements: they are found once.
        *changes, own = [
            (step, *span, contrast(of, lit))
            for step, span, of in zip(flow_changes(gray, planes, lit), span_changes(gray, planes, lit), planes)
        ]
        for element, change in zip(args.elements, changes):
            cells = " | ".join("–" if np.isnan(a) else f"{a:.4f} ({b:.4f})" for a, b in zip(change, own))
            print(f"| {clip.stem} | {element} | {cells} |", flush=True)


if __name__ == "__main__":
    main()

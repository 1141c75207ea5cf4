#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Scores the reflectance of an element on held-out samples (every fifth seed), with the slope of light found, given, and with gray light.

    score.py FOLDER [--element intrinsicdecomp] [--mixtures 2]

Prints by kind of scene: LMSE of reflectance (Grosse et al. 2009, windows of 20 pixels), WHDR (Bell et al. 2014, δ = .1) over pairs of
which a third has one paint, rms error of log reflectance, and of the slope. "several slopes" are photographs whose light no one slope
describes: it leaves more than .15 (rms) of ln R/B of the light. "not bent" are those with the slope of their lights (mix.py). Needs
python3-gi and GST_PLUGIN_PATH, INVERSE_MODELS."""
import argparse
import collections
import pathlib

import gi

gi.require_version("Gst", "1.0")
from gi.repository import Gst
import numpy as np

import mix
import sample as samples

DELTA, PAIRS, WINDOW = 0.1, 120, 20
MAX_SLOPE, SEVERAL = 2.0, 0.15


def reflectances(pictures, element, slope):
    """Linear reflectance of the 8-bit RGB frames of a shot, and the slope in force in the last one. slope: a number or "auto"."""
    height, width = pictures[0].shape[:2]
    caps = f"video/x-raw,format=RGBA,width={width},height={height},framerate=0/1"
    pipeline = Gst.parse_launch(
        f"appsrc name=in format=time caps={caps} ! {element} name=method light-color-slope={slope} ! intrinsicsplit name=split encoding=linear "
        "split.reflectance ! queue ! video/x-raw,format=RGBA64_LE ! appsink name=out sync=false"
    )
    pipeline.set_state(Gst.State.PLAYING)
    try:
        source, sink = pipeline.get_by_name("in"), pipeline.get_by_name("out")
        for picture in pictures:
            rgba = np.concatenate([picture, np.full((height, width, 1), 255, np.uint8)], -1)
            source.emit("push-buffer", Gst.Buffer.new_wrapped(rgba.tobytes()))
        source.emit("end-of-stream")
        found = []
        for _ in pictures:
            pulled = sink.emit("pull-sample")
            if pulled is None:
                error = pipeline.get_bus().pop_filtered(Gst.MessageType.ERROR)
                raise RuntimeError(error.parse_error()[0].message if error else "no frame")
            buffer = pulled.get_buffer()
            data = np.frombuffer(buffer.extract_dup(0, buffer.get_size()), "<u2").reshape(height, width, 4)
            found.append(data[..., :3] / 65535.0)
        pipeline.get_bus().timed_pop_filtered(10 * Gst.SECOND, Gst.MessageType.EOS)  # stats are of completed frames
        ok, slope = pipeline.get_by_name("method").get_property("stats").get_double("light-color-slope")
        return found, slope if ok else 0.0
    finally:
        pipeline.set_state(Gst.State.NULL)


def lmse(found, truth, mask):
    """Local scale-invariant error: 0 is perfect, 1 as black."""
    error = energy = 0.0
    half = WINDOW // 2
    for y in range(0, len(mask) - WINDOW + 1, half):
        for x in range(0, mask.shape[1] - WINDOW + 1, half):
            inside = mask[y : y + WINDOW, x : x + WINDOW] > 0
            a, b = found[y : y + WINDOW, x : x + WINDOW][inside], truth[y : y + WINDOW, x : x + WINDOW][inside]
            scale = (a * b).sum() / max((a * a).sum(), 1e-12)
            error += ((b - scale * a) ** 2).sum()
            energy += (b * b).sum()
    return error / max(energy, 1e-12)


def pairs_of(truth, mask, seed):
    """Two lists of pixels (indices into the flat picture), and 1, 2 or 0 if the first, the second or none is darker."""
    rng, points = np.random.default_rng(seed), np.flatnonzero(mask)
    i, j = rng.choice(points, 100 * PAIRS), rng.choice(points, 100 * PAIRS)
    flat = truth.reshape(-1, 3)
    ratio = np.log(flat.mean(1)[i] / flat.mean(1)[j])
    colors = np.log(flat / flat.mean(1, keepdims=True))
    same = (np.abs(ratio) < 0.04) & (np.abs(colors[i] - colors[j]).max(1) < 0.05)
    chosen = np.concatenate([np.flatnonzero(same)[: PAIRS // 3], np.flatnonzero(np.abs(ratio) > 0.2)[: 2 * PAIRS // 3]])
    return i[chosen], j[chosen], np.where(same, 0, np.where(ratio > 0, 2, 1))[chosen]


def errors(found, truth, mask, pairs):
    good = mask > 0
    i, j, darker = pairs
    bright = np.maximum(found.mean(-1).ravel(), 1e-5)
    ratio = bright[i] / bright[j]
    judged = np.where(ratio > 1 + DELTA, 2, np.where(1 / ratio > 1 + DELTA, 1, 0))
    d = np.log(np.maximum(found.mean(-1), 1e-4) / truth.mean(-1))[good]
    return {"LMSE": lmse(found, truth, mask), "WHDR": np.mean(judged != darker), "rms ln R": d.std()}


def options(description):
    """A parser of what is measured on which samples."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="of SEED.npz")
    parser.add_argument("--element", default="intrinsicdecomp")
    return parser


def main():
    parser = options(__doc__)
    parser.add_argument("--mixtures", type=int, default=2, help="photographs of each sample")
    args = parser.parse_args()
    Gst.init(None)
    rows = collections.defaultdict(list)
    for scene in samples.held_out_of(args.folder):
        for seed in range(args.mixtures):
            m = mix.mix(scene, 1000 + seed)
            pairs = pairs_of(m["R"], m["mask"], seed)
            true = float(np.clip(m["k"], -MAX_SLOPE, MAX_SLOPE))
            for name, slope in (("found", "auto"), ("given", true), ("gray", 0)):
                (found,), k = reflectances([m["image"]], args.element, slope)
                row = {**errors(found, m["R"], m["mask"], pairs), "k": k - true}
                for kind in (scene["meta"]["kind"], "all", *["several slopes"] * (m["axis"] > SEVERAL), *["not bent"] * (not m["bent"])):
                    rows[kind, name].append(row)
    print("kind, slope: photographs, LMSE, WHDR, rms ln R, rms error of slope")
    for (kind, name), of in sorted(rows.items()):
        means = [np.mean([r[n] for r in of]) for n in ("LMSE", "WHDR", "rms ln R")]
        print(f"{kind:14} {name:6} {len(of):4} " + " ".join(f"{v:.4f}" for v in [*means, np.sqrt(np.mean([r['k'] ** 2 for r in of]))]))


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: LGPL-2.1-or-later
"""A sample: one scene under each of its lights. R S = I holds for every light by itself, so for every mixture.

    R     height × width × 3   reflectance, linear RGB
    S     lights × height × width × 3   radiance over reflectance under each light, bounces included; each light white, mean 1
    N, Z  height × width (× 3)  normals in world coordinates (z up); depth in meters
    mask  height × width       1 where R and S are true; elsewhere sky, panes and lamps: R is 1 and S what is seen
"""
import json
import os
import pathlib
import time

import numpy as np

import exr
from denoise import Denoiser

HELD_OUT = 5
NOISIEST = 0.25  # of a light that is kept
DARKEST = 0.015  # below this, R is not divided by


class Rejected(Exception):
    """The picture is not used for training; the message says why."""


def name_of(seed, view):
    """The number of a sample: its scene's seed, and a million more for each further camera. HELD_OUT divides a million, so that all
    cameras of a scene are fitted, or none."""
    return seed + 1_000_000 * view


def held_out(path):
    """Whether the sample SEED.npz is in no fit: every fifth seed is not."""
    return int(path.stem) % HELD_OUT == 0


def halve(x):
    """Means of 2 × 2 pixels."""
    return 0.25 * (x[0::2, 0::2] + x[1::2, 0::2] + x[0::2, 1::2] + x[1::2, 1::2])


def halves_of(folder):
    """The means of {a,b}*.exr."""
    result = []
    for letter in "ab":
        rounds = [exr.passes(f) for f in sorted(pathlib.Path(folder).glob(f"{letter}*.exr"))]
        result.append({k: sum(r[k] for r in rounds) / len(rounds) for k in rounds[0]})
    return result


def surfaces(halves):
    """Where all of a pixel is surface: height × width."""
    direct = sum(h["Emit"] + h["Env"] for h in halves).max(-1)
    return (direct < 1e-6) & (np.minimum(*[h["DiffCol"] for h in halves]).min(-1) > DARKEST)


def shading_of(halves, group, valid):
    """Both halves of a light's radiance over reflectance (radiance where not valid), and the noise of means of 2 × 2 pixels of
    their mean, relative, where this light is bright: 1 if it is nowhere."""
    name = f"Combined_{group}"
    pair = [np.where(valid[..., None], h[name] / np.maximum(h["DiffCol"], DARKEST), h[name]) for h in halves]
    scale = sum(pair)[valid].mean() / 2 if valid.any() else 0
    if scale < 1e-6:
        return pair, 1.0
    small = [halve(p).mean(-1) for p in pair]
    lit = (halve(valid.astype(float)) == 1) & (small[0] + small[1] > scale)
    return pair, float(np.median((np.abs(small[0] - small[1]) / np.maximum(small[0] + small[1], 1e-9))[lit]) * 1.48) if lit.any() else 1.0


def from_renderings(folder):
    """Reads what scene/build.py wrote. Raises Rejected, and ValueError if passes contradict each other."""
    meta = json.loads((pathlib.Path(folder) / "scene.json").read_text())
    halves = halves_of(folder)
    valid = surfaces(halves)
    for h in halves:
        total = sum(h[f"Combined_{g['name']}"] for g in meta["groups"])
        off = np.abs(total - h["Combined"]).max(-1)[valid] / (1e-3 + h["Combined"].max(-1)[valid])
        if len(off) and off.max() > 2e-3:
            raise ValueError(f"seed {meta['seed']}: light groups do not add up to the picture, by {off.max():.1e}")
        if not all(np.isfinite(v).all() for v in h.values()):
            raise ValueError(f"seed {meta['seed']}: not finite")
    reflectance = np.where(valid[..., None], sum(h["DiffCol"] for h in halves) / 2, 1).astype(np.float32)
    normal = sum(h["Normal"] for h in halves) / 2
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-6)
    depth = np.minimum(*[h["Depth"] for h in halves])
    shading, groups, denoise = [], [], Denoiser(normal, depth)
    for group in meta["groups"]:
        pair, noise = shading_of(halves, group["name"], valid)
        if noise > NOISIEST:
            continue  # leaving a light out keeps R S = I
        mean = sum(pair) / 2
        scale = mean[valid].mean()
        s = np.where(valid[..., None], denoise(*pair), np.minimum(mean, 60 * scale)) / scale
        shading.append(s.astype(np.float32))
        groups.append({**group, "noise": noise})
    meta["groups"] = groups
    sample = {
        "R": reflectance,
        "S": np.stack(shading) if shading else np.zeros((0, *reflectance.shape)),
        "N": normal,
        "Z": np.minimum(depth, 6e4),
        "mask": valid.astype(np.uint8),
        "meta": meta,
    }
    judge(sample)
    return sample


def judge(sample):
    """Raises Rejected for what teaches nothing."""
    valid, s = sample["mask"] > 0, sample["S"]
    if valid.mean() < 0.6:
        raise Rejected(f"only {valid.mean():.0%} of the picture is surface")
    if len(s) < 1:
        raise Rejected("no light")
    total = s.sum(0).mean(-1)[valid]
    dark = (total < 0.03 * np.percentile(total, 95)).mean()
    if dark > 0.35:
        raise Rejected(f"{dark:.0%} is dark")
    spread = np.log(sample["R"][valid]).std(0).mean()
    if spread < 0.07:
        raise Rejected(f"nearly one paint (rms of ln R {spread:.2f})")


def write(path, sample):
    """Compressed, half precision, in one step."""
    path = pathlib.Path(path)
    part = path.with_suffix(".part")
    with open(part, "wb") as file:
        np.savez_compressed(
            file,
            R=sample["R"].astype(np.float16),
            S=np.minimum(sample["S"], 6e4).astype(np.float16),
            N=sample["N"].astype(np.float16),
            Z=sample["Z"].astype(np.float16),
            mask=sample["mask"].astype(np.uint8),
            meta=np.array(json.dumps(sample["meta"])),
        )
    os.replace(part, path)


def kind(path):
    """Its kind of scene."""
    with np.load(path) as file:
        return json.loads(str(file["meta"]))["kind"]


def read(path):
    """The sample as float32, its metadata as a dict."""
    with np.load(path) as file:
        sample = {k: file[k].astype(np.float32) for k in ("R", "S", "N", "Z")}
        return {**sample, "mask": file["mask"], "meta": json.loads(str(file["meta"]))}


def held_out_of(folder):
    """The samples of a folder that are in no fit, by seed."""
    for path in sorted(folder.glob("*.npz"), key=lambda p: int(p.stem)):
        if held_out(path):
            yield read(path)


def take(folder, out, start):
    """The sample of one camera's renderings to OUT/NUMBER.npz, or OUT/NUMBER.rejected with the reason. `start`: of the scene, in this
    process's seconds. Returns what happened."""
    number = json.loads((folder / "scene.json").read_text())["seed"]
    try:
        result = from_renderings(folder)
        meta = result["meta"]
        meta["seconds"] = round(time.process_time() - start, 1)  # since the scene's start
        write(out / f"{number}.npz", result)
        return f"{number} {meta['kind']} {meta['seconds']} s, {meta['samples']} samples, noise {' '.join('%s %.3f' % (g['kind'], g['noise']) for g in meta['groups'])}"
    except (Rejected, ValueError) as error:
        return reject(out, number, start, error)


def reject(out, number, start, error):
    (out / f"{number}.rejected").write_text(json.dumps({"seed": number, "reason": str(error)}))
    return f"{number} rejected after {time.process_time() - start:.0f} s: {error}"

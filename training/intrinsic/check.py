#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Sanity of samples, mixtures and the reader, in seconds and without Blender: check.py. Prints what it measured, and stops at
what is off. check.py FOLDER checks the samples there as well."""
import argparse
import os
import pathlib
import struct
import subprocess
import sys
import tempfile

import numpy as np

import denoise
import exr
import flat
import mix
import render
import retexture
import sample as samples


def expect(ok, text):
    print(("ok    " if ok else "WRONG ") + text)
    if not ok:
        raise SystemExit(1)


def synthetic(seed=0, size=(66, 88)):
    """Patches of paint; a sun that half of the picture's pixels see, and a sky."""
    rng = np.random.default_rng(seed)
    patches = rng.uniform(0.05, 0.9, (size[0] // 11, size[1] // 11, 3)).repeat(11, 0).repeat(11, 1)
    lit = np.zeros(size)
    lit[:, : size[1] // 2] = 1
    shading = np.stack([np.repeat(s[..., None], 3, 2) for s in (2 * lit, np.ones(size))])
    groups = [{"name": "sun0", "kind": "sun", "noise": 0}, {"name": "sky1", "kind": "sky", "noise": 0}]
    return {
        "R": patches.astype(np.float32),
        "S": shading.astype(np.float32),
        "N": np.zeros((*size, 3), np.float32),
        "Z": np.ones(size, np.float32),
        "mask": np.ones(size, np.uint8),
        "meta": {"seed": seed, "kind": "yard", "groups": groups},
    }


def check_colors():
    error = np.abs(mix.planck(6504) - [1.03, 1, 1.05]).max()
    expect(error < 0.05, f"a black body of 6504 K is nearly white ({error:.3f})")
    ratios = [np.log(c[0] / c[2]) for c in map(mix.planck, (2700, 4500, 6500, 15000))]
    expect(np.all(np.diff(ratios) < 0) and ratios[0] > 2, f"ln R - ln B falls with temperature: {np.round(ratios, 2)}")


def check_slope():
    """A line by construction, and two lights of which one is hidden in half of the picture."""
    rng = np.random.default_rng(1)
    s, weight = rng.normal(0, 0.6, (40, 50)), np.ones((40, 50))
    for k in (-1.2, 0, 0.7):
        found = mix.slope(np.exp((1 + k * mix.AXIS) * s[..., None]), weight)
        expect(abs(found["k"] - k) < 1e-5 and found["axis"] < 1e-5 and found["g"] < 1e-5, f"slope {k} is found: {found['k']:.5f}")
    sun, sky = 2 * mix.planck(5000), 0.7 * mix.planck(12000)
    light = np.stack([sun + sky, sky])[np.arange(2000).reshape(40, 50) % 2]
    b, m = (np.log((sun + sky)[0] / (sun + sky)[2]) - np.log(sky[0] / sky[2])), (np.log(sun + sky) - np.log(sky)).mean()
    found = mix.slope(light, weight)
    expect(abs(found["k"] - b / m) < 1e-5, f"sun and sky, one hidden: {found['k']:.4f}, closed form {b / m:.4f}")
    light = np.exp(rng.normal(0, 0.4, (40, 50, 3)))
    before = mix.slope(light, weight)
    for k in (-1.0, 0.5):
        after = mix.slope(mix.with_slope(light, weight, k), weight)
        off = max(abs(after["k"] - k), abs(after["axis"] - before["axis"]), abs(after["g"] - before["g"]), abs(after["m_rms"] - before["m_rms"]))
        expect(off < 1e-4, f"light that is bent to slope {k} has it, and all else stays ({off:.0e})")


def check_mixture():
    s = synthetic()
    for seed in range(40):
        m = mix.mix(s, seed, 2)
        picture = m["R"] * m["E"]
        good = (m["weight"] > 0) & (picture.min(-1) > 0.1) & (picture.max(-1) < 0.9)
        ratio = np.abs(np.log(m["I"][good] / picture[good]))
        if not (good.any() and np.median(ratio) < 0.1 and all(np.isfinite(m[n]).all() for n in ("I", "R", "E", "k"))):
            expect(False, f"mixture {seed}: I is R E up to noise ({np.median(ratio):.3f})")
    expect(True, "40 mixtures: I is R E up to blur, noise and rounding")
    slopes = np.array([mix.mix(s, seed)["k"] for seed in range(200)])
    gray = np.mean(np.abs(slopes) < 0.02)
    expect(0.03 < gray < 0.4, f"{gray:.0%} of the mixtures have gray light")
    expect(np.median(slopes[np.abs(slopes) > 0.02]) > 0.1, "under sun and sky shadows are bluer")
    again = mix.mix(s, 7), mix.mix(s, 7)
    expect(np.array_equal(again[0]["image"], again[1]["image"]), "a seed gives one picture")
    bent = [m for m in (mix.mix(s, seed, 2, k=-0.8) for seed in range(9)) if m["m_rms"] > 0.05]
    off = max(abs(mix.slope(m["E"], m["mask"].astype(float))["k"] + 0.8) for m in bent)
    expect(off < 1e-3, f"{len(bent)} mixtures of a given slope ({off:.0e})")


def check_weather():
    """A wall that goes off to 500 m under a strip of sky."""
    s = synthetic(3)
    s["Z"] = np.tile(np.linspace(2, 500, s["Z"].shape[1], dtype=np.float32), (s["Z"].shape[0], 1))
    s["Z"][:8], s["mask"][:8], s["R"][:8] = 6e4, 0, 1
    hazy, worst = 0, 0.0
    for seed in range(40):
        m = mix.mix(s, seed)
        kept = m["mask"][8:].mean()
        hazy += kept < 1
        near = (m["weight"] > 0) & (m["I"].min(-1) > 0.1) & (m["I"].max(-1) < 0.9)
        worst = max(worst, np.median(np.abs(np.log(m["I"][near] / (m["R"] * m["E"])[near]))) if near.any() else 0)
        if kept < 0.45:
            expect(False, f"picture {seed} keeps {kept:.0%} of its surfaces")
    expect(5 < hazy < 35 and worst < 0.12, f"{hazy} of 40 pictures have haze; where it is thin I is R E ({worst:.3f})")


def check_camera():
    s = synthetic(4)
    worst, contrasts, seen = [], [], []
    for seed in range(60):
        plain, m = mix.mix(s, seed), mix.mix(s, seed, camera=seed)
        if np.log(m["R"]).std() < 0.8 * np.log(plain["R"]).std() or m["image"][m["mask"] > 0].max(-1).max() == 255:
            expect(False, f"camera {seed} keeps paint, and its mask excludes what is clipped")
        clear = (m["weight"] > 0) & (m["I"].min(-1) > 0.1) & (m["I"].max(-1) < 0.9)
        worst.append(np.median(np.abs(np.log(m["I"][clear] / (m["R"] * m["E"])[clear]))) if clear.any() else 0)
        contrasts.append(np.log(m["R"]).std() / np.log(plain["R"]).std())
        seen.append(m["mask"].mean())
    near = np.mean(np.abs(np.array(contrasts) - 1) < 0.1)
    expect(np.median(worst) < 0.09 and max(worst) < 0.2, f"60 cameras: I is R E within {np.median(worst):.3f}, at worst {max(worst):.3f}")
    expect(0.6 < near < 0.95 and max(contrasts) < 1.31, f"{near:.0%} of the cameras have a contrast of .9 to 1.1")
    expect(np.mean(seen) > 0.8, f"{np.mean(seen):.0%} of the pixels are not clipped")
    curve = mix.Camera(np.random.default_rng(0), None)
    curve.bend, curve.black, x = 0.15, 0.025, np.linspace(0, 1, 99)
    expect(np.diff(curve.curve(x)).min() > 0 and abs(curve.curve(1.0) - 1) < 1e-6, "the strongest curve rises from black to white")
    again = mix.mix(s, 7, camera=7), mix.mix(s, 7, camera=7)
    expect(np.array_equal(again[0]["image"], again[1]["image"]), "a seed gives one camera")


def check_views():
    both = [samples.held_out(pathlib.Path(f"{samples.name_of(seed, view)}.npz")) for seed in (20, 23) for view in range(3)]
    expect(both == [True] * 3 + [False] * 3, "all cameras of a scene are held out, or none")


def check_files():
    s = synthetic(5)
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        samples.write(folder / "5.npz", s)
        again = samples.read(folder / "5.npz")
        off = max(np.abs(again[n] - s[n]).max() for n in ("R", "S"))
        expect(off < 2e-3 and again["meta"] == s["meta"] and not list(folder.glob("*.part")), f"a sample is read as it was written ({off:.0e})")
        (folder / "6.rejected").write_text("{}")
        args = argparse.Namespace(out=folder)  # without a command to run: it would fail if it rendered
        expect(render.render([5, 6], args) is None, "what is there is not rendered again")
        blender = folder / "blender"
        blender.write_text("#!/bin/sh\nkill -9 $$\n")
        blender.chmod(0o755)
        killed = subprocess.run([sys.executable, render.__file__, "--out", folder, "--first", "5", "--count", "3"], capture_output=True, text=True,
                                env={**os.environ, "PATH": f"{folder}:{os.environ['PATH']}"}, check=False)
        expect(killed.returncode == 1 and "1 scenes were interrupted" in killed.stderr, "a scene that was killed is a failure")
        values = np.random.default_rng(0).normal(size=(2, 5, 7)).astype("<f4")
        channels = b"".join(n + b"\0" + struct.pack("<iiii", 2, 0, 1, 1) for n in (b"A.X.R", b"B.Z")) + b"\0"
        head = (
            b"".join(
                n + b"\0" + t + b"\0" + struct.pack("<i", len(v)) + v
                for n, t, v in (
                    (b"channels", b"chlist", channels),
                    (b"compression", b"compression", b"\0"),
                    (b"dataWindow", b"box2i", struct.pack("<4i", 0, 0, 6, 4)),
                )
            )
            + b"\0"
        )
        rows = b"".join(struct.pack("<ii", y, 56) + values[0, y].tobytes() + values[1, y].tobytes() for y in range(5))
        (folder / "x.exr").write_bytes(b"\x76\x2f\x31\x01" + struct.pack("<i", 2) + head + bytes(40) + rows)
        read = exr.read(folder / "x.exr")
        expect(np.array_equal(read["A.X.R"], values[0]) and np.array_equal(read["B.Z"], values[1]), "an OpenEXR file is read")


def check_denoise():
    rng = np.random.default_rng(2)
    truth = np.ones((60, 80, 3), np.float32)
    truth[:, 40:] = 0.3
    halves = [truth * np.exp(rng.normal(0, 0.15, truth.shape)) for _ in range(2)]
    clean = denoise.denoise(*halves, np.zeros_like(truth) + [0, 0, 1], np.ones((60, 80)))
    before, after = (np.sqrt((((x - truth) / truth) ** 2).mean()) for x in (sum(halves) / 2, clean))
    edge = clean[:, 38:42].mean((0, 2))
    expect(
        after < 0.3 * before and abs(edge[1] - 1) < 0.05 and abs(edge[2] - 0.3) < 0.05,
        f"noise {before:.3f} becomes {after:.3f}, a shadow's edge stays",
    )


def check_flat(count=20):
    seen = [flat.sample(seed, None, 88, 66) for seed in range(count)]
    again = flat.sample(count - 1, None, 88, 66)
    expect(all(np.array_equal(seen[-1][n], again[n]) for n in ("R", "S")), "a drawn sample depends on its seed alone")
    expect(
        all(np.isfinite(s["S"]).all() and s["S"].min() > 0 and 0.01 < s["R"].min() and s["R"].max() < 0.93 for s in seen),
        f"{count} drawn samples: reflectance {min(s['R'].min() for s in seen):.3f} … {max(s['R'].max() for s in seen):.3f}",
    )
    even = [np.log(s["S"][0, ..., 0]).std() for s in seen]
    expect(np.median(even) > 0.15, f"ln of their first light has a standard deviation of {np.median(even):.2f}")


def check_retexture():
    """A floor seen from above, and a box on it."""
    s = synthetic(3)
    h, w = s["mask"].shape
    s["N"][:] = (0, 0, 1)
    s["Z"][:] = 4
    s["Z"][20:40, 30:60] = 3
    s["meta"] |= {"lens_mm": 25, "camera": np.diag([1.0, 1, 1, 1]).tolist()}
    expect(len(np.unique(retexture.surfaces(s))) == 3, "a floor and a box are two surfaces")
    new = retexture.retexture(s, np.random.default_rng(1), share=1)
    expect((np.abs(new["R"] - s["R"]).max(-1) > 1e-3).mean() > 0.95 and np.array_equal(new["S"], s["S"]), "both get other paint under the same light")


def check_plain():
    """A box before a wall, indoors."""
    s = synthetic(4)
    s["Z"][10:50, 20:70] = 0.5
    for group in s["meta"]["groups"]:
        group["kind"] = "lamp"
    made = [mix.plain(s, np.random.default_rng(seed)) for seed in range(40)]
    alone = [m for m in made if not m["mask"].all()]
    box = np.zeros_like(s["mask"])
    box[10:50, 20:70] = 1
    expect(8 < len(alone) < 32 and all(np.array_equal(m["mask"], box) and not m["S"][:, box == 0].any() for m in alone), "a box stands alone before black")
    spread = [np.log(m["R"][m["mask"] > 0]).std(0).max() for m in made]
    expect(np.median(spread) < 0.5 * np.log(s["R"]).std(0).max(), f"plain paint hardly differs: {np.median(spread):.2f}")


def check_samples(folder):
    files = sorted(folder.glob("*.npz"), key=lambda f: int(f.stem))
    slopes = []
    for file in files:
        s = samples.read(file)
        valid = s["mask"] > 0
        fine = (
            all(np.isfinite(s[n]).all() for n in ("R", "S", "N", "Z")) and s["S"].min() >= 0 and s["R"][valid].min() > 0.01 and s["R"].max() <= 1.001
        )
        picture = (s["R"] * s["S"].sum(0))[valid]
        off = np.abs(picture - sum((s["R"] * x)[valid] for x in s["S"])).max() / picture.max()
        if not fine or off > 1e-4:
            expect(False, f"{file}: finite {fine}, sum of the lights off by {off:.0e}")
        slopes += [mix.mix(s, seed, 2)["k"] for seed in range(3)]
    expect(True, f"{len(files)} samples; slopes at 2, 25, 50, 75, 98 %: {np.percentile(slopes, [2, 25, 50, 75, 98]).round(2) if slopes else '-'}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", nargs="?", type=pathlib.Path)
    args = parser.parse_args()
    check_colors()
    check_slope()
    check_mixture()
    check_weather()
    check_camera()
    check_views()
    check_files()
    check_denoise()
    check_flat()
    check_retexture()
    check_plain()
    if args.folder:
        check_samples(args.folder)


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: LGPL-2.1-or-later
"""Builds one scene and renders it in two halves with different seeds of the sampler, again if they are noisy:
blender -b -P scene/build.py -- --seed 3 --out FOLDER. Writes FOLDER/{a,b}{0,1}.exr (uncompressed, 32 bits, all passes and
light groups) and FOLDER/scene.json; the exit status is 3 if no camera will do."""
import argparse
import json
import pathlib
import sys

import bpy
import numpy as np
from mathutils import Vector

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import sample
from scene import indoors, outdoors
from scene.materials import Materials
from scene.prints import Prints
from scene.stage import Stage
from scene.things import Things

VERSION = 4  # of the scenes: it rises when a seed no longer makes the same one
KINDS = {
    "room": (indoors.room, 0.18),
    "hall": (indoors.hall, 0.08),
    "desk": (indoors.desk, 0.2),
    "shelf": (indoors.shelves, 0.1),
    "street": (outdoors.street, 0.18),
    "yard": (outdoors.yard, 0.16),
    "country": (outdoors.country, 0.1),
}
ENOUGH = 0.13  # noise of a light (sample.shading_of) that needs no second round


def settings(stage, samples, threads, long, portrait):
    scene, short = stage.scene, long * 3 // 4
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = (short, long) if portrait else (long, short)
    scene.render.threads_mode, scene.render.threads = "FIXED", threads
    scene.render.use_persistent_data = True
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = "CPU", samples, False, False
    cycles.max_bounces = cycles.diffuse_bounces = 5 if stage.indoors else 3
    cycles.caustics_reflective = cycles.caustics_refractive = False
    # Rare bright paths, as from the inside of a lamp's shade, would stay as speckles. Clamped alike in the picture and its groups.
    cycles.sample_clamp_direct, cycles.sample_clamp_indirect = 0, 4
    cycles.light_sampling_threshold = 0
    layer = stage.layer
    for name in ("z", "normal", "diffuse_color", "emit", "environment"):
        setattr(layer, f"use_pass_{name}", True)
    image = scene.render.image_settings
    image.file_format, image.color_depth, image.exr_codec = "OPEN_EXR_MULTILAYER", "32", "NONE"
    scene.view_settings.view_transform = "Standard"


def look(stage, eye, target, lens):
    data = bpy.data.cameras.new("camera")
    data.lens, data.clip_start = lens, 0.02
    item = bpy.data.objects.new("camera", data)
    item.location = eye
    item.rotation_euler = (Vector(target) - Vector(eye)).to_track_quat("-Z", "Y").to_euler()
    item.rotation_euler.rotate_axis("Z", stage.rng.normal(0, 0.04))
    stage.scene.collection.objects.link(item)
    return item


def judge(stage, camera, near, sky):
    """Of a grid of rays: a score, or none if the camera is inside of a thing, or sees too little or more than that share of sky."""
    graph, scene = bpy.context.evaluated_depsgraph_get(), stage.scene
    x, y = scene.render.resolution_x, scene.render.resolution_y
    matrix, f = camera.matrix_basis, camera.data.lens / 36 * max(x, y)
    eye = matrix.translation
    close = back = missed = 0
    seen, total = {}, 0
    for i in range(14):
        for j in range(11):
            d = (matrix.to_3x3() @ Vector((((i + 0.5) / 14 - 0.5) * x / f, ((j + 0.5) / 11 - 0.5) * y / f, -1))).normalized()
            hit, place, normal, face, item, _ = scene.ray_cast(graph, eye, d)
            if hit and not item.visible_camera:
                continue
            total += 1
            if not hit:
                missed += 1
                continue
            close += (place - eye).length < near
            back += normal.dot(d) > 0
            paint = item.data.materials[0].name if len(item.data.materials) == 1 else item.name
            seen[paint] = seen.get(paint, 0) + 1
    if close > 0.06 * total or back > 0.25 * total or missed > sky * total or not seen:
        return None
    share = np.array(sorted(seen.values(), reverse=True)) / total
    if share[0] > 0.72 or len(share) < 5:
        return None
    return float(-(share * np.log(share)).sum()) + stage.uniform(0, 1.2)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--assets")
    parser.add_argument("--kind", choices=KINDS)
    parser.add_argument("--long", type=int, default=352, help="pixels of the long side; the short one has 3/4 of them")
    parser.add_argument("--samples", type=int, default=14, help="of each of the two pictures, outdoors; indoors 2.5 times as many")
    parser.add_argument("--threads", type=int, default=1)
    args = parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])
    out = pathlib.Path(args.out)
    rng = np.random.default_rng([args.seed, VERSION])
    stage = Stage(rng, args.assets)
    kind = stage.pick(KINDS, [w for _, w in KINDS.values()])
    kind = args.kind or kind
    stage.indoors = kind not in ("street", "yard", "country")
    materials = Materials(stage)
    things = Things(stage, materials, Prints(stage, materials))
    draw = KINDS[kind][0](stage, materials, things)
    samples = args.samples * 5 // 2 if stage.indoors else args.samples
    settings(stage, samples, args.threads, args.long, stage.chance(0.3))
    bpy.context.view_layer.update()
    best = None
    for _ in range(60):
        eye, target, lens = draw()
        camera = look(stage, eye, target, lens)
        bpy.context.view_layer.update()
        score = judge(stage, camera, 0.12 if kind == "desk" else 0.35, 0.38 if kind == "country" else 0.3)
        if score is not None and (best is None or score > best[0]):
            best = (score, camera)
    if best is None:
        print("rejected: no camera")
        sys.exit(3)
    stage.scene.camera = camera = best[1]
    rounds = 0
    while rounds < 2:
        for i, name in enumerate("ab"):
            stage.scene.cycles.seed = 4 * args.seed + 2 * rounds + i
            stage.scene.render.filepath = str(out / f"{name}{rounds}.exr")
            bpy.ops.render.render(write_still=True)
        rounds += 1
        halves = sample.halves_of(out)
        valid = sample.surfaces(halves)
        noise = [sample.shading_of(halves, group, valid)[1] for group in stage.groups]
        if not any(ENOUGH < n < 2 * sample.NOISIEST for n in noise):  # a light that stays useless is worth no more time
            break
    meta = {
        "seed": args.seed,
        "version": VERSION,
        "kind": kind,
        "groups": [{"name": n, "kind": k} for n, k in stage.groups.items()],
        "samples": 2 * samples * rounds,
        "assets": sorted(stage.used),
        "lens_mm": camera.data.lens,
        "eye": list(camera.location),
        "camera": [list(r) for r in camera.matrix_basis],
    }
    (out / "scene.json").write_text(json.dumps(meta))


main()

# SPDX-License-Identifier: LGPL-2.1-or-later
"""Builds scenes, one after the other, and renders each from some cameras, in two halves with different seeds of the sampler, again while
they are noisy: blender -b -P scene/build.py -- --seeds 3,4 --out FOLDER. Takes the samples (sample.take) and says `scene SEED …` when
all of a scene is done."""
import argparse
import json
import pathlib
import sys
import tempfile
import time

import bpy
import cv2
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import sample
from scene import indoors, outdoors, sets, shadows
from scene.materials import Materials
from scene.pictures import Pictures
from scene.stage import Stage
from scene.things import Things

VERSION = 6  # of the scenes: it rises when a seed no longer makes the same one
KINDS = {
    "room": (indoors.room, 0.13),
    "hall": (indoors.hall, 0.05),
    "desk": (indoors.desk, 0.09),
    "shelf": (indoors.shelves, 0.05),
    "street": (outdoors.street, 0.09),
    "yard": (outdoors.yard, 0.08),
    "country": (outdoors.country, 0.04),
    "table": (sets.table, 0.14),
    "wall": (sets.wall, 0.1),
    "ground": (sets.ground, 0.1),
    "clothes": (sets.clothes, 0.09),
    "shop": (sets.shop, 0.04),
}
CLOSED = ("room", "hall", "desk", "shelf")  # rooms, whose light needs more samples
SETS = ("table", "wall", "ground", "clothes", "shop")  # may be mostly one material
ENOUGH = 0.18  # noise of a light (sample.shading_of) that needs no further round
ROUNDS = 3


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
    cycles.light_sampling_threshold = 0.01
    layer = stage.layer
    for name in ("z", "normal", "diffuse_color", "emit", "environment"):
        setattr(layer, f"use_pass_{name}", True)
    image = scene.render.image_settings
    image.file_format, image.color_depth, image.exr_codec = "OPEN_EXR_MULTILAYER", "32", "NONE"
    scene.view_settings.view_transform = "Standard"


def look(stage, eye, target, lens):
    """A camera that is not in the scene yet."""
    data = bpy.data.cameras.new("camera")
    data.lens, data.clip_start = lens, 0.02
    item = bpy.data.objects.new("camera", data)
    item.location = eye
    item.rotation_euler = (Vector(target) - Vector(eye)).to_track_quat("-Z", "Y").to_euler()
    item.rotation_euler.rotate_axis("Z", stage.rng.normal(0, 0.04))
    return item


class Rays:
    """What rays from a camera meet: one tree for all that cameras see."""

    def __init__(self, scene):
        graph = bpy.context.evaluated_depsgraph_get()
        vertices, faces, self.paints, count = [], [], [], 0
        for item in scene.objects:
            if item.type != "MESH" or item.hide_viewport or not item.visible_camera:
                continue
            mesh = item.evaluated_get(graph).data
            mesh.calc_loop_triangles()
            places, corners = np.empty(3 * len(mesh.vertices), np.float32), np.empty(3 * len(mesh.loop_triangles), np.int32)
            mesh.vertices.foreach_get("co", places)
            mesh.loop_triangles.foreach_get("vertices", corners)
            matrix = np.array(item.matrix_world)
            vertices.append(places.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3])
            faces.append(corners.reshape(-1, 3) + count)
            count += len(mesh.vertices)
            paint = item.data.materials[0].name if len(item.data.materials) == 1 else item.name
            self.paints += [paint] * len(faces[-1])
        self.tree = BVHTree.FromPolygons(np.concatenate(vertices).tolist(), np.concatenate(faces).tolist(), all_triangles=True)

    def cast(self, eye, direction, reach=1e6):
        """Place, normal and the name of a material or thing; or none."""
        place, normal, face, _ = self.tree.ray_cast(eye, direction, reach)
        return None if place is None else (place, normal, self.paints[face])

    def surface(self, eye, direction, reach):
        """Place and normal; or none."""
        hit = self.cast(eye, direction, reach)
        return hit and hit[:2]


def judge(stage, rays, camera, near, sky, most, least):
    """Of a grid of rays: a score, or none if the camera is inside of a thing, sees more than that share of sky, more than a share `most`
    of one material, or less than `least` materials."""
    scene = stage.scene
    x, y = scene.render.resolution_x, scene.render.resolution_y
    matrix, f = camera.matrix_basis, camera.data.lens / 36 * max(x, y)
    eye = matrix.translation
    close = back = missed = 0
    seen, total = {}, 0
    for i in range(14):
        for j in range(11):
            d = (matrix.to_3x3() @ Vector((((i + 0.5) / 14 - 0.5) * x / f, ((j + 0.5) / 11 - 0.5) * y / f, -1))).normalized()
            hit = rays.cast(eye, d)
            total += 1
            if hit is None:
                missed += 1
                continue
            place, normal, paint = hit
            close += (place - eye).length < near
            back += normal.dot(d) > 0
            seen[paint] = seen.get(paint, 0) + 1
    if close > 0.06 * total or back > 0.25 * total or missed > sky * total or not seen:
        return None
    share = np.array(sorted(seen.values(), reverse=True)) / total
    if share[0] > most or len(share) < least:
        return None
    return float(-(share * np.log(share)).sum()) + stage.uniform(0, 1.2)


def apart(cameras, count):
    """The best of scored cameras that look in different directions."""
    chosen = []
    for _, camera in sorted(cameras, key=lambda c: -c[0]):
        along = camera.matrix_basis.to_3x3().col[2]
        if all(along.angle(c.matrix_basis.to_3x3().col[2]) > 0.35 for c in chosen):
            chosen.append(camera)
    return chosen[:count]


def picture(stage, camera, folder, seed):
    """Renders both halves, again while they are noisy; returns how often."""
    stage.scene.camera = camera
    for rounds in range(ROUNDS):
        for i, name in enumerate("ab"):
            stage.scene.cycles.seed = (2 * ROUNDS * seed + 2 * rounds + i) % 2**31
            stage.scene.render.filepath = str(folder / f"{name}{rounds}.exr")
            bpy.ops.render.render(write_still=True)
        halves = sample.halves_of(folder)
        valid = sample.surfaces(halves)
        noise = [sample.shading_of(halves, group, valid)[1] for group in stage.groups]
        if not any(ENOUGH < n < 2 * sample.NOISIEST for n in noise):  # a light that stays useless is worth no more time
            break
    return rounds + 1


def build(seed, out, args):
    """Builds a scene and renders it into OUT/VIEW. Raises sample.Rejected if no camera will do."""
    rng = np.random.default_rng([seed, VERSION])
    stage = Stage(rng, args.assets)
    kind = stage.pick(KINDS, [w for _, w in KINDS.values()])
    kind = args.kind or kind
    stage.indoors = kind in CLOSED
    materials = Materials(stage)
    materials.pictures = Pictures(stage, materials)
    things = Things(stage, materials, materials.pictures)
    draw = KINDS[kind][0](stage, materials, things)
    samples = args.samples * 5 // 2 if stage.indoors else args.samples
    settings(stage, samples, args.threads, args.long, stage.chance(0.3))
    bpy.context.view_layer.update()
    near, sky = 0.12 if kind in ("desk", "table") else 0.35, 0.38 if kind == "country" else 0.3
    cameras, rays = [], Rays(stage.scene)
    for _ in range(60):
        eye, target, lens = draw()
        camera = look(stage, eye, target, lens)
        score = judge(stage, rays, camera, near, sky, *((0.93, 2) if kind in SETS else (0.72, 5)))
        if score is not None:
            cameras.append((score, camera))
    if not cameras:
        raise sample.Rejected("no camera")
    cameras = apart(cameras, args.views)
    for camera in cameras:
        shadows.before(stage, materials, things, rays.surface, camera, stage.pick([0, 1, 1, 2] if stage.indoors or kind in SETS else [2, 3, 4, 6]))
    for view, camera in enumerate(cameras):
        stage.scene.collection.objects.link(camera)
        folder = out / str(view)
        folder.mkdir()
        name = sample.name_of(seed, view)
        meta = {
            "seed": name,
            "version": VERSION,
            "kind": kind,
            "groups": [{"name": n, "kind": k} for n, k in stage.groups.items()],
            "samples": 2 * samples * picture(stage, camera, folder, name),
            "assets": sorted(stage.used),
            "lens_mm": camera.data.lens,
            "eye": list(camera.location),
            "camera": [list(r) for r in camera.matrix_basis],
        }
        (folder / "scene.json").write_text(json.dumps(meta))


def scene(seed, args):
    """The samples of a scene, or its rejection. Returns what happened."""
    start = time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        try:
            build(seed, folder, args)
        except Exception as error:  # a scene that fails does not stop the others
            if not any(folder.glob("*/scene.json")):
                return sample.reject(args.out, seed, start, f"{type(error).__name__}: {error}")
        views = sorted(path.parent for path in folder.glob("*/scene.json"))
        return "; ".join(sample.take(view, args.out, start) for view in views[::-1])  # the first last: it says that the scene is done


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", required=True, help="with commas between them")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--assets")
    parser.add_argument("--kind", choices=KINDS)
    parser.add_argument("--long", type=int, default=352, help="pixels of the long side; the short one has 3/4 of them")
    parser.add_argument("--samples", type=int, default=5, help="of each round's two pictures, outdoors; indoors 2.5 times as many")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--views", type=int, default=2, help="cameras, at most")
    args = parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])
    cv2.setNumThreads(args.threads)
    for seed in map(int, args.seeds.split(",")):
        print("scene", seed, scene(seed, args), flush=True)


main()

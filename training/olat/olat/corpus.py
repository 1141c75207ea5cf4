# SPDX-License-Identifier: LGPL-2.1-or-later
"""The corpus library (corpus/) through ctypes, head shapes, stages of lights, and subjects kept on disk."""
import ctypes
import json
import pathlib

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[3]
LIBRARY = ROOT / "out/olat/libcorpus.so"
HEADS = ROOT.parent / "shared/data/head_ict"  # ICT FaceKit's neutral head and deltas (MIT license), where they are at hand
WIDTH, HEIGHT = 128, 160
TEST, BUST, SPHERE, CALM = 1, 2, 4, 8  # olat_render's flags
FIELDS = ("trait", "family", "exposure", "yaw", "pitch", "pixel")
KINDS = {"M_Face": 0, "M_BackHead": 0, "M_ScleraRight": 1, "M_ScleraLeft": 2, "M_Teeth": 3, "M_GumsTongue": 4}


def fibonacci(count, rotation=None):
    """count × 3 directions spread evenly over the sphere."""
    i = np.arange(count)
    y = 1 - 2 * (i + 0.5) / count
    r, phi = np.sqrt(1 - y * y), i * np.pi * (3 - np.sqrt(5))
    d = np.stack([r * np.cos(phi), y, r * np.sin(phi)], 1)
    return (d if rotation is None else d @ rotation.T).astype(np.float32)


def geodesic(frequency=6, left_out=31):
    """Directions of a geodesic stage: an icosahedron whose edges are divided by `frequency`, without the lowest ones.
    362 vertices and 331 lights by default."""
    g = (1 + 5 ** 0.5) / 2
    corners = np.array([(0, a, b * g) for a in (1, -1) for b in (1, -1)])
    corners = np.concatenate([np.roll(corners, k, 1) for k in range(3)]) / np.hypot(1, g)
    # A corner on top, so that the stage stands upright.
    top = corners[0]
    axis = np.cross(top, (0, 1, 0))
    s, c = np.linalg.norm(axis), top[1]
    k = axis / s
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    corners = corners @ (np.eye(3) + s * cross + (1 - c) * cross @ cross).T
    edge = np.sort(np.linalg.norm(corners[0] - corners[1:], axis=1))[0] * 1.01
    near = np.linalg.norm(corners[:, None] - corners[None], axis=2) < edge
    points = []
    for a in range(12):
        for b in range(a + 1, 12):
            for d in range(b + 1, 12):
                if near[a, b] and near[b, d] and near[a, d]:
                    for i in range(frequency + 1):
                        for j in range(frequency + 1 - i):
                            points.append((i * corners[a] + j * corners[b] + (frequency - i - j) * corners[d]) / frequency)
    points = np.array(points)
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    points = points[np.unique(np.round(points, 6), axis=0, return_index=True)[1]]
    points = points[np.lexsort((np.arctan2(points[:, 0], points[:, 2]), -np.round(points[:, 1], 5)))]
    return points[:len(points) - left_out].astype(np.float32)


WIDE = np.array([(-0.75, 0.25, 0.61), (0.75, 0.25, 0.61), (0, -0.5, 0.87)])  # the 3-OLAT input of Table 7.1


def wide_baseline(directions):
    """Indices of the three lights that are nearest to those of the wide-baseline input."""
    return (WIDE @ np.asarray(directions).T).argmax(1)


def rotation(random):
    """A uniformly distributed rotation."""
    q, r = np.linalg.qr(random.standard_normal((3, 3)))
    q *= np.sign(np.diag(r))
    return q * np.sign(np.linalg.det(q))


def head_model(folder=HEADS):
    """Arrays of olat_open, or None where the head is not at hand."""
    if not (folder / "generic_neutral_mesh.obj").exists():
        return None
    vertices, faces, kinds, kind = [], [], [], -1
    for line in open(folder / "generic_neutral_mesh.obj", encoding="utf-8"):
        word, *rest = line.split() or [""]
        if word == "v":
            vertices.append([float(x) for x in rest[:3]])
        elif word == "usemtl":
            kind = KINDS.get(rest[0], -1)
        elif word == "f":
            corner = [int(x.split("/")[0]) - 1 for x in rest]
            for k in range(1, len(corner) - 1):
                faces.append((corner[0], corner[k], corner[k + 1]))
                kinds.append(kind)
    deltas = np.load(folder / "deltas_f16.npz")
    names = [n for n in deltas.files if n.startswith("identity")], [n for n in deltas.files if not n.startswith("identity")]
    stack = np.stack([deltas[n].astype(np.float32) for group in names for n in group])
    return (np.array(vertices, np.float32), len(names[0]), len(names[1]), stack, np.array(faces, np.int32),
            np.array(kinds, np.int32))


def pointer(a):
    return ctypes.c_void_p(a.ctypes.data)


class Corpus:
    """Subjects by (seed, index); those of the test split differ in shape and in numbers."""

    def __init__(self, heads=HEADS, library=LIBRARY):
        if not pathlib.Path(library).exists():
            raise FileNotFoundError(f"{library} is missing: run training/olat/corpus/build.sh")
        self.library = ctypes.CDLL(str(library))
        self.library.olat_open.restype = ctypes.c_void_p
        self.library.olat_error.restype = ctypes.c_char_p
        self.library.olat_is_held_out.argtypes = [ctypes.c_float]
        model = head_model(pathlib.Path(heads)) if heads else None
        self.has_heads = model is not None
        if model:
            vertices, identities, expressions, deltas, faces, kinds = model
            self.handle = ctypes.c_void_p(self.library.olat_open(
                len(vertices), pointer(vertices), identities, expressions, pointer(deltas), len(faces), pointer(faces),
                pointer(kinds)))
        else:
            self.handle = ctypes.c_void_p(self.library.olat_open(0, None, 0, 0, None, 0, None, None))

    def is_held_out(self, trait):
        return bool(self.library.olat_is_held_out(trait))

    def render(self, seed, index, directions, share=None, keep=None, flags=0, width=WIDTH, height=HEIGHT, samples=4):
        """Dictionary: olats (kept × 3 × h × w, as if each light had the energy of the whole sphere), gradients (2 × 3 × h × w:
        A, B), alpha, normals, and the FIELDS. `share`: part of the sphere that a light stands for; `keep`: their indices.
        Not exposed: a white Lambertian surface that faces a light has olat 1/π."""
        directions = np.ascontiguousarray(directions, np.float32)
        count = len(directions)
        share = 1 / count if share is None else share
        flag = np.ones(count, np.int32)
        if keep is not None:
            flag[:] = 0
            flag[keep] = 1
        out = {"olats": np.empty((int(flag.sum()), 3, height, width), np.float32),
               "gradients": np.empty((2, 3, height, width), np.float32), "alpha": np.empty((height, width), np.float32),
               "normals": np.empty((3, height, width), np.float32)}
        values = np.empty(len(FIELDS), np.float32)
        if self.library.olat_render(self.handle, ctypes.c_uint64(seed), ctypes.c_uint64(index), width, height, samples, flags,
                                    count, pointer(directions), ctypes.c_float(share), pointer(flag),
                                    *[pointer(a) for a in out.values()], pointer(values)):
            raise RuntimeError(self.library.olat_error().decode())
        out.update(zip(FIELDS, map(float, values)))
        return out


def exposed(sample):
    """Scales a rendered sample in place so that the 95th percentile of the full-on image's largest channel, inside the
    subject, is its exposure (1 is full scale)."""
    full = sample["gradients"].sum(0).max(0)
    inside = sample["alpha"] > 0.5
    gain = sample["exposure"] / max(float(np.percentile(full[inside], 95)) if inside.any() else 1, 1e-6)
    sample["gradients"] *= gain
    sample["olats"] *= gain
    return sample


def store(folder, name, sample, directions, stage):
    """One subject on disk: NAME.npz and NAME-olats.npy (half floats, to be mapped). `directions`: of the kept lights."""
    folder.mkdir(parents=True, exist_ok=True)
    np.save(folder / f"{name}-olats.npy", np.minimum(sample["olats"], 60000).astype(np.float16))
    record = {k: sample[k] for k in ("gradients", "alpha", *FIELDS)}
    record["normals"] = sample["normals"].astype(np.float16)
    np.savez(folder / f"{name}.npz.new.npz", directions=directions, stage=json.dumps(stage), **record)
    (folder / f"{name}.npz.new.npz").replace(folder / f"{name}.npz")


class Subject:
    """A subject on disk: olats (n × 3 × h × w, mapped), directions (n × 3), gradients, alpha."""

    def __init__(self, path):
        self.name = path.stem
        record = np.load(path)
        self.olats = np.load(path.with_name(path.stem + "-olats.npy"), mmap_mode="r")
        self.directions = record["directions"].astype(np.float32)
        self.gradients, self.alpha = record["gradients"].astype(np.float32), record["alpha"].astype(np.float32)
        self.stage = json.loads(str(record["stage"]))
        self.parameters = {k: float(record[k]) for k in FIELDS}


def stored(folder):
    """Paths of the subjects of a folder, in order."""
    return sorted(p for p in pathlib.Path(folder).glob("*.npz") if ".new" not in p.name)

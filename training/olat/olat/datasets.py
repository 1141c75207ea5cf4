# SPDX-License-Identifier: LGPL-2.1-or-later
"""What evaluate.py scores on: subjects of the corpus that were held out, rendered heads, and real faces."""
import dataclasses
import json
import os

os.environ.setdefault("OPENCV_IO_ENABLE_OPENEXR", "1")  # read when cv2 is loaded

import cv2  # noqa: E402
import numpy as np  # noqa: E402

from . import corpus  # noqa: E402
from .networks import MULTIPLE  # noqa: E402

DATA = corpus.ROOT.parent / "shared/data"


@dataclasses.dataclass
class Item:
    name: str
    a: np.ndarray           # 3 × h × w, gradient images in linear light
    b: np.ndarray
    olats: np.ndarray       # n × 3 × h × w: P, as if the light had the energy of the whole sphere
    directions: np.ndarray  # n × 3
    alpha: np.ndarray       # h × w

    @property
    def gain(self):
        """For showing P: the median over the subject of its brightest light becomes 0.7."""
        brightest = self.olats.mean(1).max(0)
        return 0.7 / max(float(np.median(brightest[self.alpha > 0.5])), 1e-6)

    def scaled(self, by):
        """The same pictures larger or smaller, filled up with black to sides that the networks take."""
        height, width = (round(by * n) for n in self.alpha.shape)
        method = cv2.INTER_AREA if by < 1 else cv2.INTER_LINEAR
        beyond = [(0, -n % MULTIPLE) for n in (height, width)]

        def one(plane):
            return np.pad(cv2.resize(plane, (width, height), interpolation=method), beyond)

        def several(planes):
            return np.stack([several(p) if p.ndim > 2 else one(p) for p in planes])

        return Item(self.name, several(self.a), several(self.b), several(self.olats), self.directions, one(self.alpha))


def read(path):
    """Picture as it is stored, 3 × h × w (RGB) or h × w."""
    picture = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    if picture is None:
        raise FileNotFoundError(f"{path} cannot be read")
    return picture if picture.ndim == 2 else np.ascontiguousarray(picture[..., 2::-1].transpose(2, 0, 1))


def held_out(folder):
    """Subjects of make_corpus.py's test split."""
    items = []
    for path in corpus.stored(folder):
        s = corpus.Subject(path)
        items.append(Item(f"corpus {s.name}", *s.gradients, np.array(s.olats, np.float32), s.directions, s.alpha))
    return items


def olat_head(folder):
    """Heads rendered by Cycles, 96 lights all around; gradient images as they are stored there."""
    items = []
    for path in sorted(p.parent for p in folder.glob("*/lights.json")):
        about = json.loads((path / "lights.json").read_text())
        directions = np.array(about["directions"], np.float32)
        if not (path / "olat" / f"{len(directions) - 1:03d}.exr").exists():
            continue
        # gradient files hold sums over OLATs with sum_weight_per_light; P is N times that share of a light.
        scale = (about["gradient_file_scale"] / about["olat_file_scale"] * about["sum_weight_per_light"] * len(directions))
        olats = np.stack([read(path / "olat" / f"{i:03d}.exr") for i in range(len(directions))]).astype(np.float32) * scale
        alpha = read(path / "alpha.png").astype(np.float32)
        alpha = (alpha if alpha.ndim == 2 else alpha[0]) / 255
        items.append(Item(path.name, read(path / "gradient1.exr").astype(np.float32),
                          read(path / "gradient2.exr").astype(np.float32), olats, directions, alpha))
    return items


def shares_of(directions, reach=15, count=20000):
    """What part of the sphere is nearest to each of these lights, and no farther than `reach` degrees."""
    points = corpus.fibonacci(count)
    cosine = points @ directions.T
    nearest = cosine.argmax(1)[cosine.max(1) > np.cos(np.radians(reach))]
    return np.bincount(nearest, minlength=len(directions)).astype(np.float32) / count


def yale(folder):
    """Real faces under lights in front and at the sides (Extended Yale B): gray, 8 bits, taken as linear. Gradient images are
    sums over those lights by the part of the sphere that each stands for; nothing comes from behind. The picture without
    any of them is taken off."""
    items = []
    for path in sorted(p for p in folder.iterdir() if p.is_dir()):
        pictures, directions = [], []
        ambient = read(next(path.glob("*_Ambient.pgm"))).astype(np.float32) / 255
        for file in sorted(path.glob("*_P00A*E*.pgm")):
            azimuth, elevation = file.stem.split("P00A")[1].split("E")
            a, e = np.radians(float(azimuth)), np.radians(float(elevation))
            picture = read(file).astype(np.float32) / 255
            if picture.shape != (192, 168):
                continue
            pictures.append(np.maximum(picture - ambient, 0)[:, 4:164])
            directions.append((-np.sin(a) * np.cos(e), np.sin(e), np.cos(a) * np.cos(e)))
        directions = np.array(directions, np.float32)
        shares = shares_of(directions)
        keep = shares > 0
        olats, directions, shares = np.stack(pictures)[keep], directions[keep], shares[keep]
        full = np.einsum("n,nhw->hw", shares, olats)
        olats *= 0.6 / np.percentile(full, 95)
        a, b = (np.einsum("nc,nhw->chw", shares[:, None] * (1 + sign * directions) / 2, olats) for sign in (1, -1))
        items.append(Item(path.name, a.astype(np.float32), b.astype(np.float32),
                          np.repeat(olats[:, None], 3, 1).astype(np.float32), directions, np.ones(full.shape, np.float32)))
    return items

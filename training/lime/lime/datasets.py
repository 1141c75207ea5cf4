# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the networks are scored on, in one form. Nothing in here is ever trained on."""
import dataclasses
import json
import os

import numpy as np

os.environ.setdefault("OPENCV_IO_ENABLE_OPENEXR", "1")
import cv2  # noqa: E402  (it reads the variable when it is loaded)

from . import corpus  # noqa: E402

DATA = corpus.ROOT.parent / "shared/data"
CHOICES, REPORT = 1, 3  # seeds of held-out samples: those by which choices are made (ablations, sizes, …), and those of reports


@dataclasses.dataclass
class Item:
    """One picture; arrays are float32, channels × h × w. What a set does not know is None."""

    name: str
    image: np.ndarray               # 3: sRGB 0 … 1, of 8 bit
    mask: np.ndarray                # 1: 0 or 1
    layer: np.ndarray = None        # 1: the specular layer, gray, linear
    shading: np.ndarray = None      # 3: D
    mirror: np.ndarray = None       # 1: alpha M, gray, linear
    diffuse: np.ndarray = None      # 3 numbers: m_d
    alpha: float = None
    shininess: float = None

    @property
    def image_linear(self):
        return to_linear(self.image)


def to_linear(srgb):
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4).astype(np.float32)


def to_srgb8(linear):
    """sRGB of 8 bit, as float32 0 … 1."""
    x = np.clip(linear, 0, 1)
    x = np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-8) ** (1 / 2.4) - 0.055)
    return (np.round(255 * x) / 255).astype(np.float32)


def read(path):
    """Picture as it is stored, channels (RGB) × h × w."""
    picture = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    if picture is None:
        raise FileNotFoundError(f"{path} cannot be read")
    if picture.ndim == 2:
        return picture[None]
    return np.ascontiguousarray(picture[..., 2::-1].transpose(2, 0, 1))


def synthetic(samples, seed, count, flags=corpus.TEST, size=128):
    """Corpus samples; by default held-out shapes under held-out maps. Where some are matte, whose shininess says nothing, only
    mask and layers are told; of whole frames, whose exposure is not that of the layers, only the mask. There are such without
    an object, too."""
    whole, matte = flags & corpus.WHOLE_FRAME, flags & corpus.EVERYDAY
    items = []
    for first in range(0, count, 50):
        n = min(50, count - first)
        arrays = samples.render(seed, first, n, size, flags)
        for i in range(n):
            p = dict(zip(corpus.FIELDS, arrays["parameters"][i]))
            item = Item(f"{first + i}", arrays["image"][i].astype(np.float32) / 255,
                        (arrays["coverage"][i] >= 128).astype(np.float32))
            if not whole:
                item.layer = p["specular"] * arrays["specular"][i].mean(0, keepdims=True)
                item.shading = arrays["diffuse"][i].copy()
                item.mirror = p["alpha"] * arrays["mirror"][i].mean(0, keepdims=True)
            if not whole and not matte:
                item.diffuse = np.array([p["diffuse_" + c] for c in "rgb"])
                item.alpha, item.shininess = float(p["alpha"]), float(p["shininess"])
            items.append(item)
    return items


def exposed(items, stops):
    """The same pictures brighter by so many stops, clipped and in 8 bits again; what was clipped stays flat where they are darker.
    Materials are what they are."""
    gain = np.float32(2 ** stops)
    return [dataclasses.replace(item, image=to_srgb8(gain * item.image_linear), layer=gain * item.layer,
                                shading=gain * item.shading, mirror=gain * item.mirror) for item in items]


def materials(folder):
    """The Blinn-Phong part of the rendered evaluation set: those of its items whose pictures are there."""
    items = []
    for m in json.loads((folder / "meta.json").read_text())["items"]:
        name = f"{m['id']:03d}"
        if not (folder / "I8" / f"{name}.png").exists():
            continue
        exr = {k: read(folder / k / f"{name}.exr").astype(np.float32) for k in "DSM"}
        items.append(Item(
            name, read(folder / "I8" / f"{name}.png").astype(np.float32) / 255,
            (read(folder / "B" / f"{name}.png") >= 128).astype(np.float32), m["ms"] * exr["S"].mean(0, keepdims=True),
            exr["D"], m["alpha"] * exr["M"].mean(0, keepdims=True), np.array(m["md"]), m["alpha"], m["s"]))
    return items


def ggx(folder):
    """Its path-traced part: GGX lobes, shadows, interreflection, black background; s is that of the equivalent lobe.
    alpha and M have no counterpart there."""
    items = []
    for m in json.loads((folder / "meta.json").read_text())["items"]:
        name = f"{m['id']:03d}"
        exr = {k: read(folder / f"{name}_{k}.exr").astype(np.float32) for k in ("I", "A", "GlossCol", "Sgloss", "Sdiff")}
        items.append(Item(name, to_srgb8(exr["I"]), (exr["A"][:1] >= 0.5).astype(np.float32),
                          (exr["GlossCol"] * exr["Sgloss"]).mean(0, keepdims=True), exr["Sdiff"], None,
                          np.array(m["md"]), None, m["s_blinn_phong_equivalent"]))
    return items


def mit(folder, size=128, color=None):
    """Real objects with measured specular images (Grosse et al. 2009): cropped to the object with a margin of a tenth,
    exposed so that 98 % of its values are below white, as the corpus is. `color`, linear RGB: an albedo in place of their paint."""
    items = []
    for path in sorted(p for p in folder.iterdir() if (p / "specular.png").exists()):
        mask = (read(path / "mask.png")[:1] > 0).astype(np.float32)
        original, specular = (read(path / f"{k}.png").astype(np.float32) / 65535 for k in ("original", "specular"))
        if color is not None:  # shading is known up to a factor
            shading, reflectance = (read(path / f"{k}.png").astype(np.float32) / 65535 for k in ("shading", "reflectance"))
            product = shading.mean(0) * reflectance * mask
            factor = ((original - specular) * product).sum() / (product * product).sum()
            original = np.reshape(color, (3, 1, 1)).astype(np.float32) * factor * shading.mean(0) + specular.mean(0)
        rows, columns = np.nonzero(mask[0])
        side = int(1.2 * max(np.ptp(rows), np.ptp(columns)) + 1)
        top, left = (int(round((a.min() + a.max() - side) / 2)) for a in (rows, columns))

        def crop(picture):
            out = np.zeros((picture.shape[0], side, side), np.float32)
            h, w = picture.shape[1:]
            y0, x0, y1, x1 = max(top, 0), max(left, 0), min(top + side, h), min(left + side, w)
            out[:, y0 - top:y1 - top, x0 - left:x1 - left] = picture[:, y0:y1, x0:x1]
            small = cv2.resize(out.transpose(1, 2, 0), (size, size), interpolation=cv2.INTER_AREA)
            return small.reshape(size, size, -1).transpose(2, 0, 1)

        mask, original, specular = crop(mask), crop(original), crop(specular)
        inside = mask[0] > 0.5
        gain = 1 / max(np.percentile(original[:, inside], 98), 1e-6)
        image = to_srgb8(gain * np.broadcast_to(original, (3, size, size)))  # gray pictures become three equal channels
        items.append(Item(path.name, image, inside[None].astype(np.float32), gain * specular.mean(0, keepdims=True)))
    return items

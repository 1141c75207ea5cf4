# SPDX-License-Identifier: LGPL-2.1-or-later
"""The corpus library (corpus/) through ctypes, and batches of it rendered ahead of the training."""
import collections
import ctypes
import pathlib
import queue
import threading

import numpy as np
import torch

from . import encoding

ROOT = pathlib.Path(__file__).resolve().parents[3]
LIBRARY = ROOT / "out/lime/libcorpus.so"
HDRI = ROOT.parent / "shared/data/hdri"  # CC0 maps of Poly Haven, where they are at hand
FIELDS = ("diffuse_r", "diffuse_g", "diffuse_b", "alpha", "shininess", "bin", "ambient", "specular", "exposure", "family",
          "trait", "map", "empty")
TEST, CLEAN, WHOLE_FRAME, MAY_BE_PAINTED, EVERYDAY = 1, 2, 4, 8, 16  # sample.hpp's Request
TAUGHT = MAY_BE_PAINTED | EVERYDAY  # what all training samples may be
LATER = 16  # batches until one comes again in a mirror
AGAIN = 32  # batches until one that is used several times comes again


class Corpus:
    """Samples by (seed, index); training and test samples differ in shapes, environment maps and numbers."""

    def __init__(self, hdri=None, library=LIBRARY):
        """hdri: folder of Radiance maps; None: the shared one where it is present, else rooms only; "": rooms only."""
        if not pathlib.Path(library).exists():
            raise FileNotFoundError(f"{library} is missing: run training/lime/corpus/build.sh")
        self.library = ctypes.CDLL(str(library))
        self.library.lime_open.restype = ctypes.c_void_p
        self.library.lime_error.restype = ctypes.c_char_p
        self.library.lime_maps.restype = ctypes.c_char_p
        self.library.lime_is_held_out_shape.argtypes = [ctypes.c_int, ctypes.c_float]
        if hdri is None:
            hdri = HDRI if HDRI.is_dir() else ""
        self.handle = ctypes.c_void_p(self.library.lime_open(str(hdri).encode()))
        if not self.handle:
            raise RuntimeError(self.library.lime_error().decode())
        assert self.library.lime_parameters() == len(FIELDS)

    def maps(self, held_out):
        """Names of the environment maps of one split."""
        return self.library.lime_maps(self.handle, int(held_out)).decode().split()

    def is_held_out_shape(self, family, trait):
        return bool(self.library.lime_is_held_out_shape(int(family), float(trait)))

    def render(self, seed, first, count, size=128, flags=0, threads=2):
        """Dictionary of arrays, count × channels × size × size.

        image: uint8 sRGB, 3 channels; coverage: uint8, 1; diffuse D, specular S, mirror M: float32 linear RGB, exposed;
        parameters: float32, count × len(FIELDS).
        """
        def planes(channels, kind):
            return np.empty((count, channels, size, size), kind)

        out = {"image": planes(3, np.uint8), "coverage": planes(1, np.uint8), "diffuse": planes(3, np.float32),
               "specular": planes(3, np.float32), "mirror": planes(3, np.float32),
               "parameters": np.empty((count, len(FIELDS)), np.float32)}
        pointers = [ctypes.c_void_p(a.ctypes.data) for a in out.values()]
        self.library.lime_render(self.handle, ctypes.c_uint64(seed), ctypes.c_uint64(first), count, size, flags, threads,
                                 *pointers)
        return out

    def shade(self, env, normals, views, shininess, every=False):
        """D and S (Eq. 6.3), n × 3, for unit normals and views under env (rows × 2 rows × 3)."""
        env, normals, views = (np.ascontiguousarray(a, np.float32) for a in (env, normals, views))
        out = [np.empty_like(normals), np.empty_like(normals)]
        pointers = [ctypes.c_void_p(a.ctypes.data) for a in (normals, views)]
        self.library.lime_shade(ctypes.c_void_p(env.ctypes.data), env.shape[0], len(normals), *pointers,
                                ctypes.c_float(shininess), int(every), *[ctypes.c_void_p(a.ctypes.data) for a in out])
        return out


class Batch:
    """Tensors of one batch (n × channels × h × w), as the networks and losses take them.

    image: sRGB 0 … 1; mask: 1 where the object covers at least half of the pixel; shading: D, linear RGB;
    layer: the specular layer m_s S, gray, linear; tint: its color, mean 1; mirror: alpha M, gray, linear;
    diffuse, alpha, shininess, bin, ambient: the material, n × 3 and n; shiny: 1, or 0 of matte objects (alpha 0), whose
    shininess and bin say nothing. found: mask and layers as networks find them (stages.find_layers), or None: not asked yet.
    """

    found = None

    def __init__(self, arrays, device="cpu"):
        def tensor(a):
            return torch.from_numpy(np.ascontiguousarray(a)).to(device)

        parameters = dict(zip(FIELDS, tensor(arrays["parameters"]).unbind(1)))
        self.diffuse = torch.stack([parameters["diffuse_" + c] for c in "rgb"], 1)
        self.alpha, self.shininess = parameters["alpha"], parameters["shininess"]
        self.shiny = (self.alpha > 0).float()
        self.bin, self.ambient = parameters["bin"].long(), parameters["ambient"]
        self.image = (tensor(arrays["image"]).float() / 255).contiguous(memory_format=torch.channels_last)
        self.mask = (tensor(arrays["coverage"]) >= 128).float()
        self.shading = tensor(arrays["diffuse"])
        specular = tensor(arrays["specular"])
        gray = specular.mean(1, keepdim=True)
        self.tint = torch.where(gray > 0, specular / gray.clamp(min=1e-9), torch.ones_like(specular))
        self.layer = parameters["specular"].view(-1, 1, 1, 1) * gray
        self.mirror = self.alpha.view(-1, 1, 1, 1) * tensor(arrays["mirror"]).mean(1, keepdim=True)
        self.layer_code = encoding.encode(self.layer) * self.mask
        self.mirror_code = encoding.encode(self.mirror) * self.mask


def mirrored(arrays):
    """The same objects seen in a mirror: as true as they are themselves."""
    return {name: a if name == "parameters" else a[..., ::-1] for name, a in arrays.items()}


class Stream:
    """Batches of one seed from sample `first` on, rendered ahead by a thread. `second_flags`: those of each batch' second half;
    None: `flags`, as of the first. `twice`: each comes a second time, in a mirror, some batches later, which halves
    what rendering costs. `index`: the first sample that was not drawn yet."""

    def __init__(self, corpus, seed, first, batch, size=128, flags=0, threads=1, device="cpu", ahead=4, twice=False, second_flags=None):
        self.queue = queue.Queue(ahead)
        self.index = first
        self.stopped = False
        self.device = device

        def put(index, arrays):
            while not self.stopped:
                try:
                    return self.queue.put((index, arrays), timeout=0.5)
                except queue.Full:
                    pass

        def render(index):
            if second_flags is None:
                return corpus.render(seed, index, batch, size, flags, threads)
            half = batch // 2
            first_half = corpus.render(seed, index, half, size, flags, threads)
            second_half = corpus.render(seed, index + half, batch - half, size, second_flags, threads)
            return {name: np.concatenate([a, second_half[name]]) for name, a in first_half.items()}

        def work():
            index, seen = first, []
            while not self.stopped:
                try:
                    arrays = render(index)
                except Exception as error:  # pylint: disable=broad-except
                    return put(index, error)  # whoever waits for samples hears of it
                index += batch
                put(index, arrays)
                if twice:
                    seen.append(arrays)
                    if len(seen) > LATER:
                        put(index, mirrored(seen.pop(0)))

        self.thread = threading.Thread(target=work, daemon=True)
        self.thread.start()

    def __next__(self):
        self.index, arrays = self.queue.get()
        if isinstance(arrays, Exception):
            raise arrays
        return Batch(arrays, self.device)

    def close(self):
        self.stopped = True
        self.thread.join()


class Again:
    """The batches of a stream, each `times` times: one that is new, then those of AGAIN, 2 AGAIN, … draws before."""

    def __init__(self, stream, times):
        self.stream, self.times = stream, times
        self.seen, self.waiting = collections.deque(maxlen=AGAIN * (times - 1)), []

    def __next__(self):
        if not self.waiting:
            new = next(self.stream)
            self.waiting = [new, *list(self.seen)[-AGAIN::-AGAIN]]
            self.seen.append(new)
        return self.waiting.pop(0)

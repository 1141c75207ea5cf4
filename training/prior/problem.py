# SPDX-License-Identifier: LGPL-2.1-or-later
"""Examples and their loss as a function of the network's answer (problem_library.cpp), for PyTorch."""
import concurrent.futures
import ctypes
import os
import pathlib

import numpy as np
import torch

ROOT = pathlib.Path(__file__).resolve().parents[2]
WEIGHTS = str(ROOT / "training/edges/weights.txt").encode()
SLOPE_ERROR = 0.2  # rms, of an estimate (training/edges/colored_light.hpp)
FIELDS, LIMIT = 3, 5.0  # ln v, V, ln g; at which they saturate
FLOATS = ctypes.POINTER(ctypes.c_float)


def load(path=None):
    """The library that the build makes (-Dtraining=true), or PRIOR_PROBLEM."""
    library = ctypes.CDLL(str(path or os.environ.get("PRIOR_PROBLEM", ROOT / "build-training/training/prior/libprior-problem.so")))
    library.problem_of_seed.restype = library.problem_of_picture.restype = ctypes.c_void_p
    library.problem_of_seed.argtypes = [ctypes.c_uint32] + [ctypes.c_int] * 3 + [ctypes.c_double, ctypes.c_char_p]
    library.problem_of_picture.argtypes = [FLOATS] * 4 + [ctypes.c_int] * 3 + [ctypes.c_double, ctypes.c_uint, ctypes.c_char_p]
    library.problem_free.argtypes = [ctypes.c_void_p]
    library.problem_size.argtypes = [ctypes.c_void_p, ctypes.POINTER(ctypes.c_int)]
    library.problem_input.argtypes = [ctypes.c_void_p, FLOATS]
    library.problem_loss.argtypes = [ctypes.c_void_p, FLOATS] + [ctypes.c_double] * 3 + [ctypes.c_void_p, FLOATS]
    library.problem_loss.restype = ctypes.c_double
    library.problem_local_loss.argtypes = [ctypes.c_void_p, FLOATS, FLOATS]
    library.problem_local_loss.restype = ctypes.c_double
    library.problem_planes.argtypes = [ctypes.c_void_p] + [FLOATS] * 5
    library.triple_of.restype = ctypes.c_void_p
    library.triple_of.argtypes = [ctypes.c_void_p] * 3 + [ctypes.c_int, FLOATS]
    library.triple_free.argtypes = [ctypes.c_void_p]
    library.triple_loss.restype = ctypes.c_double
    library.triple_loss.argtypes = [ctypes.c_void_p, FLOATS * 3] + [ctypes.c_double] * 2 + [ctypes.POINTER(ctypes.c_double), FLOATS * 3]
    return library


LIBRARY = None


def pointer(array):
    return array.ctypes.data_as(FLOATS)


class Problem:
    """A picture with truth, the fitted prior, and the last solution, from which the next solve starts.

    input   6 × padded height × padded width: what the network sees
    size    height, width of the network's picture
    kind    a word for tables"""

    def __init__(self, handle, kind):
        self.handle, self.kind = handle, kind
        size = (ctypes.c_int * 7)()
        LIBRARY.problem_size(handle, size)
        self.width, self.height, w, h, padded_w, padded_h, self.level = size
        self.size = (h, w)
        self.input = np.empty((6, padded_h, padded_w), np.float32)
        LIBRARY.problem_input(handle, pointer(self.input))
        self.weight = 1.0  # of its derivative in a batch
        self.twin = None  # the same scene in another light, of the same size

    def __del__(self):
        if LIBRARY:  # not while Python ends
            LIBRARY.problem_free(self.handle)

    def loss(self, fields, weights, gradient=True):
        """Loss of fields (3 × size, saturated, float32), and its derivative by them or None. weights: of equal and different pairs, and of the
        distance of ln R from that of the twin."""
        fields = np.ascontiguousarray(fields, np.float32)
        slope = np.empty_like(fields) if gradient else None
        twin = self.twin and self.twin.handle
        return LIBRARY.problem_loss(self.handle, pointer(fields), *weights, twin, pointer(slope) if gradient else None), slope

    def local_loss(self, fields):
        """The same of a loss that takes no solve: of V."""
        fields = np.ascontiguousarray(fields, np.float32)
        slope = np.empty_like(fields)
        return LIBRARY.problem_local_loss(self.handle, pointer(fields), pointer(slope)), slope

    def part(self, fields):
        """What of fields of the padded picture is of the network's picture."""
        return fields[..., : self.size[0], : self.size[1]]

    def planes(self):
        """Of the last loss, in white light: ln shading, input, true reflectance, true shading, mask."""
        n = (self.height, self.width)
        planes = [np.empty(n + c, np.float32) for c in ((), (3,), (3,), (), ())]
        LIBRARY.problem_planes(self.handle, *(pointer(p) for p in planes))
        return planes


class Triple:
    """A photograph, the same with light, and one of the two with paint (../couples).

    pictures  Problems without truth, of one size
    kind      a word for tables
    shares    of light and of paint that reflectance keeps, of the last loss that solved"""

    def __init__(self, pictures, base, light, kind):
        """base: 0 or 1, of the paint. light: height × width × 3, ratio."""
        self.pictures, self.kind, self.weight, self.shares = pictures, kind, 1.0, (ctypes.c_double * 2)()
        self.handle = LIBRARY.triple_of(*(p.handle for p in pictures), base, pointer(np.ascontiguousarray(light, np.float32)))

    def __del__(self):
        if LIBRARY:
            LIBRARY.triple_free(self.handle)

    def loss(self, fields, solved, local, gradient=True):
        """fields: of the three pictures. solved, local: weights of what the solve makes of them, and of a loss that takes no solve. Returns the
        loss and its derivatives or None."""
        fields = [np.ascontiguousarray(f, np.float32) for f in fields]
        slopes = [np.empty_like(f) for f in fields] if gradient else None
        loss = LIBRARY.triple_loss(self.handle, (FLOATS * 3)(*map(pointer, fields)), solved, local, self.shares,
                                   (FLOATS * 3)(*map(pointer, slopes)) if gradient else (FLOATS * 3)())
        return loss, slopes


def of_seed(seed, width=176, height=132, level=0):
    """level: the network's picture has 1/2^level of the size."""
    return Problem(LIBRARY.problem_of_seed(seed, width, height, level, SLOPE_ERROR, WEIGHTS), "procedural")


def of_picture(picture, reflectance, light, mask, seed, kind, level=0):
    """picture, reflectance, light: height × width × 3, linear; mask: height × width."""
    planes = [np.ascontiguousarray(p, np.float32) for p in (picture, reflectance, light, mask)]
    height, width = planes[3].shape
    return Problem(LIBRARY.problem_of_picture(*(pointer(p) for p in planes), width, height, level, SLOPE_ERROR, seed, WEIGHTS), kind)


def fields_of(answers):
    """The network's answers (batch × 12 × height/2 × width/2) as saturated fields (batch × 3 × height × width)."""
    x = torch.nn.functional.pixel_shuffle(answers, 2)
    return x / (1 + x.abs() / LIMIT)


def mean_square(fields):
    """Relative to the limit."""
    return ((fields / LIMIT) ** 2).mean()


class Loss(torch.autograd.Function):
    """Mean loss of examples (Problem, Triple): fields of each of their pictures → scalar. Its derivative weighs the examples. Solves run in threads."""

    pool = concurrent.futures.ThreadPoolExecutor(os.cpu_count())

    @staticmethod
    def forward(context, examples, weights, solved, local, *fields):
        """solved, local: weights of what solves make of the fields, and of the losses that take none."""
        planes = iter([f.detach().cpu().numpy() for f in fields])

        def one(example, planes):
            if isinstance(example, Triple):
                return example.loss(planes, solved, local)
            loss, slope = 0.0, np.zeros_like(planes[0])
            for factor, part in ((solved, lambda: example.loss(planes[0], weights)), (local, lambda: example.local_loss(planes[0]))):
                if factor:
                    more, steeper = part()
                    loss, slope = loss + factor * more, slope + factor * steeper
            return loss, [slope]

        results = list(Loss.pool.map(one, examples, [[next(planes) for _ in pictures_of(e)] for e in examples]))
        slopes = [s * (e.weight / len(examples)) for e, (_, all) in zip(examples, results) for s in all]
        context.slopes = [torch.from_numpy(s.astype(np.float32)).to(f.device) for s, f in zip(slopes, fields)]
        return torch.tensor(float(np.mean([e.weight * r[0] for e, r in zip(examples, results)])))

    @staticmethod
    def backward(context, by):
        return (None,) * 4 + tuple(by * s for s in context.slopes)


def pictures_of(example):
    return example.pictures if isinstance(example, Triple) else [example]

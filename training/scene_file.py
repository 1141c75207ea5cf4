# SPDX-License-Identifier: LGPL-2.1-or-later
"""Scenes of training/edges as files (scene_files.hpp): width, height, then for every pixel I, R, S (RGB, linear) and the mask."""
import numpy as np


def write(path, picture, reflectance, shading, mask):
    values = np.concatenate([picture, reflectance, shading, mask[..., None]], -1)
    path.write_bytes(np.array(values.shape[1::-1], "<i4").tobytes() + values.astype("<f4").tobytes())


def read(path):
    """I, R, S (height × width × 3) and the mask (height × width), as doubles."""
    data = path.read_bytes()
    width, height = np.frombuffer(data, "<i4", 2)
    values = np.frombuffer(data, "<f4", offset=8).reshape(height, width, 10).astype(np.float64)
    return values[..., :3], values[..., 3:6], values[..., 6:9], values[..., 9]

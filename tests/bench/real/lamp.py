# SPDX-License-Identifier: LGPL-2.1-or-later
"""Light that follows geometry, on a photograph with depth: the ratio by which a lamp with an ambient rest multiplies its linear light. Shading takes all
of it, reflectance nothing. What lit the photograph stays in it, so this is no physics of the room. Depth is in meters."""
import cv2
import numpy as np

TRUSTED = 13  # pixels around a measurement of depth that its neighborhood fills
THICK = 0.35  # meters that a surface is taken to be deep, for shadows
STEPS = 56  # of a ray to the lamp
JUMP = 0.25  # of the Laplacian of ln depth, beyond which light is not known


def points(depth, camera):
    """height x width x 3 points, x right, y down, z away. camera: fx, fy, cx, cy in pixels."""
    y, x = np.mgrid[: depth.shape[0], : depth.shape[1]].astype(np.float32)
    fx, fy, cx, cy = camera
    return np.stack([(x - cx) / fx * depth, (y - cy) / fy * depth, depth], -1).astype(np.float32)


def filled(depth):
    """Depth without holes, and where it is near a measurement."""
    depth = depth.astype(np.float32).copy()
    known = depth > 0
    near = cv2.dilate(known.astype(np.uint8), np.ones((TRUSTED, TRUSTED), np.uint8)) > 0
    weight = known.astype(np.float32)
    weighted = depth * weight
    for sigma in (1, 2, 4, 8, 16, 32):
        sums, counts = cv2.GaussianBlur(weighted, (0, 0), sigma), cv2.GaussianBlur(weight, (0, 0), sigma)
        hole = (depth <= 0) & (counts > 0.05)
        depth[hole] = (sums / np.maximum(counts, 1e-6))[hole]
    depth[depth <= 0] = np.median(depth[known])
    return depth, near


def smooth(depth):
    """Edge-preserving, relative to depth."""
    logs = np.log(depth)
    for _ in range(3):
        logs = cv2.bilateralFilter(logs.astype(np.float32), 7, 0.03, 3)
    return np.exp(logs)


def unit(vectors):
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-9)


def normals(place):
    """Unit normals towards the camera, over five pixels."""
    normal = unit(np.cross(np.roll(place, -2, 1) - np.roll(place, 2, 1), np.roll(place, -2, 0) - np.roll(place, 2, 0)))
    normal = np.where((normal * place).sum(-1, keepdims=True) > 0, -normal, normal)
    return unit(cv2.GaussianBlur(normal.astype(np.float32), (0, 0), 1.2))


def lit(place, depth, camera, lamp):
    """1 where a ray to the lamp meets nothing in the depth image, else 0."""
    fx, fy, cx, cy = camera
    height, width = depth.shape
    out = np.ones((height, width), np.float32)
    for share in (np.arange(1, STEPS + 1) / STEPS) ** 1.5:
        on_ray = place + (lamp - place) * share
        z = np.maximum(on_ray[..., 2], 0.05)
        u, v = on_ray[..., 0] / z * fx + cx, on_ray[..., 1] / z * fy + cy
        inside = (u > 0) & (u < width - 1) & (v > 0) & (v < height - 1) & (on_ray[..., 2] > 0.1)
        surface = cv2.remap(depth, u.astype(np.float32), v.astype(np.float32), cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        behind = on_ray[..., 2] - surface
        out[inside & (behind > 0.012 + 0.012 * surface) & (behind < THICK)] = 0
    return out


def ratio(depth, camera, rng, lamps=5):
    """The ratio (height x width x 3, RGB) of linear light, about 1 in its 98th percentile, and where it is known. `lamps`: points that make up the
    lamp, whose spread softens its shadows."""
    depth, near = filled(depth)
    depth = smooth(depth)
    place = points(depth, camera)
    normal, middle = normals(place), np.median(place.reshape(-1, 3), 0)[2]
    center = np.array([rng.uniform(-1, 1), rng.uniform(-1.3, 0.2), rng.uniform(-0.2, 0.9)]) * middle
    size = rng.choice([0.01, 0.04, 0.12]) * middle
    light = 0
    for _ in range(lamps):
        lamp = (center + rng.normal(0, size, 3)).astype(np.float32)
        towards = lamp - place
        far = np.linalg.norm(towards, axis=-1)
        cosine = np.maximum((normal * towards).sum(-1) / np.maximum(far, 1e-6), 0)
        light = light + lit(place, depth, camera, lamp) * cosine / (1 + (far / (1.2 * middle)) ** 2) / lamps
    light = cv2.GaussianBlur(light.astype(np.float32), (0, 0), 0.7)
    light = np.minimum(light / max(np.percentile(light, 98), 1e-3), 1.3)[..., None]
    ambient, tint = np.exp(rng.uniform(np.log(0.12), np.log(0.5))), rng.uniform(-0.05, 0.3)
    ambient = ambient * np.array([1 - tint, 1, 1 + tint], np.float32)  # mostly bluer than the lamp
    jump = np.abs(cv2.Laplacian(np.log(depth).astype(np.float32), cv2.CV_32F)) > JUMP
    jump = cv2.dilate(jump.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    return (ambient + (1 - ambient) * light).astype(np.float32), near & ~jump

# SPDX-License-Identifier: LGPL-2.1-or-later
"""Photographs from samples: colors and strengths of the lights, white balance, exposure, haze, blur, noise, 8 bits.

Light of channel c is E_c, so I_c = R_c E_c; white balance and exposure belong to E. With m = mean_c ln E_c and b = ln E_R - ln E_B,
the slope k of b over m says how light's color depends on its brightness; d = (1/2, 0, -1/2) is the axis along which it changes."""
import io

import numpy as np

import sample as samples

AXIS = np.array([0.5, 0, -0.5], np.float32)
TEMPERATURES = {"sun": (4500, 6000), "sky": (8000, 20000), "lamp": (2700, 4000), "window": (6000, 15000)}  # K


def planck(temperature):
    """Linear sRGB of a black body at a temperature in K, green 1. CIE 1931 functions: Wyman, Sloan and Shirley 2013."""
    nm = np.arange(380.0, 781, 5)
    power = nm**-5.0 / np.expm1(1.4388e7 / (nm * temperature))

    def lobe(peak, left, right):
        return np.exp(-0.5 * ((nm - peak) / np.where(nm < peak, left, right)) ** 2)

    x = 1.056 * lobe(599.8, 37.9, 31.0) + 0.362 * lobe(442.0, 16.0, 26.7) - 0.065 * lobe(501.1, 20.4, 26.2)
    y = 0.821 * lobe(568.8, 46.9, 40.5) + 0.286 * lobe(530.9, 16.3, 31.1)
    z = 1.217 * lobe(437.0, 11.8, 36.0) + 0.681 * lobe(459.0, 26.0, 13.8)
    rgb = np.array([[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]]) @ [(power * f).sum() for f in (x, y, z)]
    return np.maximum(rgb / rgb[1], 1e-3)


def srgb(linear):
    x = np.clip(linear, 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-8) ** (1 / 2.4) - 0.055)


def linear(encoded):
    x = np.asarray(encoded, np.float32)
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


def slope(light, weight):
    """Of light (height × width × 3) where weight (height × width) is: a dict of
    k      weighted least-squares slope of ln E_R - ln E_B over m
    m_rms  rms of m about its mean: where it is small, k means little
    axis   rms that the line leaves of ln E_R - ln E_B
    g      rms of (ln E_R + ln E_B)/2 - ln E_G about its mean"""
    l = np.log(np.maximum(light, 1e-9))
    w = weight / weight.sum()
    m, b, g = l.mean(-1), l[..., 0] - l[..., 2], 0.5 * (l[..., 0] + l[..., 2]) - l[..., 1]
    m, b, g = (x - (w * x).sum() for x in (m, b, g))
    variance = (w * m * m).sum()
    k = float((w * m * b).sum() / variance) if variance > 1e-8 else 0.0
    return {"k": k, "m_rms": float(np.sqrt(variance)), "axis": float(np.sqrt((w * (b - k * m) ** 2).sum())), "g": float(np.sqrt((w * g * g).sum()))}


def with_slope(light, weight, k):
    """The same light with slope k: adds a multiple of d (m - mean m) to its logarithm. Exact: brightness m, g and the residual stay."""
    m = np.log(np.maximum(light, 1e-9)).mean(-1)
    m = m - (weight * m).sum() / weight.sum()
    return light * np.exp((k - slope(light, weight)["k"]) * m[..., None] * AXIS)


def shrink(sample, times):
    """The sample at 1/2, 1/4 … of its size, by means of R and of I."""
    while times > 1:
        pictures = np.stack([samples.halve(sample["R"] * s) for s in sample["S"]])
        reflectance = samples.halve(sample["R"])
        sample = {
            **sample,
            "R": reflectance,
            "S": pictures / reflectance,
            "mask": (samples.halve(sample["mask"].astype(float)) == 1).astype(np.uint8),
            "N": samples.halve(sample["N"]),
            "Z": samples.halve(sample["Z"]),
        }
        times //= 2
    return sample


def repaint(sample, rng):
    """The sample with other paint under the same light: other hues, saturation and contrast of value, down to nearly equal values;
    little or no color, everywhere or for what is like one of its pixels, as print, walls, furniture and clothes are; dark paint browner or
    bluer than light paint; fine gray grain."""
    mask = sample["mask"] > 0
    paint = np.log(np.maximum(sample["R"], 1e-3))
    if rng.random() < 0.5:
        paint = paint[..., rng.permutation(3)]
    value = paint.mean(-1, keepdims=True)
    middle = value[mask].mean()
    hue = paint - value
    if rng.random() < 0.4:
        hue = hue * rng.uniform(0, 1.8)
    which = rng.random()
    if which < 0.25:
        hue = hue * rng.uniform(0, 0.15)
    elif which < 0.5:
        chosen = hue[mask][int(rng.integers(np.count_nonzero(mask)))]
        like = np.exp(-(np.abs(hue - chosen).max(-1, keepdims=True) / rng.uniform(0.1, 0.4)) ** 2)
        hue = hue * (1 - like * rng.uniform(0.85, 1))
    if rng.random() < 0.4:
        value = middle + (value - middle) * rng.uniform(0.1, 1.6)
    if rng.random() < 0.4:
        hue = hue + rng.normal(0, 0.25) * AXIS * (value - middle)
    if rng.random() < 0.3:
        import cv2

        grain = cv2.GaussianBlur(rng.normal(size=value.shape[:2]), (0, 0), rng.uniform(0.5, 2.5))
        value = value + (rng.uniform(0.02, 0.2) / grain.std()) * grain[..., None]
    paint = np.exp(value + hue)
    paint = paint * min(1.0, 0.9 / np.percentile(paint[mask], 99.5))
    paint = np.where(mask[..., None], np.clip(paint, 0.01, 0.95), 1).astype(np.float32)
    return {**sample, "R": paint}


def plain(sample, rng):
    """The sample with one paint on everything, or on everything but what is like one of its pixels, and with little of the contrast that paint had:
    all edges are of light. Half of what is indoors stands alone before black, as objects of a studio do. Its kind is "plain"."""
    import cv2

    mask = sample["mask"] > 0
    paint = np.log(np.maximum(sample["R"], 1e-3))
    value = paint.mean(-1, keepdims=True)
    one = rng.uniform(np.log(0.1), np.log(0.8)) + rng.normal(0, 0.25 * (rng.random() < 0.6), 3)
    left = rng.uniform(0, 0.15)
    if rng.random() < 0.5:
        chosen = paint[mask][int(rng.integers(np.count_nonzero(mask)))]
        left = np.maximum(left, np.exp(-((np.abs(paint - chosen).max(-1, keepdims=True) / rng.uniform(0.05, 0.3)) ** 2)))
    paint = one + left * (paint - value[mask].mean())
    result = {**sample, "meta": {**sample["meta"], "kind": "plain"}}
    indoors = all(group["kind"] != "sky" for group in sample["meta"]["groups"])
    if indoors and rng.random() < 0.5:
        near = (sample["Z"] < np.percentile(sample["Z"][mask], rng.uniform(30, 70))).astype(np.uint8)
        count, parts, sizes, _ = cv2.connectedComponentsWithStats(near)
        seen = parts == (1 + np.argmax(sizes[1:, cv2.CC_STAT_AREA]) if count > 1 else -1)
        if (seen & mask).mean() > 0.2:
            mask = seen & mask
            result |= {"S": sample["S"] * seen[..., None].astype(np.float32), "mask": mask.astype(sample["mask"].dtype)}
    paint = np.clip(np.exp(paint), 0.01, 0.95)
    return {**result, "R": np.where(mask[..., None], paint, 1).astype(np.float32)}


def colors(kinds, rng):
    """A color for each light, lights × 3, green about 1; and the temperatures in K."""
    kelvin = [1e6 / rng.uniform(1e6 / TEMPERATURES[k][1], 1e6 / TEMPERATURES[k][0]) for k in kinds]  # even in mired
    if rng.random() < 0.3:  # two windows show the same sky, lamps of a room are of one kind
        kelvin = [kelvin[kinds.index(k)] for k in kinds]
    if rng.random() < 0.06:
        kelvin = [kelvin[0]] * len(kinds)
    tint = np.exp(np.array([[0, 1, 0]]) * rng.normal(0, 0.015, (len(kinds), 1)))  # lamps are not black bodies
    return np.array([planck(k) for k in kelvin]) * tint, kelvin


def strengths(kinds, rng):
    """Flux of each light, relative to the others."""
    flux = np.exp(rng.uniform(np.log(0.15), np.log(1.0), len(kinds)))
    for i, kind in enumerate(kinds):
        if kind == "sun":
            flux[i] = np.exp(rng.uniform(np.log(0.3), np.log(5.0))) * (flux[kinds.index("sky")] if "sky" in kinds else 1)
    if "window" in kinds and "lamp" in kinds and rng.random() < 0.4:  # lamps only fill what the day leaves dark
        flux *= [rng.uniform(2, 6) if k == "window" else 1 for k in kinds]
    if rng.random() < 0.14:  # one light alone: overcast, a lamp at night
        only = kinds.index("sky") if "sky" in kinds and rng.random() < 0.7 else int(rng.integers(len(kinds)))
        flux = np.where(np.arange(len(kinds)) == only, flux, 0)
    return flux


CLEAR = 0.9  # transmission from which on R and E are true


def weather(picture, sample, color, rng):
    """An outdoor picture with a sky that is bluer and darker above than at the horizon, and with haze of about its color. `color`: of the sky's
    light. Returns the picture and the share of light that haze lets through."""
    sky = sample["Z"] > 1e4
    blue = np.log(color) - np.log(color).mean()
    if rng.random() < 0.7:
        above, below = rng.uniform(0, 1.5), rng.uniform(-0.8, 0.3)
        more = np.linspace(above, below, len(sky))[:, None, None] * blue
        more = more + np.linspace(np.log(rng.uniform(0.25, 1)), 0, len(sky))[:, None, None]
        picture = np.where(sky[..., None], picture * np.exp(more), picture)
    if rng.random() < 0.3:
        return picture, np.ones(sky.shape, np.float32)
    near = np.median(sample["Z"][sample["mask"] > 0])  # stays clear
    reach = max(np.exp(rng.uniform(np.log(60), np.log(4000))), near / -np.log(CLEAR))  # m
    clear = np.where(sky, 1, np.exp(-np.minimum(sample["Z"], 1e4) / reach)).astype(np.float32)
    seen = picture[sky] if sky.mean() > 0.02 else picture[sample["mask"] > 0]
    air = np.median(seen.mean(-1)) * rng.uniform(0.5, 1.1) * np.exp(rng.uniform(0, 1.3) * blue)
    return picture * clear[..., None] + air * (1 - clear[..., None]), clear


def expose(picture, mask, rng):
    """The factor that puts a high percentile of the surfaces near white, and sometimes far from it."""
    level = np.percentile(picture.max(-1)[mask > 0], rng.uniform(93, 99.7))
    return np.exp(rng.normal(np.log(0.85), 0.25)) / max(level, 1e-9)


def photograph(picture, rng):
    """8-bit sRGB of linear values: lens blur, sensor noise, clipping."""
    return np.round(255 * srgb(sensed(picture, rng))).astype(np.uint8)


def sensed(picture, rng):
    """Linear values with lens blur and sensor noise."""
    import cv2

    sigma = max(0.0, rng.normal(0.25, 0.35))
    if sigma > 0.15:
        picture = cv2.GaussianBlur(picture.astype(np.float32), (0, 0), sigma)
    shot, read = (np.exp(rng.uniform(np.log(1e-5), np.log(1e-3))), np.exp(rng.uniform(np.log(2e-4), np.log(4e-3)))) if rng.random() < 0.8 else (0, 0)
    return picture + rng.normal(size=picture.shape) * np.sqrt(shot * np.maximum(picture, 0) + read**2)


class Camera:
    """What cameras and video do to a picture and a program cannot undo: a tone curve and compression, drawn by rng, and noise. The curve is a power
    `contrast` of linear values, which R and E have as well, so that I = R E, and a slight S in sRGB, with which I = R E holds nearly."""

    def __init__(self, rng, noise):
        self.rng, self.noise = rng, noise
        kind = rng.random()
        self.contrast = 1.0 if kind < 0.35 else rng.uniform(1.12, 1.3) if kind > 0.85 else float(np.clip(rng.normal(1.03, 0.06), 0.88, 1.15))
        self.bend = rng.uniform(-0.05, 0.15) if rng.random() < 0.5 else 0.0
        self.black = rng.uniform(0, 0.025) if rng.random() < 0.2 else 0.0

    def curve(self, encoded):
        """The S of values 0…1 in sRGB, and a lifted black."""
        return self.black + (1 - self.black) * (encoded - self.bend * np.sin(2 * np.pi * encoded) / (2 * np.pi))

    def photograph(self, picture):
        """8-bit sRGB of linear values."""
        encoded = srgb(np.maximum(sensed(picture, self.noise), 0) ** self.contrast)
        return self.compressed(np.round(255 * self.curve(encoded)).astype(np.uint8))

    def compressed(self, image):
        """As JPEG, rarely as a small video scaled up, or as it is."""
        import cv2
        from PIL import Image

        rng, (height, width) = self.rng, image.shape[:2]
        kind = rng.random()
        if kind > 0.75:
            return image
        quality, halved = int(rng.integers(40, 96)), rng.random() < 0.7  # of color, across and down
        if kind > 0.65:
            scale = rng.uniform(0.5, 0.85)
            small = cv2.resize(image, (int(width * scale), int(height * scale)), interpolation=cv2.INTER_AREA)
            image = cv2.resize(small, (width, height), interpolation=cv2.INTER_LINEAR if rng.random() < 0.5 else cv2.INTER_CUBIC)
            quality, halved = int(rng.integers(40, 75)), True
        file = io.BytesIO()
        Image.fromarray(image).save(file, "jpeg", quality=quality, subsampling=2 if halved else 0)
        return np.asarray(Image.open(file).convert("RGB"))


def mix(sample, seed, size=1, k=None, bend=0.4, camera=None, change=None):
    """One photograph of a sample, at 1/size of its resolution. k: bends the light to this slope; without it a share `bend` of the
    photographs is bent to a slope drawn as real ones are distributed, wider than lights and bounces alone make them. camera: the seed of
    a tone curve and compression; then mask is 0 where the image is clipped. change: a generator; the picture is that without it, but for
    the strengths of the lights and the noise. Returns a dict of
    image   height × width × 3, 8-bit sRGB
    I       the same, linear 0…1, as a program gets it
    R, E    reflectance and light, linear: I = R E before haze, blur, noise, the S of the curve, clipping, rounding and compression, also
            where mask is 0
    mask    1 where R and E are true, and haze is thin
    weight  of pixels in the slope: true, and neither clipped nor black
    k, m_rms, axis, g   of slope();  bent, kelvin, flux, balance   what was drawn"""
    rng = np.random.default_rng([seed, sample["meta"]["seed"]])
    sample = shrink(sample, size)
    kinds = [g["kind"] for g in sample["meta"]["groups"]]
    color, kelvin = colors(kinds, rng)
    flux = strengths(kinds, rng)
    if change:
        flux = flux * np.exp(change.normal(0, 0.4, len(flux)))
    light = np.einsum("l,lc,lhwc->hwc", flux, color, sample["S"]).astype(np.float32)
    # white balance: between the colors of the lights that are on, nearer to the strong
    share = rng.dirichlet(0.3 + 2 * flux / flux.sum()) * (flux > 0)
    balance = np.exp(-(share[:, None] * np.log(color)).sum(0) / share.sum() + rng.normal(0, 0.04, 3))
    light *= balance / balance.mean()
    mask, reflectance = sample["mask"], sample["R"]
    light = np.maximum(light, 1e-6 * light[mask > 0].mean())
    draw = rng.uniform(-1.4, 0.6) if kinds.count("sky") == 0 else rng.uniform(-0.2, 0.7)
    if k is None and rng.random() < bend and np.count_nonzero(flux) > 1:
        k = draw
    if k is not None:
        light = with_slope(light, mask.astype(np.float32), k)
    light *= expose(reflectance * light, mask, rng)
    picture = reflectance * light
    if "sky" in kinds and flux[kinds.index("sky")] > 0:
        picture, clear = weather(picture, sample, color[kinds.index("sky")] * balance, rng)
        mask = mask * (clear > CLEAR)
    weight = ((mask > 0) & (picture.max(-1) < 1) & (picture.max(-1) > 0.004)).astype(np.float32)
    if weight.sum() < 0.3 * weight.size:
        weight = mask.astype(np.float32)
    if camera is not None:
        lens = Camera(np.random.default_rng([camera, sample["meta"]["seed"], 1]), change or rng)
        image = lens.photograph(picture)
        reflectance, light = reflectance**lens.contrast, light**lens.contrast
        seen = (image.max(-1) < 255) & (image.max(-1) > 0)
        mask, weight = (mask * seen).astype(np.uint8), weight * seen
    else:
        image = photograph(picture, change or rng)
    return {
        "image": image,
        "I": linear(image / 255).astype(np.float32),
        "R": reflectance,
        "E": light,
        "mask": mask,
        "weight": weight,
        **slope(light, weight if weight.any() else np.ones_like(weight)),
        "bent": k is not None,
        "kelvin": kelvin,
        "flux": flux.tolist(),
        "balance": balance.tolist(),
        "meta": sample["meta"],
    }

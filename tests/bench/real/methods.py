# SPDX-License-Identifier: LGPL-2.1-or-later
"""What is measured: functions from a picture (height x width x 3, uint8, sRGB, BGR as OpenCV reads it) to its reflectance (linear, BGR)."""
import gi
import numpy as np
import scipy.fft

gi.require_version("Gst", "1.0")
from gi.repository import Gst  # noqa: E402

TIMEOUT = 300 * Gst.SECOND  # of a picture, kernels included
EPSILON = 1e-3  # of linear light, before its logarithm


class Failed(Exception):
    """An element that gives no reflectance, and why."""


def linear(codes):
    """sRGB of 8 bits → linear light, 0 to 1."""
    x = codes / 255.0
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


def srgb(light):
    """Linear light → sRGB of 8 bits, clipped."""
    x = np.clip(light, 0, 1)
    return np.uint8(np.round(255 * np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)))


def integrated(right, down):
    """The plane of mean 0 whose differences are nearest to these (height x width - 1, height - 1 x width), by least squares: Poisson's equation with
    free borders, solved in cosines."""
    height, width = right.shape[0], down.shape[1]
    divergence = np.zeros((height, width))
    divergence[:, :-1] -= right
    divergence[:, 1:] += right
    divergence[:-1] -= down
    divergence[1:] += down
    waves = [2 - 2 * np.cos(np.pi * np.arange(n) / n) for n in (height, width)]
    scale = waves[0][:, None] + waves[1]
    scale[0, 0] = 1
    spectrum = scipy.fft.dctn(divergence, norm="ortho") / scale
    spectrum[0, 0] = 0
    return scipy.fft.idctn(spectrum, norm="ortho")


def retinex(picture, gray, chroma=None):
    """Retinex (Grosse et al. 2009, section 4): steps of mean ln I above `gray`, or with color those of chroma above `chroma`, are of reflectance."""
    logs = np.log(np.maximum(linear(picture), EPSILON))
    mean = logs.mean(2)
    steps = []
    for axis in (1, 0):
        step = np.diff(mean, axis=axis)
        paint = np.abs(step) > gray
        if chroma is not None:
            paint |= np.linalg.norm(np.diff(logs - mean[..., None], axis=axis), axis=-1) > chroma
        steps.append(np.where(paint, step, 0))
    return np.exp(logs - (mean - integrated(*steps))[..., None])


BASELINES = {
    "constant shading": linear,
    "R = I / max I": lambda picture: linear(picture) / np.maximum(linear(picture).max(2, keepdims=True), 1e-6),
    "gray Retinex .1": lambda picture: retinex(picture, 0.1),
    "color Retinex .5, .1": lambda picture: retinex(picture, 0.5, 0.1),
}


def element(line):
    """Elements of a launch line, a fresh pipeline for each picture, so that none begins from another's solution."""

    def reflectance(picture):
        height, width = picture.shape[:2]
        pipeline = Gst.parse_launch(
            f"appsrc name=in format=time caps=video/x-raw,format=RGBA,width={width},height={height},framerate=1/1,colorimetry=sRGB ! {line} ! "
            "intrinsicsplit name=split encoding=linear split.reflectance ! queue ! video/x-raw,format=RGBA64_LE ! appsink name=out sync=false")
        try:
            frame = np.concatenate([picture[..., ::-1], np.full((height, width, 1), 255, np.uint8)], 2)
            buffer = Gst.Buffer.new_wrapped(frame.tobytes())
            buffer.pts, buffer.duration = 0, Gst.SECOND
            pipeline.set_state(Gst.State.PLAYING)
            pipeline.get_by_name("in").emit("push-buffer", buffer)
            pipeline.get_by_name("in").emit("end-of-stream")
            sample = pipeline.get_by_name("out").emit("try-pull-sample", TIMEOUT)
            if sample is None:
                error = pipeline.get_bus().pop_filtered(Gst.MessageType.ERROR)
                raise Failed(f"{line}: {error.parse_error()[0].message if error else 'no frame came'}")
            data = sample.get_buffer().extract_dup(0, 8 * height * width)
            return np.frombuffer(data, "<u2").reshape(height, width, 4)[..., 2::-1] / 65535
        finally:
            pipeline.set_state(Gst.State.NULL)

    return reflectance


def methods(elements):
    """The baselines and elements, by their names."""
    Gst.init(None)
    return {**BASELINES, **{line: element(line) for line in elements}}

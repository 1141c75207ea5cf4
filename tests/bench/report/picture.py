# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the figures look like: layers of a scene by each method, as one picture."""
import matplotlib.pyplot as plt
import numpy as np

import plots


def read_flat(path):
    """Frames of a flat dump: frames x height x width x channels."""
    with open(path, "rb") as file:
        width, height, channels, frames = (int(w) for w in file.readline().split()[1:5])
        return np.fromfile(file, np.float32).reshape(frames, height, width, channels)


def display(values, scale):
    v = np.clip(values * scale, 0, 1)
    v = np.where(v <= 0.0031308, 12.92 * v, 1.055 * np.maximum(v, 1e-9) ** (1 / 2.4) - 0.055)
    return v if v.shape[-1] == 3 else np.repeat(v, 3, 2)


def fitted(values, truth):
    """The scale at which an estimate is nearest to the truth."""
    return float((values * truth).sum() / max((values * values).sum(), 1e-9))


def layers(scene_path, columns, folder, name):
    """`columns` are (title, dump or None for the truth)."""
    truth = read_flat(scene_path)[0]
    inside = truth[..., 7:8]
    reflectance, shading = truth[..., 3:6] * inside, truth[..., 6:7] * inside
    scales = [1 / np.percentile(v, 99.5) for v in (reflectance, shading)]
    figure, axes = plt.subplots(2, len(columns) + 1, figsize=(2.05 * (len(columns) + 1), 3.35))
    axes[0][0].imshow(display(truth[..., :3], 1))
    axes[0][0].set_title("frame", fontsize=8, fontweight="normal", loc="center")
    for column, (title, path) in enumerate(columns, 1):
        if path is None:
            found = [reflectance, shading]
        else:
            dump = read_flat(path)[0]
            found = [dump[..., :3] * inside, dump[..., 3:4] * inside]
        for row, (values, true, scale) in enumerate(zip(found, (reflectance, shading), scales)):
            axes[row][column].imshow(display(values, fitted(values, true) * scale))
        axes[0][column].set_title(title, fontsize=8, fontweight="normal", loc="center")
    for ax in axes.flat:
        ax.axis("off")
    axes[1][0].text(0.98, 0.5, "shading →", fontsize=9, ha="right", va="center", transform=axes[1][0].transAxes)
    axes[1][0].text(0.98, 0.95, "↗ reflectance", fontsize=9, ha="right", va="top", transform=axes[1][0].transAxes)
    figure.subplots_adjust(0.01, 0.01, 0.99, 0.92, 0.03, 0.03)
    figure.savefig(folder / f"{name}.jpg", dpi=110, pil_kwargs={"quality": 88})
    plots.plt.close(figure)

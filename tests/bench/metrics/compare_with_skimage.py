#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Compares the program `metrics` with scikit-image where both have the same measure: MSE, PSNR, SSIM.

    compare_with_skimage.py METRICS            compares; where scikit-image is not installed, with the committed values
    compare_with_skimage.py METRICS --write    renews the committed values (skimage_values.json), which name the version

Images are made by a small generator in here, so that the values need no images beside them.
"""
import json
import pathlib
import struct
import subprocess
import sys
import tempfile

VALUES = pathlib.Path(__file__).with_name("skimage_values.json")
TOLERANCE = 1e-6  # relative; the images are float32


def random_image(seed, width, height, channels, smoothness):
    """Values in 0..1, row by row: noise of a linear congruential generator, averaged along rows."""
    state = seed
    values = []
    for y in range(height):
        for x in range(width):
            for c in range(channels):
                state = (state * 1664525 + 1013904223) % 2**32
                noise = state / 2**32
                before = values[-channels * 1] if x else 0.5
                values.append(smoothness * before + (1 - smoothness) * noise)
    return [struct.unpack("<f", struct.pack("<f", v))[0] for v in values]


def cases():
    for name, width, height, channels, mix in [
        ("gray", 40, 30, 1, 0.5), ("color", 33, 47, 3, 0.3), ("near", 64, 21, 3, 0.02), ("least", 11, 11, 1, 0.7)]:
        truth = random_image(len(name) * 7919, width, height, channels, 0.6)
        noise = random_image(len(name) * 104729, width, height, channels, 0.2)
        yield name, (width, height, channels), [(1 - mix) * t + mix * n for t, n in zip(truth, noise)], truth


def write(path, size, values):
    width, height, channels = size
    path.write_bytes(f"F32 {width} {height} {channels} 1\n".encode() + struct.pack(f"<{len(values)}f", *values))


def ask_skimage():
    import numpy
    import skimage
    from skimage import metrics
    answers = {}
    for name, (width, height, channels), estimate, truth in cases():
        a, b = (numpy.float32(v).astype(numpy.float64).reshape(height, width, channels) for v in (estimate, truth))
        answers[name] = {
            "mse": metrics.mean_squared_error(b, a),
            "psnr": metrics.peak_signal_noise_ratio(b, a, data_range=1),
            "ssim": metrics.structural_similarity(b, a, data_range=1, gaussian_weights=True, sigma=1.5,
                                                  use_sample_covariance=False, channel_axis=2)}
    return {"scikit-image": skimage.__version__, "values": answers}


def ask_metrics(program):
    answers = {}
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for name, size, estimate, truth in cases():
            write(folder / "a.f32", size, estimate)
            write(folder / "b.f32", size, truth)
            text = subprocess.run([program, folder / "a.f32", folder / "b.f32"], check=True, stdout=subprocess.PIPE).stdout
            answers[name] = json.loads(text)
    return answers


def main():
    program, *options = sys.argv[1:]
    if options == ["--write"]:
        VALUES.write_text(json.dumps(ask_skimage(), indent=1) + "\n")
    committed = json.loads(VALUES.read_text())
    sources = {f"scikit-image {committed['scikit-image']} (committed)": committed["values"]}
    try:
        live = ask_skimage()
        sources[f"scikit-image {live['scikit-image']}"] = live["values"]
    except ImportError:
        print("scikit-image is not installed: compared with the committed values only")
    ours = ask_metrics(program)
    failed = 0
    for source, answers in sources.items():
        for name, measures in answers.items():
            for measure, expected in measures.items():
                got = ours[name][measure]
                if not abs(got - expected) <= TOLERANCE * max(abs(expected), 1e-3):
                    print(f"{name} {measure}: {got}, {source} says {expected}")
                    failed += 1
    print(f"{failed} differences")
    sys.exit(1 if failed else 0)


main()

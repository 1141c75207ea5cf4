#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Sanity of examples, derivative, networks and resumption, in seconds: check.py. Stops at what is off."""
import json
import pathlib
import tempfile
import types

import numpy as np
import torch

import networks
import pictures
import problem
import train


def expect(ok, text):
    print(("ok    " if ok else "WRONG ") + text)
    if not ok:
        raise SystemExit(1)


def converged(example, fields):
    for _ in range(12):  # each solve goes on from the last
        loss, slope = example.loss(fields, (1, 0.5, 1))
    return loss, slope


def twin_of_drawing():
    """One of two pictures of a drawing; the other one is solved."""
    first, second, _ = (problem.of_picture(*picture) for picture in pictures.drawn(4, None, True))
    first.twin = second
    converged(second, np.zeros((problem.FIELDS, *second.size), np.float32))
    return first


def check_derivative():
    for example in (problem.of_seed(1001, 176, 132, 1), twin_of_drawing()):
        zero = np.zeros((problem.FIELDS, *example.size), np.float32)
        _, slope = converged(example, zero)
        for group in (slice(0, 4), slice(4, 8), slice(8, 11)):
            way = zero.copy()
            way[group] = slope[group] / np.linalg.norm(slope[group])
            step = 4.0  # well above what solves leave
            measured = (converged(example, step * way)[0] - converged(example, -step * way)[0]) / (2 * step)
            stated = float((slope * way).sum())  # differs where a weight is at its limit, so that it may come back from there
            expect(abs(measured - stated) < 0.15 * stated, f"derivative by fields {group.start} to {group.stop - 1}: {measured:.4f} by differences, {stated:.4f}")


def check_local_derivative():
    rng = np.random.default_rng(0)
    for example in (problem.of_seed(1001, 128, 96, 1), twin_of_drawing()):
        fields = rng.normal(size=(problem.FIELDS, *example.size)).astype(np.float32)
        _, slope = example.local_loss(fields)
        for group in (slice(0, 4), slice(4, 8), slice(9, 10)):
            way = np.zeros_like(fields)
            way[group] = slope[group] / np.linalg.norm(slope[group])
            measured = (example.local_loss(fields + 0.1 * way)[0] - example.local_loss(fields - 0.1 * way)[0]) / 0.2
            stated = float((slope * way).sum())
            expect(abs(measured - stated) < 0.01 * stated, f"derivative of the local loss: {measured:.5f} by differences, {stated:.5f}")


def check_networks():
    for width in networks.WIDTHS:
        network = networks.Prior(width)
        answer = network(torch.randn(1, networks.INPUTS, 96, 128))
        expect(tuple(answer.shape) == (1, networks.OUTPUTS, 48, 64) and not answer.any(), f"{width}: {networks.parameters(network)} parameters, starts at the fitted prior")
    picture, narrow = torch.randn(1, networks.INPUTS, 96, 128), networks.Prior("small")
    torch.nn.init.normal_(narrow.head.weight)
    apart = (networks.grown(narrow, "large")(picture) - narrow(picture)).abs().max() / narrow(picture).abs().max()
    expect(apart < 1e-5, f"a small network that is grown to a large one answers alike: within {float(apart):.1e}")
    fields = problem.fields_of(torch.full((1, 44, 8, 8), 1e9))
    expect(fields.shape == (1, 11, 16, 16) and torch.allclose(fields.amax((0, 2, 3)), problem.LIMITS), "fields saturate at their limits")


def check_run():
    options = {"width": "small", "rate": 2e-3, "seed": 1, "start": None, "batch": 2, "equal": 1.0, "different": 0.5, "alike": 1.0, "every": 2, "device": "cpu", "steady": 1.0, "small": 0.3, "local": 0.3, "local_only": False}
    with tempfile.TemporaryDirectory() as folder:
        tests = [pictures.procedural(pictures.HELD_OUT_SEEDS)]
        for steps in (2, 4):
            pool = pictures.Pool([], None, (0, 0.5), 4, 1)
            pool.fill()
            train.Run(types.SimpleNamespace(out=pathlib.Path(folder), steps=steps, **options)).train(pool, tests)
            pool.stop()
        seen = [json.loads(line)["step"] for line in (pathlib.Path(folder) / "log.jsonl").read_text().splitlines()]
        expect(seen == [0, 2, 4], f"a run continues where it stopped: {seen}")


if __name__ == "__main__":
    problem.LIBRARY = problem.load()
    check_derivative()
    check_local_derivative()
    check_networks()
    check_run()

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
import mix  # of ../intrinsic, which pictures adds to the path
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
        for group in ([0, 2], [1]):
            way = zero.copy()
            way[group] = slope[group] / np.linalg.norm(slope[group])
            step = 4.0  # well above what solves leave
            measured = (converged(example, step * way)[0] - converged(example, -step * way)[0]) / (2 * step)
            stated = float((slope * way).sum())  # differs where a weight is at its limit, so that it may come back from there
            expect(abs(measured - stated) < 0.15 * stated, f"derivative by fields {group}: {measured:.4f} by differences, {stated:.4f}")


def check_local_derivative():
    rng = np.random.default_rng(0)
    for example in (problem.of_seed(1001, 128, 96, 1), twin_of_drawing()):
        fields = rng.normal(size=(problem.FIELDS, *example.size)).astype(np.float32)
        _, slope = example.local_loss(fields)
        way = np.zeros_like(fields)
        way[1] = slope[1] / np.linalg.norm(slope[1])
        measured = (example.local_loss(fields + 0.1 * way)[0] - example.local_loss(fields - 0.1 * way)[0]) / 0.2
        stated = float((slope * way).sum())
        expect(abs(measured - stated) < 0.01 * stated, f"derivative of the local loss: {measured:.5f} by differences, {stated:.5f}")


def triple():
    """Of a drawing in two lights, and with ink."""
    (picture, _, light, mask, *_), (lit, _, other, *_), _ = pictures.drawn(4, None, True)
    ink = np.ones_like(picture)
    ink[30:60, 40:90] = 0.3
    inked = picture * ink
    problems = [problem.of_picture(p, p, light / other, mask, k, "couple", 1) for k, p in enumerate((picture, lit, inked))]
    return problem.Triple(problems, 0, other / light, "drawn")


def check_triple_derivatives():
    rng, example = np.random.default_rng(0), triple()
    fields = [0.5 * rng.normal(size=(problem.FIELDS, *p.size)).astype(np.float32) for p in example.pictures]
    for name, weights, near in (("local", (0, 1), 0.02), ("solved", (1, 0), 0.15)):
        def found(fields):
            for _ in range(12 if weights[0] else 1):
                result = example.loss(fields, *weights)
            return result

        slopes = found(fields)[1]
        for k, group in ((1, slice(1, 2)), (0, slice(1, 2)), (2, slice(0, 3))):
            way = [np.zeros_like(f) for f in fields]
            way[k][group] = slopes[k][group] / np.linalg.norm(slopes[k][group])
            step = 4.0 if weights[0] else 0.1
            ends = [found([f + sign * step * w for f, w in zip(fields, way)])[0] for sign in (1, -1)]
            measured, stated = (ends[0] - ends[1]) / (2 * step), float((slopes[k] * way[k]).sum())
            expect(abs(measured - stated) < near * stated, f"derivative of a triple's {name} loss, picture {k}: {measured:.5f} by differences, {stated:.5f}")


def check_networks():
    network = networks.Prior()
    answer = network(torch.randn(1, networks.INPUTS, 96, 128))
    expect(tuple(answer.shape) == (1, networks.OUTPUTS, 48, 64) and not answer.any(), f"{networks.parameters(network)} parameters, starts at the fitted prior")
    logs = torch.tensor([-4.0, -2.0, -0.3])  # ln (linear + FLOOR) of red, green and blue
    m = logs.mean()
    c0, c1 = (logs[0] - logs[1]) * 3**0.5 / 2, 1.5 * (logs[0] + logs[1]) - 3 * m
    guide = torch.stack([m, 2 * c0, 2 * c1, m, (m + 4) / 2, m])[None, :, None, None]
    codes = [2 * float(mix.srgb(float(x.exp()) - networks.FLOOR)) - 1 for x in logs]
    found = network.colors(guide).flatten().tolist()
    expect(np.abs(np.subtract(found, codes)).max() < 0.06, f"the trunk sees sRGB: {found}, {codes}")
    fields = problem.fields_of(torch.full((1, networks.OUTPUTS, 8, 8), 1e9))
    expect(fields.shape == (1, problem.FIELDS, 16, 16) and torch.allclose(fields.amax((0, 2, 3)), torch.tensor(problem.LIMIT)), "fields saturate at their limits")


def check_run():
    options = {"trunk": None, "bf16": False, "rate": 2e-3, "seed": 1, "start": None, "batch": 2, "equal": 1.0, "different": 0.5, "alike": 1.0, "every": 2, "device": "cpu", "steady": 1.0, "small": 0.3, "local": 0.3, "local_only": False}
    with tempfile.TemporaryDirectory() as folder:
        tests = [pictures.procedural(pictures.HELD_OUT_SEEDS)]
        for steps in (2, 4):
            pool = pictures.Pool([], None, (0, 0.5), 4, 1)
            pool.fill()
            train.Run(types.SimpleNamespace(out=pathlib.Path(folder), steps=steps, **options)).train([(pool, 2, 1.0)], tests)
            pool.stop()
        seen = [json.loads(line)["step"] for line in (pathlib.Path(folder) / "log.jsonl").read_text().splitlines()]
        expect(seen == [0, 2, 4], f"a run continues where it stopped: {seen}")


if __name__ == "__main__":
    problem.LIBRARY = problem.load()
    check_derivative()
    check_local_derivative()
    check_triple_derivatives()
    check_networks()
    check_run()

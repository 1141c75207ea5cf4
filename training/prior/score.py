#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Scores networks on examples that no fit saw, beside the fitted prior: score.py STATE… --samples FOLDER… --assets ASSETS. Prints a table: loss
without pairs / WHDR (δ = .1) by kind, shares of light / of paint that reflectance keeps of couples, and how far the fields of two crops are apart relative
to their mean square."""
import argparse
import pathlib

import numpy as np
import torch

import networks
import pictures
import problem
import train


def unsteady(network, examples):
    rng = np.random.default_rng(0)
    torch.manual_seed(0)
    with torch.no_grad():
        inputs = [torch.from_numpy(e.input)[None] for e in examples]
        fields = [problem.fields_of(network(x)) for x in inputs]
        apart = np.mean([float(train.fields_apart(network, x, f, rng)) for x, f in zip(inputs, fields)])
    return apart / max(np.mean([float(problem.mean_square(f)) for f in fields]), 1e-12)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("states", type=pathlib.Path, nargs="*", help="state.pt of runs")
    parser.add_argument("--samples", type=pathlib.Path, nargs="*", default=[])
    parser.add_argument("--assets", type=pathlib.Path)
    parser.add_argument("--couples", type=pathlib.Path, nargs="*", default=[], help="folders of ../couples that no fit saw")
    parser.add_argument("--count", type=int, default=60, help="procedural and drawn examples, each")
    args = parser.parse_args()
    torch.set_num_threads(1)
    problem.LIBRARY = problem.load()
    examples = pictures.held_out(args.samples, args.assets, args.count, args.couples)
    rows = {"fitted": train.evaluate(None, examples)}
    for path in args.states:
        state = torch.load(path, map_location="cpu")
        network = networks.Prior()
        network.load_state_dict(state["average"])
        name = f"{path.parent.name or path.name}, step {state['step']}"
        rows[name] = train.evaluate(network, examples)
        rows[name]["unsteady"] = round(unsteady(network, [e for e in examples if isinstance(e, problem.Problem)][::5]), 4)
    kinds = [k for k in rows["fitted"]]
    print("| | " + " | ".join(f"{k} ({rows['fitted'][k][2]})" for k in kinds) + " | unsteady |\n" + "|---" * (len(kinds) + 2) + "|")
    for name, row in rows.items():
        print(f"| {name} | " + " | ".join(f"{row[k][0]:.4f} / {row[k][1]:.3f}" for k in kinds) + f" | {row.get('unsteady', '')} |")


if __name__ == "__main__":
    main()

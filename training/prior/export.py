#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Writes a run's network (running mean of the weights) as ONNX: export.py RUN/state.pt models/intrinsic/prior.onnx."""
import argparse
import pathlib
import sys

import torch

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
import networks
import onnx_file


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("state", type=pathlib.Path)
    parser.add_argument("model", type=pathlib.Path)
    args = parser.parse_args()
    state = torch.load(args.state)
    network = networks.Prior()
    network.load_state_dict(state["average"])
    shape = (1, networks.INPUTS, 128, 160)
    error = onnx_file.write(network, shape, args.model, names=("guide", "prior"), free_size=True)
    print(f"{args.model}: {networks.parameters(network)} parameters, step {state['step']}, OpenCV's dnn within {error:.1e}")


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: LGPL-2.1-or-later
"""The variants of thesis Table 6.1: what scripts that compare them begin and end with."""
import argparse
import pathlib

import torch

from . import corpus, datasets, scores
from .networks import load_checkpoint
from .tables import table

# Of each: options of Networks, and whether the rendering loss is used.
VARIANTS = {"whole": ({}, True), "no rendering loss": ({}, False), "no MirrorNet": ({"use_mirror": False}, True),
            "regression": ({"regress": True}, True)}


def begin(description, samples):
    """What the command line says, the networks that it names, the corpus, and what is scored on."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=corpus.ROOT / "out/lime")
    parser.add_argument("--checkpoint", type=pathlib.Path, help="of train.py, or a folder of exported networks: models/lime")
    parser.add_argument("--data", type=pathlib.Path, default=datasets.DATA)
    parser.add_argument("--hdri", default=None)
    parser.add_argument("--samples", type=int, default=samples, help="each use of one counts")
    parser.add_argument("--seed", type=int, default=3)
    parser.add_argument("--count", type=int, default=1000, help="held-out samples")
    args = parser.parse_args()
    torch.set_num_threads(2)
    known = load_checkpoint(args.checkpoint or args.out / "checkpoint.pt")
    drawn = corpus.Corpus(args.hdri)
    return args, known, drawn, sets(drawn, args.data, args.count)


def sets(samples, data, count):
    """By title: pictures, and whether their mask is the true one, as in evaluate.py."""
    found = {"Held-out shapes and maps": (datasets.synthetic(samples, datasets.CHOICES, count), False)}
    if (data / "materials").is_dir():
        found["`materials`, Blinn-Phong"] = (datasets.materials(data / "materials"), False)
    if (data / "materials/cycles_ggx").is_dir():
        found["`materials`, GGX path-traced"] = (datasets.ggx(data / "materials/cycles_ggx"), True)
    return found


def report(variants, of, path, layers=False):
    """Prints and writes Markdown: variants (networks by name) on the sets `of`, beside the best constant; with `layers`, also
    what differs there."""
    parts = []
    for title, (items, true_mask) in of.items():
        found = {name: scores.predict(networks, items, true_mask=true_mask) for name, networks in variants.items()}
        rows = {name: scores.score(items, predictions) for name, predictions in found.items()}
        constant = rows["constant"] = scores.baselines(items)["constant"]
        if items[0].alpha is not None:
            count = len(items)
            found["constant"] = [{"diffuse": sum(i.diffuse for i in items) / count, "alpha": sum(i.alpha for i in items) / count}] * count
            for name, predictions in found.items():
                rows[name]["rendered_mse"] = scores.rendered_error(
                    items, [p["diffuse"] for p in predictions], [p["alpha"] for p in predictions])
        needed = set(constant) | ({"layer_mse", "layer_relative", "layer_code"} if layers else set())
        parts.append(f"### {title} ({len(items)})\n\n" + table(rows, needed))
    text = "\n\n".join(parts) + "\n"
    print(text)
    path.write_text(text)

# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a training leaves behind: its checkpoint, and its log, a JSON object a line."""
import json
import pathlib


def keep(checkpoint, args):
    """Ends the program where a training that begins would take the place of another one's checkpoint."""
    if checkpoint.exists() and not args.resume and not args.overwrite:
        raise SystemExit(f"{checkpoint} is there already: --resume goes on with it, --overwrite begins anew, --out takes another folder")


def read(path):
    """All records but for lines that a power cut has left incomplete."""
    found = []
    with open(path, encoding="utf-8") as file:
        for line in file:
            try:
                found.append(json.loads(line))
            except json.JSONDecodeError:
                pass
    return found


def cut(path, minutes):
    """Takes back what was written behind so many minutes of training, to go on from there."""
    path = pathlib.Path(path)
    if not path.exists():
        return
    kept = [r for r in read(path) if r.get("minutes", 0) <= minutes + 1e-3]
    new = path.with_suffix(".new")
    new.write_text("".join(json.dumps(r) + "\n" for r in kept), encoding="utf-8")
    new.replace(path)

"""The log of a training: a JSON object a line."""
import json
import pathlib


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

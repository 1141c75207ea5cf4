"""The log of a training: a JSON object a line."""
import json
import pathlib


def read(path):
    """All records but a last line that a power cut has left incomplete. Raises ValueError for another that is none."""
    lines = pathlib.Path(path).read_text(encoding="utf-8").splitlines()
    found = []
    for number, line in enumerate(lines, 1):
        try:
            found.append(json.loads(line))
        except json.JSONDecodeError as error:
            if number < len(lines):
                raise ValueError(f"{path}, line {number}: no record") from error
    return found


def cut(path, minutes):
    """Takes back what was written behind so many minutes of training, to go on from there."""
    path = pathlib.Path(path)
    if not path.exists():
        return
    kept = [r for r in read(path) if r.get("minutes", 0) <= minutes + 1e-3]
    path.write_text("".join(json.dumps(r) + "\n" for r in kept), encoding="utf-8")

"""The log of a training: a JSON object a line."""
import json


def read(path):
    """All records but for a line that a power cut has left incomplete."""
    found = []
    with open(path, encoding="utf-8") as file:
        for line in file:
            try:
                found.append(json.loads(line))
            except json.JSONDecodeError:
                pass
    return found

# SPDX-License-Identifier: LGPL-2.1-or-later
"""Properties that are a list in JSON, alone or beside the size of the frame that it is for: {"frame": [w, h], NAME: [...]}."""
import json


def entries(text, name):
    """The entries of the property NAME; none of an empty text."""
    data = json.loads(text) if text else []
    return data[name] if isinstance(data, dict) else data


def with_entries(text, name, changed):
    """The property with other entries, for the same frame."""
    data = json.loads(text) if text else []
    return json.dumps({**data, name: changed} if isinstance(data, dict) else changed, separators=(",", ":"))

# SPDX-License-Identifier: LGPL-2.1-or-later
"""Which project files may do more than show pictures: those of which the user said so."""
import hashlib
import json
import os

from gi.repository import GLib
from inverse_common import files

_MAX = 1000  # that are remembered


def folder():
    """Where the program keeps what it remembers between runs."""
    return os.path.join(os.environ.get("XDG_STATE_HOME") or os.path.join(GLib.get_home_dir(), ".local", "state"), "gst-inverse")


def _path():
    return os.path.join(folder(), "allowed")


def _digest(demands):
    return hashlib.sha256(json.dumps(demands).encode()).hexdigest()


def _remembered():
    try:
        with open(_path(), encoding="ascii") as file:
            return file.read().split()
    except (OSError, ValueError):
        return []


def is_allowed(demands):
    """Whether the user once allowed all of this together (project.demands)."""
    return not demands or _digest(demands) in _remembered()


def allow(demands):
    """Remembers that the user allowed it. Raises OSError."""
    os.makedirs(folder(), mode=0o700, exist_ok=True)
    kept = [known for known in _remembered() if known != _digest(demands)][-_MAX:]
    files.write(_path(), "\n".join([*kept, _digest(demands), ""]), mode=0o600)

# SPDX-License-Identifier: LGPL-2.1-or-later
"""Edits that are not saved: each step is written to a file, which a later run of the program can go on with."""
import contextlib
import fcntl
import glob
import json
import os
import tempfile
import time

from inverse_common import files

from . import elements, project, trust

MAX_LEFT = 10  # that are kept of earlier runs


class Autosave:
    """The unsaved edits of this run."""

    def __init__(self):
        self._path, self._lock = None, None

    def keep(self, made):
        """Writes a project. Raises OSError."""
        if not self._path:
            folder = os.path.join(trust.folder(), "unsaved")
            os.makedirs(folder, mode=0o700, exist_ok=True)
            self._lock, lock = tempfile.mkstemp(prefix=time.strftime("%Y%m%d-%H%M%S-"), suffix=".json.lock", dir=folder)
            fcntl.flock(self._lock, fcntl.LOCK_EX)
            self._path = lock.removesuffix(".lock")
        files.write(self._path, json.dumps(project.to_data(made)), mode=0o600)

    def saved(self):
        """The project is in a file of its own, or as it was in the beginning."""
        if self._path:
            discard(self._path)
            os.close(self._lock)
            self._path = self._lock = None


def left():
    """Files that ended runs left, the newest first. Old ones beyond MAX_LEFT are removed."""
    found = [path for path in sorted(glob.glob(os.path.join(glob.escape(trust.folder()), "unsaved", "*.json")), reverse=True) if _is_left(path)]
    for path in found[MAX_LEFT:]:
        discard(path)
    return found[:MAX_LEFT]


def title(path):
    """What such a file has, for people."""
    try:
        source = project.load(path).source
    except (OSError, elements.ElementError):
        return None
    when = time.strftime("%d %B, %H:%M", time.localtime(os.path.getmtime(path)))
    return f"{os.path.basename(source) or 'a video'} ({when})"


def discard(path):
    """Removes such a file."""
    for name in (path, path + ".lock"):
        with contextlib.suppress(OSError):
            os.unlink(name)


def _is_left(path):
    """Whether the run that wrote it has ended."""
    try:
        with open(path + ".lock", "r+b") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return True
    except FileNotFoundError:
        return True
    except OSError:
        return False

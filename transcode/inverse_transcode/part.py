# SPDX-License-Identifier: LGPL-2.1-or-later
"""What is written before it is complete: hidden, beside the result, under a lock."""
import fcntl
import glob
import os
import shutil
import socket
import struct
import tempfile

from inverse_common import files

from .matroska import SEGMENT, find

MAX_NAME = 255  # bytes
MARK = b"written by inverse-transcode"


def remove(path):
    """Removes a file or a folder, if it is there."""
    try:
        shutil.rmtree(path) if os.path.isdir(path) else os.unlink(path)
    except FileNotFoundError:
        pass


def mark(path, matroska):
    """Marks a complete file as a result of this program: by an element at its end that players pass over, Void or `free`."""
    with open(path, "r+b") as file:
        end = file.seek(0, os.SEEK_END)
        file.write((bytes([0xEC, 0x80 | len(MARK)]) if matroska else struct.pack(">I4s", 8 + len(MARK), b"free")) + MARK)
        behind = file.tell()
        file.seek(0)
        for start, stop in find(file, end, (SEGMENT,)) if matroska else ():
            file.seek(start - 8)  # its size
            if stop == end and file.read(1) == b"\1":  # of eight bytes
                file.seek(start - 8)
                file.write(struct.pack(">Q", 1 << 56 | behind - start))
            return


def is_marked(path):
    """Whether a file is a result of this program. Throws OSError."""
    with open(path, "rb") as file:
        file.seek(max(file.seek(0, os.SEEK_END) - len(MARK), 0))
        return file.read() == MARK


def partial_name(output):
    """Of the finished part of a file that was stopped."""
    folder, name = os.path.split(output)
    stem, ending = os.path.splitext(name)
    ending = f".partial{ending}"
    while len(os.fsencode(stem + ending)) > MAX_NAME:
        stem = stem[:-1]
    return os.path.join(folder, stem + ending)


class Part:
    """A file or a folder at `path` for a result that is not complete. Its lock, a file of its own beside it, is held until `close`, and
    ends with the process on whichever host: locks of folders do not leave a host where NFS keeps files. Throws OSError."""

    def __init__(self, output, folder_wanted):
        folder = os.path.dirname(os.path.abspath(output))
        os.makedirs(folder, exist_ok=True)
        files.restore(output)
        prefix = f".{files.key(output)}."
        _remove_left(os.path.join(folder, prefix))
        self._lock, self._lock_path = _new_lock(folder, f"{prefix}{socket.gethostname()[:32]}-{os.getpid()}-")
        self.path = self._lock_path.removesuffix(".lock") + ".part"
        if folder_wanted:
            os.mkdir(self.path)
        else:
            os.close(os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))

    def close(self):
        """Removes what did not get its name, then the lock."""
        remove(self.path)
        remove(self._lock_path)
        os.close(self._lock)


def _new_lock(folder, prefix):
    while True:
        handle, path = tempfile.mkstemp(prefix=prefix, suffix=".lock", dir=folder)
        if _locked(handle) and os.path.exists(path):
            return handle, path
        os.close(handle)  # another process took it for one that was left, before it was locked


def _locked(handle):
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return True
    except OSError:
        return False


def _remove_left(prefix):
    """Removes what killed processes left: whose lock nobody holds. What cannot be locked stays."""
    for lock in glob.glob(glob.escape(prefix) + "*.lock"):
        try:
            handle = os.open(lock, os.O_RDWR)  # NFS locks nothing that is only read
        except OSError:
            continue
        try:
            if _locked(handle):
                remove(lock.removesuffix(".lock") + ".part")
                remove(lock)
        except OSError:
            pass  # of another user
        finally:
            os.close(handle)

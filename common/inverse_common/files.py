# SPDX-License-Identifier: LGPL-2.1-or-later
"""Files and folders that appear whole or not at all, also after a power failure. In C++: common/replace_file.hpp."""
import ctypes
import errno
import hashlib
import os
import shutil
import stat
import tempfile

_AT_FDCWD, _RENAME_EXCHANGE = -100, 2
_LIBC = ctypes.CDLL(None, use_errno=True)


def umask():
    """Of the process."""
    mask = os.umask(0)
    os.umask(mask)
    return mask


def sync(path):
    """Brings a file, or the names in a folder, to the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.EROFS):  # file systems that cannot
            raise
    finally:
        os.close(handle)


def sync_below(folder):
    """Brings all files below a folder to the disk."""
    for base, _, names in os.walk(folder):
        for name in names:
            sync(os.path.join(base, name))
        sync(base)


def key(target):
    """For names beside a file or a folder: its own may be as long as names can be."""
    return hashlib.sha256(os.fsencode(os.path.basename(os.path.abspath(target)))).hexdigest()[:16]


def write(path, content, mode=None):
    """Writes a file (text or bytes), which takes the place of the one before once it is whole; through symbolic links. It gets the
    permissions and, where that is allowed, the group of the one before, or `mode` less the umask. A device or a FIFO stays and gets the
    content. Throws OSError."""
    target = os.path.realpath(path)
    folder = os.path.dirname(target)
    before = os.stat(path) if os.path.exists(path) else None
    data = content if isinstance(content, bytes) else os.fsencode(content)
    if before and not stat.S_ISREG(before.st_mode):
        with open(path, "wb") as written:
            written.write(data)
        return
    handle, part = tempfile.mkstemp(prefix=f".{key(target)}.", suffix=".part", dir=folder)
    try:
        with os.fdopen(handle, "wb") as written:
            written.write(data)
            if before and mode is None:
                try:
                    os.fchown(written.fileno(), -1, before.st_gid)
                except PermissionError:
                    pass  # a group that this user is not in
            os.fchmod(written.fileno(), before.st_mode & 0o7777 if before and mode is None else (mode or 0o666) & ~umask())
            written.flush()
            os.fsync(written.fileno())
        os.replace(part, target)
    except BaseException as error:
        if isinstance(error, OSError):
            error.filename = path  # a full disk names none
        os.unlink(part)
        raise
    sync(folder)


def exchange(one, other):
    """Exchanges the names of two files or folders in one step. Whether the system and the file system can."""
    if not hasattr(_LIBC, "renameat2"):
        return False
    if _LIBC.renameat2(_AT_FDCWD, os.fsencode(one), _AT_FDCWD, os.fsencode(other), _RENAME_EXCHANGE) == 0:
        return True
    failure = ctypes.get_errno()
    if failure in (errno.EINVAL, errno.ENOSYS, errno.ENOTSUP):
        return False
    raise OSError(failure, os.strerror(failure), other)


def _before(target):
    target = os.path.abspath(target)
    return os.path.join(os.path.dirname(target), f".{key(target)}.inverse-before")


def settle(part, target):
    """Gives a file or a folder that is complete its name. What had it before is there until then: a file is replaced, a folder is exchanged
    and removed afterwards. Where a file system cannot exchange, the folder before has another name for a moment: see `restore`. Throws
    OSError."""
    folder = os.path.dirname(os.path.abspath(target))
    if not os.path.isdir(part):
        sync(part)
        os.replace(part, target)
        sync(folder)
        return
    sync_below(part)
    if not os.path.isdir(target):
        os.replace(part, target)
        sync(folder)
        return
    if not exchange(part, target):
        old = _before(target)
        os.rename(target, old)
        try:
            os.rename(part, target)
        except OSError:
            os.rename(old, target)
            raise
        part = old
    sync(folder)
    shutil.rmtree(part)


def restore(target):
    """After `settle` was interrupted: puts the folder before back if the new one did not get its name, else removes it."""
    old = _before(target)
    if not os.path.isdir(old):
        return
    if os.path.exists(target):
        shutil.rmtree(old)
    else:
        os.rename(old, target)

# SPDX-License-Identifier: LGPL-2.1-or-later
"""Files and folders appear whole or not at all, and what is not complete is locked on every host."""
import glob
import os
import shutil
import signal
import stat
import subprocess
import sys
import time
import unittest
from unittest import mock

import case

sys.path.insert(0, str(case.ROOT / "transcode"))
from inverse_transcode import part  # noqa: E402
from inverse_common import files  # noqa: E402

# What Linux does with flock() on files of an NFS server: a lock of bytes, which wants a descriptor to write by; none of folders.
NFS = r"""
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
int flock(int descriptor, int operation) {
  struct stat status;
  if (fstat(descriptor, &status) == 0 && S_ISDIR(status.st_mode)) return 0;
  const int writes = (fcntl(descriptor, F_GETFL) & O_ACCMODE) != O_RDONLY;
  if ((operation & LOCK_EX) && !writes) return errno = EBADF, -1;
  struct flock lock = {.l_type = operation & LOCK_UN ? F_UNLCK : operation & LOCK_EX ? F_WRLCK : F_RDLCK};
  const int result = fcntl(descriptor, operation & LOCK_NB ? F_OFD_SETLK : F_OFD_SETLKW, &lock);
  if (result != 0 && (errno == EACCES || errno == EAGAIN)) errno = EWOULDBLOCK;
  return result;
}
"""


class Files(case.Case):
    def read(self, name):
        with open(self.path(name), encoding="utf-8") as file:
            return file.read()

    def test_a_file_keeps_what_it_was(self):
        os.mkdir(self.path("folder"))
        target, link = self.path("folder/x"), self.path("link")
        files.write(target, "one")
        os.chmod(target, 0o640)
        os.symlink(target, link)
        files.write(link, "two")
        self.assertTrue(os.path.islink(link))
        self.assertEqual((self.read("folder/x"), os.stat(target).st_mode & 0o777), ("two", 0o640))
        self.assertEqual(os.listdir(self.path("folder")), ["x"])
        with mock.patch.object(os, "fsync", side_effect=OSError(28, "No space left")), self.assertRaises(OSError):
            files.write(target, "three")
        self.assertEqual((self.read("folder/x"), os.listdir(self.path("folder"))), ("two", ["x"]))

    def test_names_as_long_as_they_can_be(self):
        for name in ("x" * 255, "\u4e00" * 84, "\u4e00" * 85):
            with self.subTest(name):
                files.write(self.path(name), "one")
                files.write(self.path(name), "two")
                self.assertEqual((self.read(name), os.listdir(self.folder)), ("two", [name]))
                os.unlink(self.path(name))
                os.mkdir(self.path(name))
                os.mkdir(self.path("draft"))
                with mock.patch.object(files, "exchange", return_value=False):
                    files.settle(self.path("draft"), self.path(name))
                self.assertEqual(os.listdir(self.folder), [name])
                os.rmdir(self.path(name))
                partial = part.partial_name(name[:-4] + ".mkv" if name[0] == "x" else name[:-2] + ".mkv")
                self.assertTrue(partial.endswith(".partial.mkv") and len(os.fsencode(partial)) <= 255, partial)

    def test_devices_and_fifos_stay(self):
        os.mkfifo(self.path("fifo"))
        with subprocess.Popen(["cat", self.path("fifo")], stdout=subprocess.PIPE) as reader:
            files.write(self.path("fifo"), "content")
            self.assertEqual(reader.communicate()[0], b"content")
        self.assertTrue(stat.S_ISFIFO(os.stat(self.path("fifo")).st_mode))

    def test_all_is_on_the_disk_before_it_has_its_name(self):
        done, real = [], (os.fsync, os.replace)

        def fsync(descriptor):
            done.append(("sync", os.readlink(f"/proc/self/fd/{descriptor}")))
            real[0](descriptor)

        def replace(one, other):
            done.append(("name", one))
            real[1](one, other)

        with mock.patch.object(os, "fsync", fsync), mock.patch.object(os, "replace", replace):
            files.write(self.path("x"), "x")
            os.makedirs(self.path("draft/deep"))
            files.write(self.path("draft/deep/y"), "y")
            done.clear()
            files.settle(self.path("draft"), self.path("result"))
        named = done.index(("name", self.path("draft")))
        for path in ("draft/deep/y", "draft/deep", "draft"):
            self.assertLess(done.index(("sync", self.path(path))), named, path)
        self.assertGreater(done.index(("sync", self.folder)), named)

    def folders(self):
        for name, text in (("draft", "new"), ("result", "old")):
            os.mkdir(self.path(name))
            files.write(self.path(f"{name}/x"), text)

    def test_a_folder_is_exchanged(self):
        self.folders()
        files.settle(self.path("draft"), self.path("result"))
        self.assertEqual((self.read("result/x"), os.listdir(self.folder)), ("new", ["result"]))

    def test_where_folders_cannot_be_exchanged_a_crash_loses_none(self):
        self.folders()
        real = os.rename
        with mock.patch.object(files, "exchange", return_value=False):
            with mock.patch.object(os, "rename", side_effect=lambda one, other: real(one, other) if one.endswith("result") else sys.exit(9)):
                with self.assertRaises(SystemExit):
                    files.settle(self.path("draft"), self.path("result"))
        self.assertFalse(os.path.exists(self.path("result")))
        files.restore(self.path("result"))
        self.assertEqual((self.read("result/x"), self.read("draft/x")), ("old", "new"))
        with mock.patch.object(files, "exchange", return_value=False):
            files.settle(self.path("draft"), self.path("result"))
        self.assertEqual((self.read("result/x"), os.listdir(self.folder)), ("new", ["result"]))


class Parts(case.Case):
    def left(self):
        return glob.glob(self.path(".*.part")) + glob.glob(self.path(".*.lock"))

    def test_what_is_locked_stays_and_what_a_killed_process_left_goes(self):
        for folder in (False, True):
            first = part.Part(self.path("x"), folder)
            second = part.Part(self.path("x"), folder)
            self.assertTrue(os.path.exists(first.path))
            first.close()
            self.assertTrue(os.path.exists(second.path))
            second.close()
            self.assertEqual(self.left(), [])
            program = "import sys, os; sys.path[:0] = sys.argv[2:]; from inverse_transcode import part; " \
                      f"part.Part(sys.argv[1], {folder}); os.kill(os.getpid(), 9)"
            done = subprocess.run([sys.executable, "-c", program, self.path("x"), str(case.ROOT / "transcode")], check=False)
            self.assertEqual((done.returncode, len(self.left())), (-signal.SIGKILL, 2))
            part.Part(self.path("x"), folder).close()
            self.assertEqual(self.left(), [])

    def test_a_killed_run_on_nfs_is_done_again(self):
        with open(self.path("nfs.c"), "w", encoding="ascii") as file:
            file.write(NFS)
        subprocess.run(["cc", "-shared", "-fPIC", "-o", self.path("nfs.so"), self.path("nfs.c")], check=True)
        environment = {**os.environ, "LD_PRELOAD": self.path("nfs.so")}
        self.clip(frames=600)
        for words in (["-o", "out.mkv"], ["-o", "out", "--to", "png"]):
            with self.subTest(words):
                process = self.start("clip.mkv", *words, "--", "identity", env=environment)
                end = time.monotonic() + case.LIMIT
                while not glob.glob(self.path(".*.part")):
                    self.assertLess(time.monotonic(), end)
                    time.sleep(0.02)
                subprocess.run(["pkill", "-KILL", "-P", str(process.pid)], check=False)
                process.communicate(timeout=case.LIMIT)
                for path in (self.path("out.mkv"), self.path("out")):
                    shutil.rmtree(path) if os.path.isdir(path) else os.path.exists(path) and os.unlink(path)
                self.run_it("clip.mkv", *words, "--", "identity", env=environment)
                self.assertEqual(self.left(), [])


if __name__ == "__main__":
    unittest.main(verbosity=2)

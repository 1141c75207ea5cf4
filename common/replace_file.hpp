// SPDX-License-Identifier: LGPL-2.1-or-later
// Files and folders that appear whole or not at all, also after a power failure. In Python:
// common/inverse_common/files.py.
#pragma once
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include "new_file.hpp"

namespace inverse {

/// Brings a file, or the names in a folder, to the disk. Throws Error(output).
inline void sync_path(const std::filesystem::path& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const int failure = descriptor < 0 ? errno : fsync(descriptor) != 0 ? errno : 0;
  if (descriptor >= 0) close(descriptor);
  if (failure != 0 && failure != EINVAL && failure != EROFS)  // file systems that cannot
    throw Error(ErrorKind::output, "cannot write " + path.string() + ": " + std::strerror(failure));
}

/// The folder that a file lies in.
inline std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

/// A name beside a file or folder, which starts as that does and is short enough for any system of
/// files.
inline std::filesystem::path beside(const std::filesystem::path& path, const std::string& end) {
  constexpr size_t kMaxName = 255;
  std::string name = path.filename().string();
  if (name.size() + end.size() > kMaxName) {
    size_t size = kMaxName - end.size();
    while (size > 0 && (name[size] & 0xc0) == 0x80) --size;  // within a letter of UTF-8
    name.resize(size);
  }
  return path.parent_path() / (name + end);
}

/// Writes a file that takes the place of one of its name once it is whole, with the permissions
/// and, where that is allowed, the group of that. A symbolic link goes on leading to the file.
/// Throws Error(output).
inline void replace_file(const std::filesystem::path& path, std::string_view bytes) {
  static std::atomic<unsigned> drafts{0};  // others may save to the same file meanwhile
  std::error_code none;
  const std::filesystem::path target = is_symlink(path, none) ? weakly_canonical(path, none) : path;
  struct stat before {};
  const bool there = stat(target.c_str(), &before) == 0;
  NewFile draft(
      beside(target, "." + std::to_string(getpid()) + "-" + std::to_string(drafts++) + ".new"));
  try {
    draft.write(0, bytes.data(), bytes.size());
    draft.close();
    const bool same_group =
        !there || chown(draft.path().c_str(), static_cast<uid_t>(-1), before.st_gid) == 0 ||
        errno == EPERM;  // a group that this user is not in
    if (!same_group || (there && chmod(draft.path().c_str(), before.st_mode & 07777) != 0))
      throw Error(ErrorKind::output,
                  "cannot write " + target.string() + ": " + std::strerror(errno));
    sync_path(draft.path());
    if (std::rename(draft.path().c_str(), target.c_str()) != 0)
      throw Error(ErrorKind::output,
                  "cannot write " + target.string() + ": " + std::strerror(errno));
  } catch (const Error&) {
    std::remove(draft.path().c_str());
    throw;
  }
  sync_path(folder_of(target));
}

/// Writes what a program makes: as replace_file; a pipe or device gets the bytes. Of a file that is
/// there, only if it may be overwritten. Throws Error(output).
inline void write_file(const std::filesystem::path& path, std::string_view bytes, bool overwrite) {
  std::error_code none;
  const auto found = std::filesystem::status(path, none);
  if (is_directory(found)) throw Error(ErrorKind::output, path.string() + " is a folder");
  if (is_regular_file(found) && !overwrite)
    throw Error(ErrorKind::output, path.string() +
                                       " exists: give another name, or --overwrite to "
                                       "replace it");
  if (!exists(found) || is_regular_file(found)) return replace_file(path, bytes);
  const int descriptor = open(path.c_str(), O_WRONLY | O_CLOEXEC);
  bool whole = descriptor >= 0;
  while (whole && !bytes.empty()) {
    const ssize_t part = ::write(descriptor, bytes.data(), bytes.size());
    if (part < 0 && errno == EINTR) continue;
    whole = part > 0;
    if (whole) bytes.remove_prefix(static_cast<size_t>(part));
  }
  const int failure = errno;
  if (descriptor >= 0) close(descriptor);
  if (!whole)
    throw Error(ErrorKind::output, "cannot write " + path.string() + ": " + std::strerror(failure));
}

/// Gives a complete folder the name of another one, which has the draft's name afterwards, if there
/// is one. Throws Error(output).
inline void replace_folder(const std::filesystem::path& draft,
                           const std::filesystem::path& target) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(draft))
    if (!entry.is_symlink()) sync_path(entry.path());
  sync_path(draft);
  if (renameat2(AT_FDCWD, draft.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) != 0) {
    int failure = errno == ENOENT || errno == EINVAL || errno == ENOSYS ? 0 : errno;
    if (failure == 0) {  // there is none, or a file system that cannot exchange
      const std::string before = beside(target, ".before");  // perhaps since a crash
      if (!std::filesystem::exists(target)) std::rename(before.c_str(), target.c_str());
      const bool there = std::rename(target.c_str(), before.c_str()) == 0;
      if (std::rename(draft.c_str(), target.c_str()) != 0) failure = errno;
      if (there) std::rename(before.c_str(), (failure != 0 ? target : draft).c_str());
    }
    if (failure != 0)
      throw Error(ErrorKind::output,
                  "cannot write " + target.string() + ": " + std::strerror(failure));
  }
  sync_path(folder_of(target));
}

}  // namespace inverse

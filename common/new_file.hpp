// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string>

#include "error.hpp"

namespace inverse {

/// A file that is made and written. Nothing may be under its name before, not even a link: others
/// may write to its folder.
class NewFile {
 public:
  /// Throws Error(output).
  explicit NewFile(std::string path)
      : path_(std::move(path)),
        fd_(open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666)) {
    if (fd_ < 0 && errno == EEXIST)
      throw Error(ErrorKind::output, "cannot write " + path_ +
                                         ": another file or link of this name is in the way: "
                                         "remove it");
    if (fd_ < 0) fail(errno);
  }
  ~NewFile() {
    if (fd_ >= 0) ::close(fd_);
  }
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  const std::string& path() const { return path_; }
  /// Writes at a position. Throws Error(output).
  void write(uint64_t at, const void* data, size_t bytes) {
    for (size_t done = 0; done < bytes;) {
      const ssize_t part = pwrite(fd_, static_cast<const char*>(data) + done, bytes - done,
                                  static_cast<off_t>(at + done));
      if (part < 0 && errno == EINTR) continue;
      if (part <= 0) fail(failure_ = errno);
      done += static_cast<size_t>(part);
    }
  }
  /// Throws Error(output) if not all was stored, also if nobody saw that a write failed.
  void close() {
    const int fd = fd_;
    fd_ = -1;
    if (::close(fd) != 0 && !failure_) failure_ = errno;
    if (failure_) fail(failure_);
  }

 private:
  [[noreturn]] void fail(int failure) const {
    throw Error(ErrorKind::output, "cannot write " + path_ + ": " + std::strerror(failure));
  }

  std::string path_;
  int fd_;
  int failure_ = 0;  // errno of a write
};

}  // namespace inverse

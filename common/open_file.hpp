// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>

namespace inverse {

/// A regular file, opened once for reading: checks and content are of one file, whatever is put
/// under its name meanwhile.
class OpenFile {
 public:
  explicit OpenFile(const std::string& path) {
    // Found first and opened when it is no pipe, for which opening would wait.
    const int found = open(path.c_str(), O_PATH | O_CLOEXEC);
    struct stat status {};
    if (found >= 0 && fstat(found, &status) == 0 && S_ISREG(status.st_mode))
      fd_ = open(("/proc/self/fd/" + std::to_string(found)).c_str(), O_RDONLY | O_CLOEXEC);
    if (found >= 0 && fd_ < 0 && !S_ISREG(status.st_mode))
      fault_ = "is no file";
    else if (fd_ < 0)
      fault_ = path.find("://") != std::string::npos
                   ? "cannot be read: a path is needed, not a URI"
                   : std::string("cannot be read: ") + std::strerror(errno);
    if (found >= 0) close(found);
    size_ = static_cast<uint64_t>(status.st_size);
    own_ = status.st_uid == geteuid() && (status.st_mode & (S_IWGRP | S_IWOTH)) == 0;
  }
  ~OpenFile() {
    if (fd_ >= 0) close(fd_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  /// Why it cannot be read, as the end of a message that starts with the path; else empty.
  const std::string& fault() const { return fault_; }
  /// Whether it is this user's, and nobody else may write to it.
  bool own() const { return own_; }
  /// Bytes, when it was opened.
  uint64_t size() const { return size_; }
  /// Reads up to `bytes` from a position; returns how many, fewer only at the end of the file or
  /// after an error.
  size_t read(uint64_t at, void* to, size_t bytes) const {
    size_t got = 0;
    while (got < bytes) {
      const ssize_t part =
          pread(fd_, static_cast<char*>(to) + got, bytes - got, static_cast<off_t>(at + got));
      if (part < 0 && errno == EINTR) continue;
      if (part <= 0) break;
      got += static_cast<size_t>(part);
    }
    return got;
  }
  /// Its path without links.
  std::filesystem::path real_path() const {
    std::error_code none;
    return std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(fd_), none);
  }

 private:
  int fd_ = -1;
  uint64_t size_ = 0;
  bool own_ = false;
  std::string fault_;
};

/// The content of a file, read once. If it cannot be read or has more than `max` bytes, `fault`
/// says why, as OpenFile::fault does, and the content is empty.
inline std::string read_file(const OpenFile& file, uint64_t max, std::string& fault) {
  fault = file.fault();
  if (fault.empty() && file.size() > max)
    fault = "is larger than " + std::to_string(max >> 20) + " MiB";
  if (!fault.empty()) return {};
  std::string content(file.size(), '\0');
  content.resize(file.read(0, content.data(), content.size()));
  return content;
}
inline std::string read_file(const std::string& path, uint64_t max, std::string& fault) {
  return read_file(OpenFile(path), max, fault);
}

}  // namespace inverse

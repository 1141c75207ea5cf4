// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "temporary_folder.hpp"

namespace inverse::testing {

/// A file whose name is another file at each opening: the first opening finds the first content,
/// the second the second, and so on. By leases (fcntl F_SETLEASE): an opening waits until the name
/// is the next file's.
class ReplacedFile {
 public:
  ReplacedFile(const std::string& name, std::vector<std::string> contents)
      : path_(folder_ / name), contents_(std::move(contents)) {
    fd_ = lease(next());
    if (fd_ < 0) return;
    replacer_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested() && fd_ >= 0) {
        if (fcntl(fd_, F_GETLEASE) == F_WRLCK) {
          usleep(1000);
          continue;
        }
        ++openings_;
        const int opened = fd_;
        fd_ = next_ < contents_.size() ? lease(next()) : -1;
        close(opened);  // lets the opening go on, of the file that had the name
      }
    });
  }
  ~ReplacedFile() {
    if (replacer_.joinable()) {
      replacer_.request_stop();
      replacer_.join();
    }
    if (fd_ >= 0) close(fd_);
  }
  ReplacedFile(const ReplacedFile&) = delete;
  ReplacedFile& operator=(const ReplacedFile&) = delete;

  const std::string& path() const { return path_; }
  /// False if this file system has no leases: nothing can be tested then.
  bool works() const { return replacer_.joinable(); }
  /// So far; of the last content one at most.
  int openings() const { return openings_; }

 private:
  /// Gives the name to the next content.
  std::string next() {
    const std::string other = folder_.write("next", contents_[next_++]);
    return other;
  }
  int lease(const std::string& file) {
    const int fd = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) return -1;
    fcntl(fd, F_SETSIG, SIGURG);  // ignored by default; SIGIO would end the process
    const bool leased = fcntl(fd, F_SETLEASE, F_WRLCK) == 0;
    if (leased && std::rename(file.c_str(), path_.c_str()) == 0) return fd;
    close(fd);
    return -1;
  }

  TemporaryFolder folder_;
  std::string path_;
  std::vector<std::string> contents_;
  size_t next_ = 0;
  std::atomic<int> fd_{-1};
  std::atomic<int> openings_{0};
  std::jthread replacer_;
};

/// A file whose opening waits until `release`, or 45 seconds (/proc/sys/fs/lease-break-time).
class HeldFile {
 public:
  explicit HeldFile(const std::string& path) : fd_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    fcntl(fd_, F_SETSIG, SIGURG);
    works_ = fcntl(fd_, F_SETLEASE, F_WRLCK) == 0;
  }
  ~HeldFile() { release(); }
  HeldFile(const HeldFile&) = delete;
  HeldFile& operator=(const HeldFile&) = delete;

  /// False if this file system has no leases: nothing can be tested then.
  bool works() const { return works_; }
  /// Whether an opening waits.
  bool is_wanted() const { return fd_ >= 0 && fcntl(fd_, F_GETLEASE) != F_WRLCK; }
  void release() {
    if (fd_ >= 0) close(fd_);
    fd_ = -1;
  }

 private:
  int fd_;
  bool works_ = false;
};

}  // namespace inverse::testing

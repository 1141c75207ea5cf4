// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <chrono>
#include <future>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/background.hpp"
#include "common/error.hpp"
#include "picture_file.hpp"

namespace inverse {

/// The picture of a file that a property names: read at the start, and by another thread when the
/// property changes while frames go on.
class FileLoader {
 public:
  /// Throws as load_picture. An empty path is no picture.
  void start(const std::string& path) {
    loading_ = {};
    asked_ = path;
    file_ = load(path);
  }
  /// Whether there is another picture now, or none any more. If a file cannot be read, a warning
  /// says why, and the picture stays.
  bool take(const std::string& path, std::vector<std::string>& warnings) {
    bool changed = false;
    if (loading_.valid() && loading_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
      try {
        file_ = loading_.get();
        changed = true;
      } catch (const Error& error) {
        warnings.push_back(std::string(error.what()) + "; the picture before stays");
      }
    if (!loading_.valid() && path != asked_) {
      asked_ = path;
      loading_ = in_background([path] { return load(path); });
    }
    return changed;
  }
  const std::optional<Picture8>& file() const { return file_; }

 private:
  static std::optional<Picture8> load(const std::string& path) {
    if (path.empty()) return {};
    return load_picture(path);
  }
  std::string asked_;
  std::optional<Picture8> file_;
  std::future<std::optional<Picture8>> loading_;
};

}  // namespace inverse

// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <filesystem>
#include <string>

namespace inverse {

/// Why a path is not a regular, readable file, as the end of a message that starts with the path;
/// empty if it is one. Opening a pipe would block until a writer opens it.
inline std::string why_no_file(const std::string& path) {
  std::error_code status;
  if (std::filesystem::is_regular_file(path, status)) return {};
  if (path.find("://") != std::string::npos) return "cannot be read: a path is needed, not a URI";
  return status ? "cannot be read: " + status.message() : "is no file";
}

}  // namespace inverse

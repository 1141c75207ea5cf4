#pragma once
#include <filesystem>
#include <string>

namespace inverse {

/// Why a path is no file that can be read at once, to be put behind its name; empty where it is
/// one. Opening a pipe would wait for somebody who writes into it.
inline std::string why_no_file(const std::string& path) {
  std::error_code status;
  if (std::filesystem::is_regular_file(path, status)) return {};
  if (path.find("://") != std::string::npos) return "cannot be read: a path is needed, not a URI";
  return status ? "cannot be read: " + status.message() : "is no file";
}

}  // namespace inverse

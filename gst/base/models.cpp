// SPDX-License-Identifier: LGPL-2.1-or-later
#include "models.hpp"

#include <cstdlib>
#include <filesystem>

#include "common/error.hpp"

namespace inverse {

std::string models_set(const std::string& set) {
  const char* environment = std::getenv("INVERSE_MODELS");
  return !set.empty() ? set : environment && *environment ? environment : MODELS_FOLDER;
}

std::string models_folder(const std::string& set, const char* part) {
  std::string folder = models_set(set) + "/" + part;
  std::error_code status;
  if (!std::filesystem::is_directory(folder, status))
    throw Error(ErrorKind::file, "there is no folder " + folder +
                                     " of networks; the property models or INVERSE_MODELS may name "
                                     "another place (a build with libonnx makes them, in models/)");
  return folder;
}

}  // namespace inverse

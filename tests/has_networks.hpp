// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdlib>
#include <filesystem>
#include <string>

namespace inverse::testing {

/// Whether the build made the networks of limematerial, for which it takes inverse-onnx-import.
inline bool has_networks() {
  const char* models = std::getenv("INVERSE_MODELS");
  return models && std::filesystem::exists(std::string(models) + "/lime/albedo.net");
}

}  // namespace inverse::testing

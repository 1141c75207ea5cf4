// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>

namespace inverse {

/// The folder of one method's networks (`part`: "lime", "olat") in the set of models `set`; where
/// that is empty, in the environment variable INVERSE_MODELS, else in the one that is installed.
/// Throws Error (file) where there is no such folder.
std::string models_folder(const std::string& set, const char* part);

}  // namespace inverse

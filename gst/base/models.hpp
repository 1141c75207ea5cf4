// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>

namespace inverse {

/// The folder of the set of models `set`; if that is empty, that of the environment variable
/// INVERSE_MODELS, else the installed one.
std::string models_set(const std::string& set = {});

/// The folder `part` of one method's networks in models_set(set). Throws Error(file) if there is no
/// such folder.
std::string models_folder(const std::string& set, const char* part);

}  // namespace inverse

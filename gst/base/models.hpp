// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>

namespace inverse {

/// The folder `part` of one method's networks in the set of models `set`; if that is empty, in the
/// environment variable INVERSE_MODELS, else in the installed one. Throws Error(file) if there is
/// no such folder.
std::string models_folder(const std::string& set, const char* part);

}  // namespace inverse

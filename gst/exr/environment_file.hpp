// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>

#include "kernels/environment/environment.hpp"

namespace inverse {

/// Reads a latitude-longitude map from a Radiance (.hdr) or an OpenEXR file (.exr, by its first
/// bytes). Radiance that is no number, negative or above Environment::kMaxRadiance is clamped;
/// `warning` says so, or is empty. Throws Error(file).
Environment load_environment(const std::string& path, std::string& warning);

}  // namespace inverse

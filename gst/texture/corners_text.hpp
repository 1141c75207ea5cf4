// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <optional>
#include <string>

#include "kernels/texture/quad.hpp"

namespace inverse {

/// "x,y x,y x,y x,y" as corners; none if it is empty or blank. Throws Error(unsupported), a text
/// that follows the name of the property, if it is something else.
std::optional<Corners> read_corners(const std::string& text);
std::string text_of(const Corners& corners);

}  // namespace inverse

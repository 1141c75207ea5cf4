// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <functional>
#include <string>
#include <string_view>

#include "picture_file.hpp"

namespace inverse {

/// Decodes a JPEG as it is stored. `check_size` may throw, before memory is taken for the pixels.
/// If the file is damaged, `fault` says how, and the picture is empty.
Picture8 read_jpeg(std::string_view file, const std::function<void(Extent)>& check_size,
                   std::string& fault);

}  // namespace inverse

// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>
#include <string_view>

namespace inverse {

/// Of which element a PLY file has fewer than its header promises, as words to put behind its name;
/// empty if it has all. Assimp's reader takes memory for what is promised, and makes up what
/// lies beyond the end. A file that is not a PLY passes: the reader reports it.
std::string ply_length_fault(std::string_view file);

}  // namespace inverse

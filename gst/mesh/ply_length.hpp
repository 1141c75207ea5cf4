#pragma once
#include <string>

namespace inverse {

/// Of which element a PLY file has fewer than its header promises, as words to put behind its name;
/// empty where it has all. Assimp's reader takes memory for what is promised, and makes up what
/// lies beyond the end of a binary one. Of text, only what cannot be is told, and of what is no PLY
/// nothing: the reader complains of these itself.
std::string ply_length_fault(const std::string& path);

}  // namespace inverse

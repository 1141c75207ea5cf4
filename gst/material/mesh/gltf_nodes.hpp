// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>
#include <string_view>

namespace inverse {

/// What is wrong with the JSON of a glTF file (.gltf, .glb; parse_json), or with how its nodes hang
/// together; empty if nothing is. Assimp's reader follows either as far as it goes: to the end of
/// the stack, or of time if a node has many parents, which glTF does not allow (3.5.2).
std::string gltf_nodes_fault(std::string_view content);

}  // namespace inverse

// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>

namespace inverse {

/// What is wrong with how the nodes of a glTF file (.gltf, .glb) hang together, or with how deep
/// its JSON is nested; empty if nothing is. Assimp's reader follows either as far as it goes: to
/// the end of the stack, or of time if a node has many parents, which glTF does not allow
/// (3.5.2). Files that are no glTF pass: Assimp's reader reports them.
std::string gltf_nodes_fault(const std::string& path);

}  // namespace inverse

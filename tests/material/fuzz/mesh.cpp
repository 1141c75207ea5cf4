// SPDX-License-Identifier: LGPL-2.1-or-later
// What is checked of untrusted meshes before Assimp reads them: a fault or none, soon. The first
// byte chooses the format.
#include <cstddef>
#include <cstdint>

#include "gst/material/mesh/gltf_nodes.hpp"
#include "gst/material/mesh/ply_length.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace inverse;
  if (!size) return 0;
  const std::string_view file(reinterpret_cast<const char*>(data) + 1, size - 1);
  data[0] == 'p' ? ply_length_fault(file) : gltf_nodes_fault(file);
  return 0;
}

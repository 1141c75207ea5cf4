// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gltf_nodes.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <unordered_map>
#include <vector>

#include "common/json.hpp"

namespace inverse {
namespace {

using nlohmann::json;

constexpr int kDeepest = 1000;  // nodes below each other
/// Extensions by which positions are stored in another way, which the reader takes for plain ones.
constexpr std::array kPacked{"KHR_mesh_quantization", "EXT_meshopt_compression",
                             "KHR_draco_mesh_compression", "EXT_mesh_gpu_instancing"};

/// The JSON of a file: all of it, or the first chunk of a binary one.
std::string_view json_of(std::string_view file) {
  uint32_t header[5] = {};  // magic, version, length; of the first chunk length and kind
  if (file.starts_with("glTF") && file.size() >= sizeof header) {
    std::memcpy(header, file.data(), sizeof header);
    file = file.substr(sizeof header, header[3]);
  }
  // What Assimp's reader passes over.
  if (file.starts_with("\xef\xbb\xbf")) file.remove_prefix(3);
  return file.substr(0, file.find('\0'));
}

/// Indices of the nodes below each node; other things than nodes that are there are the reader's.
/// In glTF 1.0 nodes have names in place of numbers.
std::vector<std::vector<size_t>> children_of(const json& nodes) {
  std::unordered_map<std::string, size_t> names;
  if (nodes.is_object())
    for (const auto& [name, node] : nodes.items()) names.emplace(name, names.size());
  std::vector<std::vector<size_t>> children;
  for (const json& node : nodes) {
    std::vector<size_t>& below = children.emplace_back();
    if (!node.is_object()) continue;
    const auto list = node.find("children");
    if (list == node.end() || !list->is_array()) continue;
    for (const json& child : *list) {
      if (nodes.is_array() && child.is_number_unsigned() && child.get<uint64_t>() < nodes.size())
        below.push_back(child.get<size_t>());
      const auto found = child.is_string() ? names.find(child.get<std::string>()) : names.end();
      if (found != names.end()) below.push_back(found->second);
    }
  }
  return children;
}

}  // namespace

std::string gltf_nodes_fault(std::string_view content) {
  std::string fault;
  const json file = parse_json<json>(json_of(content), fault);
  if (!fault.empty()) return fault;
  if (const auto required = file.is_object() ? file.find("extensionsRequired") : file.end();
      required != file.end() && required->is_array())
    for (const json& name : *required)
      if (name.is_string() && std::ranges::count(kPacked, name.get<std::string>()) > 0)
        return "requires the glTF extension " + name.get<std::string>() +
               ", which is not read: store it without, with \"gltfpack -noq\" or Blender for "
               "example";
  if (!file.is_object() || !file.contains("nodes") || !file["nodes"].is_structured()) return "";
  const auto children = children_of(file["nodes"]);
  std::vector<int> parents(children.size(), 0);
  for (const auto& list : children)
    for (const size_t child : list)
      if (++parents[child] > 1)
        return "has a node with more than one parent (" + std::to_string(child) +
               "), which glTF does not allow";
  // One parent each: from the roots on every node is met once, and those never met are a ring.
  std::vector<size_t> level;
  for (size_t n = 0; n < parents.size(); ++n)
    if (!parents[n]) level.push_back(n);
  size_t met = level.size();
  for (int depth = 1; !level.empty(); ++depth) {
    if (depth > kDeepest)
      return "has nodes more than " + std::to_string(kDeepest) + " deep below each other";
    std::vector<size_t> next;
    for (const size_t n : level) next.insert(next.end(), children[n].begin(), children[n].end());
    met += next.size();
    level = std::move(next);
  }
  return met < children.size() ? "has nodes that are below themselves" : "";
}

}  // namespace inverse

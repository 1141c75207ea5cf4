#include "gltf_nodes.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

namespace inverse {
namespace {

using nlohmann::json;

constexpr int kDeepest = 1000;     // nodes below each other
constexpr int kDeepestJson = 100;  // brackets in each other

/// The JSON of a file: all of it, or the first chunk of a binary one.
std::string json_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  uint32_t header[5] = {};  // magic, version, length; of the first chunk length and kind
  file.read(reinterpret_cast<char*>(header), sizeof header);
  if (file && std::memcmp(header, "glTF", 4) == 0) {
    file.seekg(0, std::ios::end);
    const auto bytes = static_cast<uint64_t>(file.tellg());
    std::string text(std::min<uint64_t>(header[3], bytes), '\0');
    file.seekg(sizeof header);
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<size_t>(file.gcount()));
    return text;
  }
  file.clear();
  file.seekg(0);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Indices of the nodes below each node; other things than indices of nodes are the reader's.
std::vector<std::vector<size_t>> children_of(const json& nodes) {
  std::vector<std::vector<size_t>> children(nodes.size());
  for (size_t n = 0; n < nodes.size(); ++n) {
    if (!nodes[n].is_object()) continue;
    const auto list = nodes[n].find("children");
    if (list == nodes[n].end() || !list->is_array()) continue;
    for (const json& child : *list)
      if (child.is_number_unsigned() && child.get<uint64_t>() < nodes.size())
        children[n].push_back(child.get<size_t>());
  }
  return children;
}

}  // namespace

std::string gltf_nodes_fault(const std::string& path) {
  bool deep = false;
  const json file = json::parse(
      json_of(path),
      [&deep](int depth, json::parse_event_t, json&) {
        deep = deep || depth > kDeepestJson;
        return !deep;
      },
      false);
  if (deep) return "nests its JSON more than " + std::to_string(kDeepestJson) + " deep";
  if (!file.is_object() || !file.contains("nodes") || !file["nodes"].is_array()) return "";
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

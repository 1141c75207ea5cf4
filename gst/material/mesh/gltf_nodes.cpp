// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gltf_nodes.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <unordered_map>
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

/// How deep brackets lie in each other.
int depth_of(const std::string& json) {
  int depth = 0, deepest = 0;
  bool quoted = false;
  for (size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (quoted) {
      if (c == '\\')
        ++i;
      else
        quoted = c != '"';
      continue;
    }
    quoted = c == '"';
    if (c == '[' || c == '{') deepest = std::max(deepest, ++depth);
    if (c == ']' || c == '}') --depth;
  }
  return deepest;
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

std::string gltf_nodes_fault(const std::string& path) {
  const std::string text = json_of(path);
  if (depth_of(text) > kDeepestJson)
    return "nests its JSON more than " + std::to_string(kDeepestJson) + " deep";
  const json file = json::parse(text, nullptr, false);
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

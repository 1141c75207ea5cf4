// SPDX-License-Identifier: LGPL-2.1-or-later
#include "ply_length.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <vector>

namespace inverse {
namespace {

/// A type of values in a binary file.
struct Type {
  size_t bytes = 0;  ///< 0: there is none
  bool is_signed = false;
};
/// One value, or a list of them behind its length.
struct Property {
  Type length;  ///< none: no list
  Type value;
};
struct Element {
  std::string name;
  int64_t count = 0;
  std::vector<Property> properties;
};
enum class Format { none, text, little_endian, big_endian };
struct Header {
  Format format = Format::none;
  std::vector<Element> elements;
};

Type type_of(const std::string& name) {
  static const std::map<std::string, Type> types{
      {"char", {1, true}},  {"uchar", {1}},        {"int8", {1, true}},    {"uint8", {1}},
      {"short", {2, true}}, {"ushort", {2}},       {"int16", {2, true}},   {"uint16", {2}},
      {"int", {4, true}},   {"uint", {4}},         {"int32", {4, true}},   {"uint32", {4}},
      {"float", {4, true}}, {"double", {8, true}}, {"float32", {4, true}}, {"float64", {8, true}}};
  const auto found = types.find(name);
  return found == types.end() ? Type{} : found->second;
}

Format format_of(const std::string& name) {
  if (name == "ascii") return Format::text;
  if (name == "binary_little_endian") return Format::little_endian;
  return name == "binary_big_endian" ? Format::big_endian : Format::none;
}

/// Removes the header. False if it is none, or one that Assimp does not take either.
bool read_header(std::string_view& file, Header& header) {
  constexpr size_t kLongest = size_t{1} << 16;  // comments are lines, too
  while (!file.empty()) {
    const std::string_view line = file.substr(0, file.find('\n'));
    if (line.size() >= kLongest) return false;
    file.remove_prefix(std::min(line.size() + 1, file.size()));
    std::istringstream words{std::string(line)};
    std::string word, type;
    words >> word;
    if (word == "end_header") return header.format != Format::none;
    if (word == "format") {
      words >> type;
      header.format = format_of(type);
    } else if (word == "element") {
      Element element;
      words >> element.name >> element.count;  // the largest number if it is larger
      header.elements.push_back(std::move(element));
    } else if (word == "property") {
      Property property;
      words >> type;
      if (type == "list") {
        words >> type;
        property.length = type_of(type);
        if (!property.length.bytes) return false;
        words >> type;
      }
      property.value = type_of(type);
      if (!property.value.bytes || header.elements.empty()) return false;
      header.elements.back().properties.push_back(property);
    }
  }
  return false;
}

/// The values of a file behind its header.
class Values {
 public:
  virtual ~Values() = default;
  /// False if there are fewer.
  virtual bool skip(int64_t count, Type type) = 0;
  /// The next one, a whole number; nothing behind the last one.
  virtual std::optional<int64_t> next(Type type) = 0;
};

class BinaryValues final : public Values {
 public:
  BinaryValues(std::string_view left, bool big_endian) : left_(left), big_endian_(big_endian) {}
  bool skip(int64_t count, Type type) override {
    if (count < 0 || static_cast<uint64_t>(count) > left_.size() / type.bytes) return false;
    left_.remove_prefix(static_cast<size_t>(count) * type.bytes);
    return true;
  }
  std::optional<int64_t> next(Type type) override {
    if (left_.size() < type.bytes) return {};
    uint64_t value = 0, beyond = 1;
    for (size_t i = 0; i < type.bytes; ++i) {
      const auto byte = static_cast<uint64_t>(static_cast<unsigned char>(left_[i]));
      value = big_endian_ ? value << 8 | byte : value | byte << 8 * i;
      beyond <<= 8;
    }
    left_.remove_prefix(type.bytes);
    if (type.is_signed && value >= beyond / 2) value -= beyond;
    return static_cast<int64_t>(value);
  }

 private:
  std::string_view left_;
  bool big_endian_;
};

class TextValues final : public Values {
 public:
  explicit TextValues(std::string_view left) : left_(left) {}
  bool skip(int64_t count, Type) override {
    for (int64_t i = 0; i < count; ++i)
      if (word().empty()) return false;
    return true;
  }
  std::optional<int64_t> next(Type) override {
    const std::string_view text = word();
    if (text.empty()) return {};
    int64_t value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
  }

 private:
  std::string_view word() {
    constexpr const char* kSpace = " \t\n\v\f\r";
    left_.remove_prefix(std::min(left_.find_first_not_of(kSpace), left_.size()));
    const std::string_view found = left_.substr(0, left_.find_first_of(kSpace));
    left_.remove_prefix(found.size());
    return found;
  }

  std::string_view left_;
};

/// False if there are too few values, or a list of fewer than none.
bool skip(Values& values, const Property& property) {
  if (!property.length.bytes) return values.skip(1, property.value);
  const std::optional<int64_t> length = values.next(property.length);
  return length && *length >= 0 && values.skip(*length, property.value);
}

/// How many elements are there, up to its count.
int64_t skip(Values& values, const Element& element) {
  for (int64_t i = 0; i < element.count; ++i)
    for (const Property& property : element.properties)
      if (!skip(values, property)) return i;
  return element.count;
}

}  // namespace

std::string ply_length_fault(std::string_view file) {
  Header header;
  if (!read_header(file, header)) return {};
  std::unique_ptr<Values> values;
  if (header.format == Format::text)
    values = std::make_unique<TextValues>(file);
  else
    values = std::make_unique<BinaryValues>(file, header.format == Format::big_endian);
  for (const Element& element : header.elements) {
    const std::string of =
        "of " + std::to_string(element.count) + " elements \"" + element.name + "\"";
    if (element.name == "tristrips" && element.count > 0)
      return "has strips of triangles, of which Assimp leaves some out: store faces, with Blender "
             "or MeshLab for example";
    if (element.count < 0) return "is damaged: its header declares " + of.substr(3);
    if (element.properties.empty()) continue;
    if (const int64_t there = skip(*values, element); there < element.count)
      return "ends too early or is damaged: " + of + " it has " + std::to_string(there);
  }
  return {};
}

}  // namespace inverse

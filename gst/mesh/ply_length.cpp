#include "ply_length.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <vector>

namespace inverse {
namespace {

/// One value, or a list of them behind its length. In bytes.
struct Property {
  size_t length_size = 0;  ///< 0: no list
  size_t size = 0;         ///< of a value
};
struct Element {
  std::string name;
  uint64_t count = 0;
  std::vector<Property> properties;
};
struct Header {
  enum class Format { none, text, little_endian, big_endian } format = Format::none;
  std::vector<Element> elements;
};

/// 0 of what is no type.
size_t size_of(const std::string& type) {
  static const std::map<std::string, size_t> sizes{
      {"char", 1},  {"uchar", 1},  {"int8", 1},    {"uint8", 1},  {"short", 2}, {"ushort", 2},
      {"int16", 2}, {"uint16", 2}, {"int", 4},     {"uint", 4},   {"int32", 4}, {"uint32", 4},
      {"float", 4}, {"double", 8}, {"float32", 4}, {"float64", 8}};
  const auto found = sizes.find(type);
  return found == sizes.end() ? 0 : found->second;
}

/// Reads up to the first byte behind the header. False where it is none.
bool read_header(std::istream& file, Header& header) {
  for (char line[1024]; file.getline(line, sizeof line);) {  // no header's are longer
    std::istringstream words{line};
    std::string word, type;
    words >> word;
    if (word == "end_header") return header.format != Header::Format::none;
    if (word == "format") {
      words >> type;
      header.format = type == "ascii"                  ? Header::Format::text
                      : type == "binary_little_endian" ? Header::Format::little_endian
                      : type == "binary_big_endian"    ? Header::Format::big_endian
                                                       : Header::Format::none;
    } else if (word == "element") {
      Element element;
      if (!(words >> element.name >> element.count)) return false;
      header.elements.push_back(std::move(element));
    } else if (word == "property") {
      Property property;
      words >> type;
      if (type == "list") {
        words >> type;
        property.length_size = size_of(type);
        if (!property.length_size) return false;
        words >> type;
      }
      property.size = size_of(type);
      if (!property.size || header.elements.empty()) return false;
      header.elements.back().properties.push_back(property);
    }
  }
  return false;
}

/// What is left of a file.
class Rest {
 public:
  Rest(std::istream& file, uint64_t bytes, bool big_endian)
      : file_(file), left_(bytes), big_endian_(big_endian) {}

  /// False where there is less.
  bool skip(uint64_t bytes) {
    if (bytes > left_) return false;
    left_ -= bytes;
    file_.ignore(static_cast<std::streamsize>(bytes));
    return true;
  }
  bool skip(const Property& property) {
    if (!property.length_size) return skip(property.size);
    if (property.length_size > left_) return false;
    uint64_t length = 0;
    for (size_t i = 0; i < property.length_size; ++i) {
      const auto byte = static_cast<uint64_t>(static_cast<unsigned char>(file_.get()));
      length = big_endian_ ? length << 8 | byte : length | byte << 8 * i;
    }
    left_ -= property.length_size;
    return length <= left_ && skip(length * property.size);
  }
  /// How many elements are there, up to its count.
  uint64_t skip(const Element& element) {
    for (uint64_t i = 0; i < element.count; ++i)
      for (const Property& property : element.properties)
        if (!skip(property)) return i;
    return element.count;
  }

 private:
  std::istream& file_;
  uint64_t left_;
  bool big_endian_;
};

}  // namespace

std::string ply_length_fault(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  Header header;
  if (!read_header(file, header)) return {};
  const auto head = static_cast<uint64_t>(file.tellg());
  std::error_code status;
  const uint64_t size = std::filesystem::file_size(path, status);
  if (status || size < head) return {};
  Rest rest(file, size - head, header.format == Header::Format::big_endian);
  for (const Element& element : header.elements) {
    if (element.properties.empty()) continue;
    // A value takes at least a digit and what parts it from the next, which the last may lack.
    const uint64_t most = (size - head + 1) / (2 * element.properties.size());
    const bool text = header.format == Header::Format::text;
    const uint64_t there = text ? std::min(most, element.count) : rest.skip(element);
    if (there < element.count)
      return "ends too early: of " + std::to_string(element.count) + " elements \"" + element.name +
             "\" it has " + (text ? "at most " : "") + std::to_string(there) +
             "; it was not copied or written whole";
  }
  return {};
}

}  // namespace inverse

// SPDX-License-Identifier: LGPL-2.1-or-later
#include "graph_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "common/error.hpp"
#include "common/open_file.hpp"

static_assert(std::endian::native == std::endian::little, "files are read as they lie in memory");

namespace inverse::network {
namespace {

constexpr std::array<char, 8> kMagic = {'I', 'N', 'V', 'E', 'R', 'S', 'E', 'N'};
constexpr uint32_t kVersion = 2;

struct Header {
  std::array<char, 8> magic = kMagic;
  uint32_t version = kVersion;
  uint32_t zero = 0;
  uint64_t bytes = 0;
  uint64_t checksum = 0;
};

uint64_t fnv1a(std::span<const std::byte> bytes) {
  uint64_t hash = 0xcbf29ce484222325;
  for (const std::byte b : bytes) hash = (hash ^ static_cast<uint64_t>(b)) * 0x100000001b3;
  return hash;
}

class Writer {
 public:
  template <typename T>
  void value(T v) {
    append(&v, sizeof v);
  }
  void count(size_t n) { value(static_cast<uint32_t>(n)); }
  void text(const std::string& s) {
    count(s.size());
    append(s.data(), s.size());
  }
  void append(const void* data, size_t size) {
    const auto* first = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), first, first + size);
  }
  std::vector<std::byte> bytes;
};

class Reader {
 public:
  Reader(std::span<const std::byte> bytes, const std::string& name) : left_(bytes), name_(name) {}

  [[noreturn]] void refuse(const std::string& why) const {
    throw Error(ErrorKind::file, name_ + ": " + why);
  }
  template <typename T>
  T value() {
    T v;
    memcpy(&v, take(sizeof v).data(), sizeof v);
    return v;
  }
  /// Reads the number of following items, each of at least `min_bytes` bytes.
  size_t count(size_t min_bytes) {
    const auto n = value<uint32_t>();
    if (n > left_.size() / min_bytes) refuse("it ends in the middle");
    return n;
  }
  std::string text() {
    const auto bytes = take(count(1));
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  std::span<const std::byte> take(uint64_t size) {
    if (size > left_.size()) refuse("it ends in the middle");
    const auto taken = left_.first(size);
    left_ = left_.subspan(size);
    return taken;
  }
  bool done() const { return left_.empty(); }

 private:
  std::span<const std::byte> left_;
  const std::string& name_;
};

void write_node(Writer& out, const Node& node) {
  out.text(node.name);
  out.value(node.op);
  out.count(node.inputs.size());
  for (const uint32_t input : node.inputs) out.value(input);
  out.value(node.activation);
  out.value(node.slope);
  for (const uint32_t number :
       {node.kernel, node.stride, node.dilation, node.fan_in, node.channels})
    out.value(number);
  out.value(node.weights);
}

Node read_node(Reader& in) {
  Node node;
  node.name = in.text();
  node.op = in.value<Op>();
  node.inputs.resize(in.count(4));
  for (uint32_t& input : node.inputs) input = in.value<uint32_t>();
  node.activation = in.value<Activation>();
  node.slope = in.value<float>();
  for (uint32_t* number :
       {&node.kernel, &node.stride, &node.dilation, &node.fan_in, &node.channels})
    *number = in.value<uint32_t>();
  node.weights = in.value<uint64_t>();
  return node;
}

/// Checks the bytes against the header.
std::span<const std::byte> body_of(std::span<const std::byte> bytes, const std::string& name) {
  Reader file(bytes, name);
  if (bytes.size() < sizeof(Header)) file.refuse("it is too short to be a network");
  const auto header = file.value<Header>();
  if (header.magic != kMagic)
    file.refuse("not a .net file; inverse-onnx-import makes one of an ONNX file");
  if (header.version != kVersion)
    file.refuse("it is of version " + std::to_string(header.version) + ", not " +
                std::to_string(kVersion) + "; import it again with inverse-onnx-import");
  if (header.zero != 0) file.refuse("its header was changed");
  if (header.bytes != bytes.size() - sizeof(Header))
    file.refuse("it has " + std::to_string(bytes.size()) + " bytes in place of " +
                std::to_string(header.bytes + sizeof(Header)) + ": cut short, or changed");
  const auto body = bytes.subspan(sizeof(Header));
  if (fnv1a(body) != header.checksum) file.refuse("its checksum is wrong: it was changed");
  return body;
}

}  // namespace

std::vector<std::byte> to_file(const Graph& graph) {
  Writer body;
  body.count(graph.inputs.size());
  for (const Input& input : graph.inputs) {
    body.text(input.name);
    for (const uint32_t number : {input.channels, input.height, input.width}) body.value(number);
  }
  body.count(graph.nodes.size());
  for (const Node& node : graph.nodes) write_node(body, node);
  body.count(graph.outputs.size());
  for (const Output& output : graph.outputs) {
    body.text(output.name);
    body.value(output.value);
  }
  body.value(static_cast<uint64_t>(graph.weights.size()));
  body.append(graph.weights.data(), graph.weights.size() * sizeof(float));

  Header header;
  header.bytes = body.bytes.size();
  header.checksum = fnv1a(body.bytes);
  Writer file;
  file.value(header);
  file.append(body.bytes.data(), body.bytes.size());
  return std::move(file.bytes);
}

Graph from_file(std::span<const std::byte> bytes, const std::string& name) {
  Reader in(body_of(bytes, name), name);
  Graph graph;
  graph.inputs.resize(in.count(16));
  for (Input& input : graph.inputs) {
    input.name = in.text();
    for (uint32_t* number : {&input.channels, &input.height, &input.width})
      *number = in.value<uint32_t>();
  }
  const size_t nodes = in.count(44);
  for (size_t i = 0; i < nodes; ++i) graph.nodes.push_back(read_node(in));
  graph.outputs.resize(in.count(8));
  for (Output& output : graph.outputs) {
    output.name = in.text();
    output.value = in.value<uint32_t>();
  }
  const auto weights = in.value<uint64_t>();
  if (weights > bytes.size() / sizeof(float)) in.refuse("it ends in the middle");
  const auto data = in.take(weights * sizeof(float));
  graph.weights.resize(weights);
  if (weights) memcpy(graph.weights.data(), data.data(), data.size());
  if (!in.done()) in.refuse("there is more in it than a network");
  try {
    validate(graph);
  } catch (const Error& error) {
    in.refuse(error.what());
  }
  return graph;
}

Graph load(const std::string& path) {
  constexpr const char* kRemedy = "; inverse-onnx-import makes a network file of an ONNX file";
  constexpr uint64_t kMaxBytes = uint64_t{1} << 30;
  const OpenFile file(path);
  std::string fault = file.fault();
  // Of another file, its beginning is enough to say so.
  std::array<char, sizeof(Header)> head{};
  const bool whole = fault.empty() && file.read(0, head.data(), head.size()) == head.size();
  if (whole && std::memcmp(head.data(), kMagic.data(), kMagic.size()) != 0)
    return from_file(std::as_bytes(std::span(head)), path);
  const std::string bytes = fault.empty() ? read_file(file, kMaxBytes, fault) : std::string();
  if (!fault.empty()) throw Error(ErrorKind::file, path + ": it " + fault + kRemedy);
  return from_file(std::as_bytes(std::span(bytes)), path);
}

}  // namespace inverse::network

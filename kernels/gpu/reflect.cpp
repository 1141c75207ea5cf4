// Reads what a shader declares at its bindings from SPIR-V (specification 1.x, sections 2.3
// and 3.32), so that layouts and barriers follow the shader and are never written twice.
#include <map>
#include <string>

#include "kernel.hpp"

namespace inverse::gpu {
namespace {

constexpr uint32_t kMagic = 0x07230203;
enum Op : uint32_t {
  TypeImage = 25,
  TypeSampledImage = 27,
  TypePointer = 32,
  Variable = 59,
  Decorate = 71,
  MemberDecorate = 72
};
enum Decoration : uint32_t { NonWritable = 24, NonReadable = 25, Binding = 33 };
enum Storage : uint32_t { UniformConstant = 0, StorageBuffer = 12 };

struct Facts {
  bool non_writable = false, non_readable = false, has_binding = false;
  uint32_t binding = 0;
};

}  // namespace

std::vector<Slot> reflect_slots(std::span<const uint32_t> spirv, const char* name) {
  const auto broken = [&](const std::string& why) {
    return Error(ErrorKind::internal, std::string("kernel ") + name + ": " + why);
  };
  if (spirv.size() < 5 || spirv[0] != kMagic) throw broken("not SPIR-V");
  std::map<uint32_t, Facts> facts;       // by id: variables and block types
  std::map<uint32_t, uint32_t> pointee;  // pointer type -> type
  std::map<uint32_t, std::pair<uint32_t, uint32_t>>
      variables;  // id -> (pointer type, storage class)
  for (size_t at = 5; at < spirv.size();) {
    const uint32_t length = spirv[at] >> 16, op = spirv[at] & 0xffff;
    if (!length || at + length > spirv.size()) throw broken("SPIR-V is cut off");
    const auto word = [&](uint32_t i) { return spirv[at + i]; };
    if (op == Decorate && word(2) == Binding) {
      facts[word(1)].binding = word(3);
      facts[word(1)].has_binding = true;
    } else if (op == Decorate || op == MemberDecorate) {
      const uint32_t decoration = word(op == Decorate ? 2 : 3);
      if (decoration == NonWritable) facts[word(1)].non_writable = true;
      if (decoration == NonReadable) facts[word(1)].non_readable = true;
    } else if (op == TypePointer) {
      pointee[word(1)] = word(3);
    } else if (op == Variable) {
      variables[word(2)] = {word(1), word(3)};
    }
    at += length;
  }
  std::vector<Slot> slots;
  std::vector<bool> seen;
  for (const auto& [id, variable] : variables) {
    const auto [type, storage] = variable;
    if (!facts[id].has_binding) continue;
    const uint32_t binding = facts[id].binding;
    const Facts& block = facts[pointee[type]];
    if (slots.size() <= binding) {
      slots.resize(binding + 1);
      seen.resize(binding + 1);
    }
    seen[binding] = true;
    if (storage == UniformConstant) {
      slots[binding] = {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, true, false};
    } else if (storage == StorageBuffer) {
      slots[binding] = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                        !(block.non_readable || facts[id].non_readable),
                        !(block.non_writable || facts[id].non_writable)};
    } else {
      throw broken("binding " + std::to_string(binding) +
                   " is neither a texel nor a storage buffer");
    }
  }
  for (size_t i = 0; i < seen.size(); ++i)
    if (!seen[i]) throw broken("nothing at binding " + std::to_string(i));
  return slots;
}

}  // namespace inverse::gpu

// SPDX-License-Identifier: LGPL-2.1-or-later
#include "elf_symbols.hpp"

#include <elf.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <vector>

namespace inverse::bundle {
namespace {

/// The bytes of an ELF file; what lies outside of it reads as nothing.
class Image {
 public:
  explicit Image(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(file), {});
  }
  template <typename T>
  std::optional<T> at(uint64_t offset) const {
    if (offset > bytes_.size() || bytes_.size() - offset < sizeof(T)) return {};
    T value;
    std::memcpy(&value, &bytes_[offset], sizeof value);
    return value;
  }
  std::string text(uint64_t offset) const {
    if (offset >= bytes_.size()) return {};
    return {&bytes_[offset], strnlen(&bytes_[offset], bytes_.size() - offset)};
  }

 private:
  std::vector<char> bytes_;
};

std::vector<Elf64_Shdr> sections_of(const Image& image) {
  const auto header = image.at<Elf64_Ehdr>(0);
  if (!header || std::memcmp(header->e_ident, ELFMAG, SELFMAG) != 0 ||
      header->e_ident[EI_CLASS] != ELFCLASS64 || header->e_ident[EI_DATA] != ELFDATA2LSB)
    return {};
  std::vector<Elf64_Shdr> sections;
  for (uint64_t i = 0; i < header->e_shnum; ++i) {
    const auto section = image.at<Elf64_Shdr>(header->e_shoff + i * header->e_shentsize);
    if (!section) return {};
    sections.push_back(*section);
  }
  return sections;
}

/// Names of the versions that a library defines, by index.
std::map<uint16_t, std::string> versions_of(const Image& image, const Elf64_Shdr& definitions,
                                            uint64_t strings) {
  std::map<uint16_t, std::string> names;
  uint64_t at = definitions.sh_offset;
  for (uint32_t i = 0; i < definitions.sh_info; ++i) {
    const auto definition = image.at<Elf64_Verdef>(at);
    if (!definition) break;
    const auto name = image.at<Elf64_Verdaux>(at + definition->vd_aux);
    // The first one names the library itself.
    if (name && !(definition->vd_flags & VER_FLG_BASE))
      names[definition->vd_ndx] = image.text(strings + name->vda_name);
    at += definition->vd_next;
  }
  return names;
}

}  // namespace

std::set<std::string, std::less<>> defined_symbols(const std::filesystem::path& path) {
  const Image image(path);
  const auto sections = sections_of(image);
  const Elf64_Shdr *table = nullptr, *numbers = nullptr, *definitions = nullptr;
  for (const Elf64_Shdr& section : sections) {
    if (section.sh_type == SHT_DYNSYM) table = &section;
    if (section.sh_type == SHT_GNU_versym) numbers = &section;
    if (section.sh_type == SHT_GNU_verdef) definitions = &section;
  }
  if (!table || table->sh_link >= sections.size()) return {};
  const uint64_t strings = sections[table->sh_link].sh_offset;
  const auto versions =
      definitions ? versions_of(image, *definitions, strings) : std::map<uint16_t, std::string>{};
  std::set<std::string, std::less<>> names;
  for (uint64_t i = 0; i < table->sh_size / sizeof(Elf64_Sym); ++i) {
    const auto symbol = image.at<Elf64_Sym>(table->sh_offset + i * sizeof(Elf64_Sym));
    if (!symbol) break;
    if (symbol->st_shndx == SHN_UNDEF || ELF64_ST_BIND(symbol->st_info) == STB_LOCAL) continue;
    std::string name = image.text(strings + symbol->st_name);
    if (numbers) {
      const auto number = image.at<uint16_t>(numbers->sh_offset + i * sizeof(uint16_t));
      const auto version = versions.find(number.value_or(0) & 0x7fff);  // the top bit: hidden
      if (version != versions.end()) name += '@' + version->second;
    }
    names.insert(std::move(name));
  }
  return names;
}

}  // namespace inverse::bundle

// SPDX-License-Identifier: LGPL-2.1-or-later
#include "libraries.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>

#include "elf_symbols.hpp"

namespace inverse::bundle {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLoader = "ld-linux-x86-64.so.2";

/// Paths of the host's 64-bit libraries by name, from what ldconfig wrote.
std::map<std::string, fs::path> read_cache() {
  constexpr char kMagic[] = "glibc-ld.so.cache1.1";
  constexpr int32_t kX86_64 = 0x0303;  // an ELF library for glibc, of this machine
  struct Header {
    char magic[sizeof kMagic - 1];
    uint32_t count, string_bytes;
    uint32_t unused[5];
  };
  struct Entry {
    int32_t flags;
    uint32_t name, path, os;
    uint64_t hardware;
  };
  std::ifstream file("/etc/ld.so.cache", std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  const size_t start = bytes.find(kMagic);  // an older format may come before
  Header header;
  if (start == std::string::npos || bytes.size() - start < sizeof header) return {};
  std::memcpy(&header, &bytes[start], sizeof header);
  const auto text = [&](uint32_t offset) {
    const size_t at = start + offset;
    return at < bytes.size() ? std::string(bytes.c_str() + at) : std::string();
  };
  std::map<std::string, fs::path> paths;
  for (size_t i = 0; i < header.count; ++i) {
    Entry entry;
    const size_t at = start + sizeof header + i * sizeof entry;
    if (bytes.size() < at + sizeof entry) break;
    std::memcpy(&entry, &bytes[at], sizeof entry);
    // Those for newer processors come first and lie in folders of their own.
    if (entry.flags == kX86_64 && entry.hardware == 0)
      paths.emplace(text(entry.name), text(entry.path));
  }
  return paths;
}

/// Where the host's dynamic loader would find a library.
class Host {
 public:
  Host() : cache_(read_cache()) {
    const char* folders = std::getenv("LD_LIBRARY_PATH");
    std::stringstream list(folders ? folders : "");
    for (std::string folder; std::getline(list, folder, ':');)
      if (!folder.empty()) preferred_.emplace_back(folder);
  }
  fs::path find(const std::string& name) const {
    if (fs::path path = find_in(preferred_, name); !path.empty()) return path;
    const auto cached = cache_.find(name);
    if (cached != cache_.end() && exists(cached->second)) return cached->second;
    return find_in({"/lib/x86_64-linux-gnu", "/usr/lib/x86_64-linux-gnu", "/lib64", "/usr/lib64",
                    "/lib", "/usr/lib"},
                   name);
  }

 private:
  static bool exists(const fs::path& path) {
    std::error_code ignored;
    return fs::exists(path, ignored);
  }
  static fs::path find_in(const std::vector<fs::path>& folders, const std::string& name) {
    const auto found = std::find_if(folders.begin(), folders.end(),
                                    [&](const fs::path& f) { return exists(f / name); });
    return found == folders.end() ? fs::path() : *found / name;
  }
  std::vector<fs::path> preferred_;
  std::map<std::string, fs::path> cache_;
};

/// Compares the host's libraries with the lists in a folder of lib/shared.
Shared compare(const Host& host, const fs::path& folder) {
  Shared shared{folder.filename(), {}, {}};
  for (const auto& file : fs::directory_iterator(folder)) {
    if (file.path().extension() != ".needed") continue;
    const std::string name = file.path().stem();
    std::ifstream list(file.path());
    std::string symbol;
    const bool needed = !!std::getline(list, symbol);
    const fs::path found = host.find(name);
    if (needed && found.empty()) return {shared.name, {}, {}};
    if (shared.host.empty()) shared.host = found;
    if (!needed) continue;
    const auto defined = defined_symbols(found);
    do {
      if (!defined.contains(symbol)) {
        shared.lacks = symbol;
        return shared;
      }
    } while (std::getline(list, symbol));
  }
  return shared;
}

}  // namespace

Libraries choose_libraries(const fs::path& folder) {
  const Host host;
  Libraries chosen;
  chosen.loader = folder / "lib/shared/glibc" / kLoader;
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(folder / "lib/shared")) {
    const Shared& shared = chosen.shared.emplace_back(compare(host, entry.path()));
    if (!shared.from_host())
      folders.push_back(entry.path());
    else if (shared.name == "glibc")
      chosen.loader = host.find(kLoader);
  }
  std::sort(chosen.shared.begin(), chosen.shared.end(),
            [](const Shared& a, const Shared& b) { return a.name < b.name; });
  folders.push_back(folder / "lib/own");
  for (const fs::path& each : folders) {
    if (!chosen.path.empty()) chosen.path += ':';
    chosen.path += each.string();
  }
  if (const char* own = std::getenv("LD_LIBRARY_PATH"); own && *own)
    chosen.path.append(":").append(own);
  return chosen;
}

}  // namespace inverse::bundle

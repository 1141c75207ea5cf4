// SPDX-License-Identifier: LGPL-2.1-or-later
// Untrusted names of files in a mesh: whatever they are, only a file in the mesh's folder is read.
#include <unistd.h>

#include <assimp/IOStream.hpp>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>

#include "gst/material/mesh/mesh_system.hpp"

namespace {

namespace fs = std::filesystem;

/// A mesh's folder with a file, one below, a file beside it, and links to that. Removed at exit.
struct Folder {
  Folder() {
    fs::create_directories(path / "model/parts");
    for (const char* name : {"out.bin", "model/in.bin", "model/parts/part.bin"})
      std::ofstream(path / name) << (name[0] == 'o' ? "outside" : "inside");
    fs::create_symlink("../out.bin", path / "model/link.bin");
    fs::create_directory_symlink("..", path / "model/up");
  }
  ~Folder() { fs::remove_all(path); }
  const fs::path path = fs::temp_directory_path() / ("inverse-fuzz-" + std::to_string(getpid()));
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const Folder folder;
  const std::string model = folder.path / "model/", name(reinterpret_cast<const char*>(data), size);
  const auto system = inverse::mesh_system(model + "a.gltf", "inside");
  for (const std::string& path : {model + name, name}) {
    try {
      Assimp::IOStream* stream = system->Open(path.c_str(), "rb");
      if (!stream) continue;
      std::string content(stream->FileSize(), '\0');
      stream->Read(content.data(), 1, content.size());
      system->Close(stream);
      if (content != "inside") abort();
    } catch (const std::exception&) {
    }
  }
  return 0;
}

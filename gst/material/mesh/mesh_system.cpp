// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mesh_system.hpp"

#include <assimp/DefaultIOSystem.h>

#include <assimp/IOStream.hpp>
#include <cstdint>
#include <filesystem>
#include <stdexcept>

#include "common/file_extension.hpp"
#include "common/regular_file.hpp"

namespace inverse {
namespace {

constexpr uintmax_t kMaxBytes = uintmax_t{1} << 30;

/// A file as Assimp reads it. Some of Assimp's readers loop for ever behind its end: this
/// one throws then.
class BoundedStream final : public Assimp::IOStream {
 public:
  BoundedStream(Assimp::IOSystem& system, Assimp::IOStream* inner)
      : system_(system), inner_(inner) {}
  BoundedStream(const BoundedStream&) = delete;
  BoundedStream& operator=(const BoundedStream&) = delete;
  ~BoundedStream() override { system_.Close(inner_); }

  size_t Read(void* to, size_t size, size_t count) override {
    constexpr int kMaxEmptyReads = 1000;
    const size_t got = inner_->Read(to, size, count);
    if (got == 0 && ++in_vain_ > kMaxEmptyReads)
      throw std::runtime_error("the file ends too early");
    return got;
  }
  size_t Write(const void*, size_t, size_t) override { return 0; }
  aiReturn Seek(size_t offset, aiOrigin origin) override { return inner_->Seek(offset, origin); }
  size_t Tell() const override { return inner_->Tell(); }
  size_t FileSize() const override { return inner_->FileSize(); }
  void Flush() override {}

 private:
  Assimp::IOSystem& system_;
  Assimp::IOStream* inner_;
  int in_vain_ = 0;
};

/// The files of a mesh.
class BoundedSystem final : public Assimp::DefaultIOSystem {
 public:
  explicit BoundedSystem(const std::string& mesh)
      : mesh_(mesh), obj_(extension_of(mesh) == "obj") {}

  bool Exists(const char* file) const override {  // Assimp's own opens it
    return asks_for_shape(file) && why_no_mesh(file).empty();
  }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    std::error_code status;
    if (!asks_for_shape(file) || !std::filesystem::exists(file, status)) return nullptr;
    if (const std::string why = why_no_mesh(file); !why.empty())
      throw std::runtime_error(file + (" " + why));
    Assimp::IOStream* inner = DefaultIOSystem::Open(file, mode);
    return inner ? new BoundedStream(files_, inner) : nullptr;
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  /// What an OBJ names are materials.
  bool asks_for_shape(const std::string& file) const { return !obj_ || file == mesh_; }

  Assimp::DefaultIOSystem files_;
  std::string mesh_;
  bool obj_;
};

}  // namespace

std::string why_no_mesh(const std::string& path) {
  if (std::string why = why_no_file(path); !why.empty()) return why;
  std::error_code status;
  return std::filesystem::file_size(path, status) > kMaxBytes
             ? "is larger than 1 GiB; simplify it, with Blender's Decimate for example"
             : "";
}

std::unique_ptr<Assimp::IOSystem> mesh_system(const std::string& mesh) {
  return std::make_unique<BoundedSystem>(mesh);
}

}  // namespace inverse

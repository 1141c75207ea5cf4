// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mesh_system.hpp"

#include <algorithm>
#include <array>
#include <assimp/IOStream.hpp>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include "common/file_extension.hpp"
#include "common/open_file.hpp"

namespace inverse {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMaxBytes = uint64_t{1} << 29;
constexpr const char* kRemedy = "; simplify it, with Blender's Decimate for example";

/// A file as Assimp reads it. Some of Assimp's readers loop for ever behind its end: this
/// one throws then.
class MeshStream final : public Assimp::IOStream {
 public:
  explicit MeshStream(std::shared_ptr<const std::string> content) : content_(std::move(content)) {}

  size_t Read(void* to, size_t size, size_t count) override {
    constexpr int kMaxEmptyReads = 1000;
    const size_t got = size == 0 ? 0 : std::min(count, (content_->size() - at_) / size);
    if (got == 0 && ++in_vain_ > kMaxEmptyReads)
      throw std::runtime_error("the file ends too early");
    if (got) std::memcpy(to, content_->data() + at_, got * size);
    at_ += got * size;
    return got;
  }
  size_t Write(const void*, size_t, size_t) override { return 0; }
  aiReturn Seek(size_t offset, aiOrigin origin) override {
    const size_t from = origin == aiOrigin_SET   ? 0
                        : origin == aiOrigin_CUR ? at_
                                                 : content_->size();
    const size_t to = from + offset;  // wraps: offsets may be meant as negative
    if (to > content_->size()) return aiReturn_FAILURE;
    at_ = to;
    return aiReturn_SUCCESS;
  }
  size_t Tell() const override { return at_; }
  size_t FileSize() const override { return content_->size(); }
  void Flush() override {}

 private:
  std::shared_ptr<const std::string> content_;
  size_t at_ = 0;
  int in_vain_ = 0;
};

/// The files of a mesh.
class MeshSystem final : public Assimp::IOSystem {
 public:
  MeshSystem(const std::string& mesh, std::string content)
      : mesh_(mesh), content_(std::make_shared<const std::string>(std::move(content))) {
    const fs::path folder = fs::path(mesh).parent_path();
    folder_ = fs::canonical(folder.empty() ? "." : folder);
  }

  bool Exists(const char* file) const override {
    std::error_code status;
    return file == mesh_ || (asks_for_shape() && fs::is_regular_file(file, status));
  }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char*) override {
    if (file == mesh_) return new MeshStream(content_);
    std::error_code status;
    if (!asks_for_shape() || !fs::exists(file, status)) return nullptr;
    const OpenFile found(file);
    // Where it is by links and dots, so of what was opened.
    if (found.fault().empty() && !is_within(folder_, found.real_path()))
      throw std::runtime_error(std::string("it names the file ") + file +
                               ", which is not in its folder: copy it there");
    std::string fault;
    std::string content = read_file(found, kMaxBytes, fault);
    if (!fault.empty()) throw std::runtime_error(file + (" " + fault));
    return new MeshStream(std::make_shared<const std::string>(std::move(content)));
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  /// What an OBJ names are materials.
  bool asks_for_shape() const { return extension_of(mesh_) != "obj"; }

  std::string mesh_;
  fs::path folder_;  // without links
  std::shared_ptr<const std::string> content_;
};

}  // namespace

std::string read_mesh(const std::string& path, std::string& fault) {
  const OpenFile file(path);
  fault = file.fault();
  // Before the rest is read. Only PLY and GLB have bytes that are no text, and they have names.
  std::array<char, 4096> head{};
  const size_t got = fault.empty() ? file.read(0, head.data(), head.size()) : 0;
  const std::string_view start(head.data(), got);
  if (!start.starts_with("ply") && !start.starts_with("glTF") && start.find('\0') != start.npos)
    fault = "is no mesh but other data, or damaged";
  if (!fault.empty()) return {};
  std::string content = read_file(file, kMaxBytes, fault);
  if (fault.starts_with("is larger")) fault += kRemedy;
  return content;
}

bool is_within(const fs::path& folder, const fs::path& file) {
  const auto [rest, none] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  return rest == folder.end() && file.is_absolute();
}

std::unique_ptr<Assimp::IOSystem> mesh_system(const std::string& mesh, std::string content) {
  return std::make_unique<MeshSystem>(mesh, std::move(content));
}

}  // namespace inverse

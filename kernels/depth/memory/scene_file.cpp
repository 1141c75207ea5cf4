// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene_file.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <type_traits>
#include <unordered_set>

#include "common/checksum.hpp"
#include "common/open_file.hpp"
#include "common/replace_file.hpp"
#include "kernels/depth/mesh.hpp"

namespace inverse {
namespace {

static_assert(std::endian::native == std::endian::little, "files are little endian");

constexpr std::string_view kMagic = "gst-inverse scene 2\n";

[[noreturn]] void fail(const std::string& path, const std::string& why) {
  throw Error(ErrorKind::file, "scene " + path + " " + why);
}

class Writer {
 public:
  template <typename T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <typename List>
  requires requires(const List& list) { list.data(); }
  void put(const List& values) {
    put(uint64_t{values.size()});
    bytes.append(reinterpret_cast<const char*>(values.data()),
                 sizeof(typename List::value_type) * values.size());
  }
  std::string bytes;
};

class Reader {
 public:
  Reader(std::string_view bytes, const std::string& path) : left_(bytes), path_(path) {}
  template <typename T>
  T get() {
    T value;
    take(&value, sizeof value);
    return value;
  }
  template <typename List>
  List list() {
    constexpr size_t kBytes = sizeof(typename List::value_type);
    const auto count = get<uint64_t>();
    if (count > left_.size() / kBytes) fail(path_, "ends too early; it was not copied whole");
    List values;
    values.resize(count);
    take(values.data(), kBytes * count);
    return values;
  }

 private:
  void take(void* to, size_t bytes) {
    if (bytes > left_.size()) fail(path_, "ends too early; it was not copied whole");
    if (bytes > 0) std::memcpy(to, left_.data(), bytes);
    left_.remove_prefix(bytes);
  }
  std::string_view left_;
  const std::string& path_;
};

std::string text_of(const SceneData& scene) {
  Writer writer;
  writer.put(scene.volume.voxel);
  writer.put(scene.volume.truncation);
  writer.put(scene.volume.keys);
  writer.put(scene.volume.voxels);
  writer.put(scene.volume.colors);
  writer.put(uint64_t{scene.keyframes.size()});
  for (const Keyframes::Frame& frame : scene.keyframes) {
    writer.put(frame.pose);
    writer.put(frame.picture.brightness);
    writer.put(frame.picture.depth);
  }
  writer.put(scene.strokes);
  const uint64_t sum = checksum(writer.bytes);
  std::string text(kMagic);
  text.append(reinterpret_cast<const char*>(&sum), sizeof sum);
  return text + writer.bytes;
}

bool ends_with(const std::string& path, std::string_view end) { return path.ends_with(end); }

}  // namespace

void check_scene_target(const std::string& path) {
  if (!ends_with(path, ".ply") && !ends_with(path, ".scene"))
    throw Error(ErrorKind::output, "scene " + path +
                                       " cannot be written: name it .ply for a mesh, or .scene to "
                                       "load it again");
  std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (folder.empty()) folder = ".";
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    throw Error(ErrorKind::output, "scene " + path + " cannot be written into the folder " +
                                       folder.string() + ": " + std::strerror(errno));
}

void save_scene(const SceneData& scene, const std::string& path) {
  check_scene_target(path);
  replace_file(path, ends_with(path, ".ply") ? ply_of(mesh_of(scene.volume)) : text_of(scene));
}

SceneData load_scene(const std::string& path, uint64_t max) {
  const OpenFile file(path);
  std::string fault = file.fault();
  std::array<char, kMagic.size()> magic{};
  if (fault.empty() && (file.read(0, magic.data(), magic.size()) < magic.size() ||
                        std::string_view(magic.data(), magic.size()) != kMagic))
    fault = "is no scene that this version reads; save one with save-scene";
  const std::string bytes = fault.empty() ? read_file(file, max, fault) : std::string();
  if (!fault.empty()) fail(path, fault);
  if (!bytes.starts_with(kMagic)) fail(path, "changed while it was read; load it again");
  std::string_view content = std::string_view(bytes).substr(kMagic.size());
  uint64_t sum = 0;
  if (content.size() < sizeof sum) fail(path, "ends too early; it was not copied whole");
  std::memcpy(&sum, content.data(), sizeof sum);
  content.remove_prefix(sizeof sum);
  if (checksum(content) != sum)
    fail(path, "is incomplete or damaged (its checksum differs); copy or save it again");
  Reader reader(content, path);
  SceneData scene;
  VolumeData& volume = scene.volume;
  volume.voxel = reader.get<float>();
  volume.truncation = reader.get<float>();
  volume.keys = reader.list<std::vector<uint32_t>>();
  volume.voxels = reader.list<std::vector<uint32_t>>();
  volume.colors = reader.list<std::vector<uint32_t>>();
  const size_t blocks = volume.keys.size();
  const std::unordered_set<uint32_t> distinct(volume.keys.begin(), volume.keys.end());
  if (!(volume.voxel > 0 && volume.voxel < 1 && volume.truncation >= 1) ||
      volume.voxels.size() != blocks * VolumeData::kBlockVoxels ||
      volume.colors.size() != 2 * volume.voxels.size() || distinct.size() != blocks ||
      distinct.contains(VolumeData::kNoBlock))
    fail(path, "contradicts itself; save it again");
  for (auto left = reader.get<uint64_t>(); left > 0; --left) {
    Keyframes::Frame frame{.picture = {}, .pose = reader.get<Pose>()};
    frame.picture.brightness = reader.list<std::vector<float>>();
    frame.picture.depth = reader.list<std::vector<float>>();
    const auto finite = [](const auto& values) {
      return std::ranges::all_of(values, [](float v) { return std::isfinite(v); });
    };
    if (frame.picture.brightness.size() != frame.picture.depth.size() ||
        !finite(frame.picture.brightness) || !finite(frame.picture.depth) ||
        !finite(frame.pose.rotation) || !finite(frame.pose.place))
      fail(path, "contradicts itself; save it again");
    scene.keyframes.push_back(std::move(frame));
  }
  scene.strokes = reader.list<std::string>();
  return scene;
}

}  // namespace inverse

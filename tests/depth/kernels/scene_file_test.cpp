// SPDX-License-Identifier: LGPL-2.1-or-later
// Scenes that are written, read and shown as a mesh.
#include "kernels/depth/memory/scene_file.hpp"

#include <cstdint>
#include <fstream>
#include <iterator>

#include "kernels/depth/memory/scene_memory.hpp"
#include "kernels/depth/mesh.hpp"
#include "tests/depth/kernels/volume_fixture.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {
namespace {

SceneData load(const std::string& path) { return load_scene(path, uint64_t{1} << 30); }

constexpr Volume::Params kParams{.voxel = 0.02F, .blocks = 8192};

std::string content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class SceneFileTest : public VolumeFixture {
 protected:
  static Camera camera(double t) {
    return camera_at(160, 120, {0.5 * std::sin(t) - 0.2, 0.2, 0.15 * std::cos(t)},
                     {0.1 * std::cos(t) - 0.2, 0.6, 2});
  }
  void see(Volume& volume, int frames) {
    for (int i = 0; i < frames; ++i) {
      const Seen seen = look(camera(0.4 * i));
      integrate(volume, camera(0.4 * i), reference::normals(camera(0.4 * i), seen.depth),
                seen.layers);
    }
  }
  Pixels view_of(Volume& volume) {
    const Camera from = camera(0.3);
    Volume::View view(device, extent_of(from));
    const auto pose = pose_of(from);
    run([&](gpu::Commands& commands) { volume.record_march(commands, lens_of(from), pose, view); });
    Pixels all = download(view.depth), reflectance = download(view.reflectance);
    all.insert(all.end(), reflectance.begin(), reflectance.end());
    return all;
  }
};

TEST_F(SceneFileTest, AVolumeIsRestored) {
  Volume volume(device, kParams), other(device, kParams);
  see(volume, 3);
  see(other, 1);
  const VolumeData data = volume.data();
  EXPECT_GT(data.keys.size(), 500U);
  other.restore(data);
  EXPECT_EQ(view_of(other), view_of(volume));
  // What is added goes on from there.
  see(volume, 5);
  see(other, 5);
  EXPECT_EQ(view_of(other), view_of(volume));
  Volume small(device, {.voxel = 0.02F, .blocks = 100}), coarse(device, {.voxel = 0.03F});
  EXPECT_THROW(small.restore(data), Error);
  EXPECT_THROW(coarse.restore(data), Error);
  Volume empty(device, kParams);
  EXPECT_TRUE(empty.data().keys.empty());
  other.restore(empty.data());
  const Pixels nothing = view_of(other);
  EXPECT_TRUE(std::ranges::all_of(nothing, [](float v) { return v == 0; }));
}

TEST_F(SceneFileTest, FilesAreReadBackOrRefused) {
  const TemporaryFolder folder;
  Volume volume(device, kParams);
  see(volume, 2);
  SceneData scene{volume.data(), {}, "[{\"kind\":\"select\"}]"};
  for (int i = 0; i < 3; ++i)
    scene.keyframes.push_back({{{1, 2, float(i)}, {0, 1, 2}}, {{0, 0, 0, 1}, {float(i), 2, 3, 0}}});
  const std::string path = folder.path() + "/room.scene";
  save_scene(scene, path);
  const SceneData read = load(path);
  EXPECT_EQ(read.volume.keys, scene.volume.keys);
  EXPECT_EQ(read.volume.voxels, scene.volume.voxels);
  EXPECT_EQ(read.volume.colors, scene.volume.colors);
  ASSERT_EQ(read.keyframes.size(), 3U);
  EXPECT_EQ(read.keyframes[2].picture.brightness, scene.keyframes[2].picture.brightness);
  EXPECT_EQ(read.keyframes[2].pose.place, scene.keyframes[2].pose.place);
  EXPECT_EQ(read.strokes, scene.strokes);

  EXPECT_THROW(load(folder.path() + "/missing.scene"), Error);
  EXPECT_THROW(load(folder.path()), Error);
  EXPECT_THROW(save_scene(scene, folder.path() + "/room.obj"), Error);
  EXPECT_THROW(save_scene(scene, folder.path() + "/no/room.scene"), Error);
  const std::string good = content_of(path);
  const auto refused = [&](const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
    try {
      load(path);
      return std::string("taken");
    } catch (const Error& error) {
      return std::string(error.what());
    }
  };
  EXPECT_NE(refused("").find("no scene that this version reads"), std::string::npos);
  EXPECT_NE(refused("gst-inverse scene 9\n" + good).find("no scene that this version reads"),
            std::string::npos);
  EXPECT_NE(refused(good.substr(0, 24)).find("too early"), std::string::npos);
  EXPECT_NE(refused(good.substr(0, good.size() / 2)).find("damaged"), std::string::npos);
  std::string flipped = good;
  flipped[good.size() / 3] ^= 4;
  EXPECT_NE(refused(flipped).find("damaged"), std::string::npos);
  // Whole, but with contents that do not fit together.
  SceneData wrong = scene;
  wrong.volume.keys[1] = wrong.volume.keys[0];
  save_scene(wrong, path);
  EXPECT_THROW(load(path), Error);
  wrong = scene;
  wrong.volume.voxels.pop_back();
  save_scene(wrong, path);
  EXPECT_THROW(load(path), Error);
  SceneMemory memory(device, {160, 120}, {.volume = kParams});
  EXPECT_THROW(memory.restore(scene), Error) << "keyframes of three cells";
}

TEST_F(SceneFileTest, AMeshLiesOnTheSurfaces) {
  Volume volume(device, kParams);
  see(volume, 5);
  const SceneMesh mesh = mesh_of(volume.data());
  EXPECT_GT(mesh.vertices.size(), 10'000U);
  EXPECT_GT(mesh.triangles.size(), mesh.vertices.size());
  const Camera from = camera(0.4);
  size_t seen = 0, near = 0, colored = 0, facing = 0, turned = 0;
  for (const auto& vertex : mesh.vertices) {
    // Vertices that this camera sees, against what it sees.
    const Vec3 p =
        from.to_camera({double{vertex.place[0]}, double{vertex.place[1]}, double{vertex.place[2]}});
    if (p[2] < 0.2) continue;
    const double x = from.fx * p[0] / p[2] + from.cx, y = from.fy * p[1] / p[2] + from.cy;
    if (x < 1 || y < 1 || x > from.width - 2 || y > from.height - 2) continue;
    const Hit hit = trace(Scene::room, from.place, from.turned(from.ray(x, y)));
    if (std::abs(hit.along - p[2]) > 0.06) continue;
    ++seen;
    near += std::abs(hit.along - p[2]) < 0.02;
    double off = 0, towards = 0;
    for (size_t c = 0; c < 3; ++c) {
      off = std::max(
          off, std::abs(std::log(std::max(double{vertex.reflectance[c]}, 1e-6)) - hit.color[c]));
      towards += double{vertex.normal[c]} * (from.place[c] - double{vertex.place[c]});
    }
    colored += off < 0.15;
    facing += towards > 0;
  }
  EXPECT_GT(seen, 5000U);
  EXPECT_GT(near, seen * 9 / 10);
  EXPECT_GT(colored, seen * 8 / 10);
  EXPECT_GT(facing, seen * 95 / 100);
  for (const auto& triangle : mesh.triangles) {
    std::array<Vec3, 3> corner;
    for (size_t k = 0; k < 3; ++k) {
      ASSERT_LT(triangle[k], mesh.vertices.size());
      for (size_t c = 0; c < 3; ++c) corner[k][c] = double{mesh.vertices[triangle[k]].place[c]};
    }
    Vec3 a, b;
    for (size_t c = 0; c < 3; ++c)
      a[c] = corner[1][c] - corner[0][c], b[c] = corner[2][c] - corner[0][c];
    const Vec3 normal{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                      a[0] * b[1] - a[1] * b[0]};
    double along = 0;
    for (size_t c = 0; c < 3; ++c)
      along += normal[c] * double{mesh.vertices[triangle[0]].normal[c]};
    turned += along < 0;
  }
  EXPECT_LT(turned, mesh.triangles.size() / 50) << "counterclockwise from outside";

  const std::string ply = ply_of(mesh);
  const size_t head = ply.find("end_header\n") + 11;
  EXPECT_EQ(ply.size(), head + 27 * mesh.vertices.size() + 13 * mesh.triangles.size());
  EXPECT_NE(ply.find("element vertex " + std::to_string(mesh.vertices.size()) + "\n"),
            std::string::npos);
  EXPECT_TRUE(mesh_of({}).triangles.empty());
  EXPECT_NE(ply_of({}).find("element face 0\n"), std::string::npos);
}

}  // namespace
}  // namespace inverse::testing

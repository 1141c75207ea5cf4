// SPDX-License-Identifier: LGPL-2.1-or-later
// Mesh files, good and bad ones.
#include "gst/material/mesh/mesh_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <random>
#include <sstream>

#include "common/error.hpp"
#include "tests/expect_error.hpp"
#include "tests/replaced_file.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {
namespace {

const char* kObj = R"(# a cube of packs, without normals
v -1 -1 -1
v  1 -1 -1
v  1  1 -1
v -1  1 -1
v -1 -1  1
v  1 -1  1
v  1  1  1
v -1  1  1
f 4 3 2 1
f 5 6 7 8
f 1 2 6 5
f 3 4 8 7
f 2 3 7 6
f 1 5 8 4
)";

const char* kPly = R"(ply
format ascii 1.0
element vertex 5
property float x
property float y
property float z
element face 5
property list uchar int vertex_indices
end_header
-1 0 -1
1 0 -1
1 0 1
-1 0 1
0 1.5 0
4 0 1 2 3
3 1 0 4
3 2 1 4
3 3 2 4
3 0 3 4
)";

/// A polygon of so many corners.
std::string ring(int corners, double radius = 1) {
  std::string obj, face = "f";
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    std::ostringstream line;
    line << "v " << radius * std::cos(angle) << " " << radius * std::sin(angle) << " 0\n";
    obj += line.str();
    face.append(" ").append(std::to_string(i + 1));
  }
  return obj + face + "\n";
}

/// A binary glTF with two triangles that share an edge, moved by a node: `squares` times over each
/// other, and by so many nodes; with `loose` vertices of no triangle.
std::string glb(size_t squares = 1, size_t nodes = 1, size_t loose = 0) {
  std::vector<float> positions{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  positions.resize(positions.size() + 3 * loose, 0.5F);
  const size_t place = positions.size() * sizeof(float);
  const uint16_t indices[] = {0, 1, 2, 0, 2, 3};
  std::string shown = "0", list = R"({"mesh":0,"translation":[5,6,7]})", corners;
  for (size_t i = 1; i < nodes; ++i) {
    shown.append(",").append(std::to_string(i));
    list += R"(,{"mesh":0})";
  }
  for (size_t i = 0; i < squares; ++i) corners.append(reinterpret_cast<const char*>(indices), 12);
  std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[)" + shown + R"(]}],"nodes":[)" +
      list +
      R"(],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":)" +
      std::to_string(4 + loose) +
      R"(,"type":"VEC3",)"
      R"("min":[0,0,0],"max":[1,1,0]},)"
      R"({"bufferView":1,"componentType":5123,"count":)" +
      std::to_string(6 * squares) +
      R"(,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":)" +
      std::to_string(place) + R"(},{"buffer":0,"byteOffset":)" + std::to_string(place) +
      R"(,"byteLength":)" + std::to_string(corners.size()) + R"(}],"buffers":[{"byteLength":)" +
      std::to_string(place + corners.size()) + "}]}";
  while (json.size() % 4) json += ' ';
  const auto word = [](uint32_t value) {
    return std::string(reinterpret_cast<const char*>(&value), 4);
  };
  const std::string binary =
      std::string(reinterpret_cast<const char*>(positions.data()), place) + corners;
  return "glTF" + word(2) + word(static_cast<uint32_t>(28 + json.size() + binary.size())) +
         word(static_cast<uint32_t>(json.size())) + "JSON" + json +
         word(static_cast<uint32_t>(binary.size())) + std::string("BIN\0", 4) + binary;
}

/// A glTF of one triangle whose corners are in another file.
std::string triangle_in(const std::string& uri) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
         R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
         R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],)"
         R"("bufferViews":[{"buffer":0,"byteLength":36}],)"
         R"("buffers":[{"byteLength":36,"uri":")" +
         uri + R"("}]})";
}

class MeshFile : public ::testing::Test {
 protected:
  std::string written(const std::string& name, const std::string& bytes) const {
    return folder_.write(name, bytes);
  }
  /// A mesh about which there is no warning.
  static Mesh load(const std::string& path) {
    std::string warning;
    Mesh mesh = parse_mesh(path, warning);
    EXPECT_EQ(warning, "");
    return mesh;
  }
  static std::string error(const std::string& path) {
    std::string warning;  // of what was damaged, or none
    const std::string text = error_of([&] { parse_mesh(path, warning); }, ErrorKind::file);
    if (!text.empty()) expect_contains(text, path);
    return text;
  }

  TemporaryFolder folder_;
};

}  // namespace

TEST_F(MeshFile, ObjWithoutNormalsGetsThem) {
  const Mesh cube = load(written("cube.obj", kObj));
  EXPECT_EQ(cube.triangles(), 12u);
  EXPECT_EQ(cube.positions.size(), 24u) << "a cube's edges are sharp";
  for (size_t i = 0; i < cube.positions.size(); ++i) {
    const auto &p = cube.positions[i], &n = cube.normals[i];
    EXPECT_NEAR(std::hypot(p[0], p[1], p[2]), 1, 1e-5) << "corners at radius 1";
    EXPECT_NEAR(std::hypot(n[0], n[1], n[2]), 1, 1e-5);
    EXPECT_NEAR(p[0] * n[0] + p[1] * n[1] + p[2] * n[2], 1 / std::sqrt(3), 1e-5);
  }
}

TEST_F(MeshFile, PlyAndGltf) {
  const Mesh pyramid = load(written("pyramid.ply", kPly));
  EXPECT_EQ(pyramid.triangles(), 6u);
  const Mesh square = load(written("SQUARE.GLB", glb()));
  EXPECT_EQ(square.triangles(), 2u);
  EXPECT_EQ(square.positions.size(), 4u) << "corners are joined";
  for (const auto& n : square.normals) EXPECT_NEAR(n[2], 1, 1e-5);
}

TEST_F(MeshFile, AMarkOfTextIsPassedOver) {
  const std::string plain = "v 0 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\n";
  std::string warning;
  const Mesh mesh = parse_mesh(folder_.write("plain.obj", plain), warning),
             marked = parse_mesh(folder_.write("marked.obj", "\xef\xbb\xbf" + plain), warning);
  EXPECT_EQ(marked.positions, mesh.positions);
  EXPECT_EQ(marked.indices, mesh.indices);
}

TEST_F(MeshFile, WhatWouldBeReadInPartIsRefused) {
  const auto fault = [&](const std::string& name, const std::string& content) {
    std::string warning;
    try {
      parse_mesh(folder_.write(name, content), warning);
      return std::string("taken");
    } catch (const Error& error) {
      return std::string(error.what());
    }
  };
  EXPECT_NE(fault("strips.ply",
                  "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                  "property float z\nelement tristrips 1\nproperty list int int vertex_indices\n"
                  "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0.3\n4 0 1 2 3\n")
                .find("strips of triangles"),
            std::string::npos);
  for (const char* extension : {"KHR_mesh_quantization", "EXT_meshopt_compression"})
    EXPECT_NE(fault("packed.gltf", std::string(R"({"asset":{"version":"2.0"},"nodes":[],)") +
                                       R"("extensionsRequired":["KHR_texture_transform",")" +
                                       extension + "\"]}")
                  .find(std::string("requires the glTF extension ") + extension),
              std::string::npos);
}

TEST_F(MeshFile, InvalidFilesAreErrorsWithTheirCause) {
  expect_contains(error("/nowhere/a.obj"), "No such file");
  expect_contains(error("/tmp"), "is no file");
  expect_contains(error(written("cube.txt", kObj)), "is not named as an OBJ");
  for (const char* name : {"empty.obj", "empty.ply"})
    expect_contains(error(written(name, "")), "cannot be read");
  for (const char* name : {"empty.glb", "empty.gltf"})
    expect_contains(error(written(name, "")), "is not valid JSON at line 1, column");
  for (const char* name : {"sparse.obj", "sparse.gltf"}) {
    const std::string sparse = written(name, "");
    std::filesystem::resize_file(sparse, uint64_t{900} << 20);
    expect_contains(error(sparse), "is no mesh but other data");
  }
  expect_contains(error(written("points.obj", "v 0 0 0\nv 1 1 1\n")),
                  "has no triangle with an area");
  expect_contains(error(written("line.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n")),
                  "has no triangle with an area");
  expect_contains(error(written("beyond.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")),
                  "cannot be read");
  expect_contains(error(written("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")),
                  "has no triangle with an area");
}

TEST_F(MeshFile, TruncatedAndDamagedFilesAreMeshesOrErrors) {
  const std::pair<const char*, std::string> files[] = {
      {"a.obj", kObj}, {"a.ply", kPly}, {"a.glb", glb()}};
  std::mt19937 random(1);
  const auto expect_mesh_or_error = [&](const char* name, const std::string& bytes) {
    const std::string path = written(name, bytes);
    std::string warning;
    Mesh mesh;
    if (!error_of([&] { mesh = parse_mesh(path, warning); }, ErrorKind::file).empty()) return;
    EXPECT_GT(mesh.triangles(), 0U);
    EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
    for (const uint32_t index : mesh.indices) ASSERT_LT(index, mesh.positions.size());
    for (const auto& p : mesh.positions) ASSERT_LT(std::hypot(p[0], p[1], p[2]), 1 + 1e-5);
  };
  for (const auto& [name, whole] : files) {
    for (size_t length = 0; length < whole.size(); length += 11)
      expect_mesh_or_error(name, whole.substr(0, length));
    for (int i = 0; i < 150; ++i) {
      std::string bytes = whole;
      for (int k = 0; k < 2; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
      expect_mesh_or_error(name, bytes);
    }
  }
}

/// A binary PLY of a strip of so many triangles.
std::string strip(int triangles, bool big_endian) {
  const std::string count = std::to_string(triangles), corners = std::to_string(triangles + 2);
  std::string ply = std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
                    "_endian 1.0\nelement vertex " + corners +
                    "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                    count + "\nproperty list uchar int vertex_indices\nend_header\n";
  const auto add = [&](const auto& value) {
    std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
    if (big_endian) std::reverse(bytes.begin(), bytes.end());
    ply += bytes;
  };
  for (int i = 0; i < triangles + 2; ++i) {
    const int column = i / 2, row = i % 2;
    for (const int at : {column, row, 0}) add(static_cast<float>(at));
  }
  for (int i = 0; i < triangles; ++i) {
    add(uint8_t{3});
    for (const int corner : {i, i + 1, i + 2}) add(corner);
  }
  return ply;
}

// Assimp makes up what lies beyond the end.
TEST_F(MeshFile, TruncatedBinaryPlyIsAnErrorThatNamesWhatIsThere) {
  constexpr size_t kFace = 13, kFaces = 200 * kFace;
  for (const bool big_endian : {false, true}) {
    const std::string ply = strip(200, big_endian);
    EXPECT_EQ(load(written("whole.ply", ply)).triangles(), 200U);
    EXPECT_EQ(load(written("more.ply", ply + "\n")).triangles(), 200U);
    for (const auto& [bytes, there] : {std::pair{kFaces, 0}, {kFace, 199}, {size_t{1}, 199}}) {
      const std::string text = error(written("cut.ply", ply.substr(0, ply.size() - bytes)));
      expect_contains(text, "of 200 elements \"face\" it has " + std::to_string(there));
    }
    const std::string text = error(written("cut.ply", ply.substr(0, ply.size() - kFaces - 25)));
    expect_contains(text, "of 202 elements \"vertex\" it has 199");
  }
}

TEST_F(MeshFile, TruncatedTextPlyIsAnErrorToo) {
  const std::string ply = kPly;
  const auto lines_of = [](size_t count, const std::string& text) {
    size_t end = 0;
    while (count--) end = text.find('\n', end) + 1;
    return text.substr(0, end);
  };
  for (const auto& [cut, what] : {std::pair{ply.substr(0, ply.size() - 3), "face\" it has 4"},
                                  {lines_of(16, ply), "face\" it has 2"},
                                  {lines_of(11, ply), "vertex\" it has 2"}}) {
    const std::string text = error(written("cut.ply", cut));
    expect_contains(text, std::string("of 5 elements \"") + what);
  }
}

TEST_F(MeshFile, CountsInPlyThatCannotBeAreErrors) {
  const auto with = [](const std::string& count, const std::string& comment = "") {
    std::string ply = kPly;
    ply.replace(ply.find("vertex 5"), 8, "vertex " + count);
    return ply.insert(ply.find("element"), comment);
  };
  const std::string comment = "comment " + std::string(5000, 'x') + "\r\nobj_info element face 9\n";
  for (const char* count : {"4000000000", "99999999999999999999"}) {
    const std::string text = error(written("vast.ply", with(count, comment)));
    expect_contains(text, "elements \"vertex\" it has 1");
  }
  std::string list = strip(2, false);
  list.replace(list.find("list uchar"), 10, "list char ").replace(list.size() - 26, 1, "\xff");
  expect_contains(error(written("list.ply", list)), "of 2 elements \"face\" it has 0");
  expect_contains(error(written("negative.ply", with("-1"))), "its header declares -1 elements");
  EXPECT_EQ(load(written("good.ply", with("5", comment))).triangles(), 6U);
}

TEST_F(MeshFile, DegenerateFacesAreDroppedWithAWarning) {
  std::string warning;
  const std::string obj = written(
      "nan.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nf 1 2 3\nf 1 2 4\nf 2 3 4\nl 1 2\n");
  EXPECT_EQ(parse_mesh(obj, warning).triangles(), 1U);
  expect_contains(warning, obj + ": 2 of 3 faces were dropped");
}

TEST_F(MeshFile, TooManyTrianglesAreAnErrorThatNamesTheLimit) {
  const auto grid = [](int side) {
    std::string obj;
    for (int y = 0; y <= side; ++y)
      for (int x = 0; x <= side; ++x)
        obj += "v " + std::to_string(x) + " " + std::to_string(y) + " " +
               std::to_string(x * y % 7) + "\n";
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const int a = y * (side + 1) + x + 1, b = a + side + 1;
        obj += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " +
               std::to_string(b + 1) + "\nf " + std::to_string(a) + " " + std::to_string(b + 1) +
               " " + std::to_string(b) + "\n";
      }
    return obj;
  };
  expect_contains(error(written("many.obj", grid(708))), "at most 1000000");
  EXPECT_EQ(load(written("some.obj", grid(100))).triangles(), 20000u);
}

TEST_F(MeshFile, TheLimitCountsTrianglesOfEveryInstance) {
  std::string faces = ring(1000);
  const std::string face = faces.substr(faces.find('f'));
  for (int i = 0; i < 1002; ++i) faces += face;
  const std::string polygons = error(written("polygons.obj", faces));
  expect_contains(polygons, "1000994 triangles; at most 1000000");
  const std::string copies = error(written("copies.glb", glb(1000, 501)));
  expect_contains(copies, "1002000 triangles; at most 1000000");
  EXPECT_EQ(load(written("few.glb", glb(10, 3))).triangles(), 60u);
}

TEST_F(MeshFile, UnusedVerticesTakeNoMemoryForInstances) {
  // Assimp would copy a million for each of 5000 nodes, and count to 2^32 at most.
  const Mesh mesh = load(written("loose.glb", glb(1, 5000, 1000000)));
  EXPECT_EQ(mesh.triangles(), 10000u);
  EXPECT_LE(mesh.positions.size(), 30000u);
}

TEST_F(MeshFile, PolygonsOfVeryManyCornersAreRefusedAtOnce) {
  EXPECT_EQ(load(written("round.obj", ring(1000))).triangles(), 998u);
  const std::string more = error(written("rounder.obj", ring(1001)));
  expect_contains(more, "a polygon of 1001 corners; at most 1000");
  expect_contains(more, "triangulate it");
  // Before Assimp cuts it up, which would take half a minute, and leave no polygon.
  expect_contains(error(written("far.obj", ring(60000))), "60000 corners");
}

// Files are in meters, millimeters or miles.
TEST_F(MeshFile, PolygonsOfEveryUnitBecomeTriangles) {
  for (const double radius : {1e-12, 1e-4, 0.01, 1.0, 1e9})
    EXPECT_EQ(load(written("unit.obj", ring(64, radius))).triangles(), 62U) << radius;
}

// Corners in one place are compared with each other to find normals: of 80 000, half a minute.
TEST_F(MeshFile, VeryManyFacesInOneCornerNeedNormals) {
  const auto fan = [](int faces, bool normals) {
    std::string obj = "v 0 0 0\nvn 0 0 1\n";
    for (int i = 0; i <= faces; ++i) {
      const double angle = 2 * std::numbers::pi * i / (faces + 1);
      obj += "v " + std::to_string(100000 * std::cos(angle)) + " " +
             std::to_string(100000 * std::sin(angle)) + " 0\n";
    }
    const char* normal = normals ? "//1" : "";
    for (int i = 0; i < faces; ++i) {
      obj.append("f");
      for (const int corner : {1, i + 2, i + 3})
        obj.append(" ").append(std::to_string(corner)).append(normal);
      obj.append("\n");
    }
    return obj;
  };
  EXPECT_EQ(load(written("few.obj", fan(1000, false))).triangles(), 1000U);
  expect_contains(error(written("many.obj", fan(80000, false))), "store it with normals");
  EXPECT_EQ(load(written("normals.obj", fan(80000, true))).triangles(), 80000U);
}

// Assimp goes down nodes by recursion, and once for each parent.
TEST_F(MeshFile, NodesOfGltfThatAreNoTreeAreRefused) {
  const auto file = [](const std::string& nodes) {
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)" + nodes +
           "]}";
  };
  std::string chain, doubled;
  for (int i = 0; i < 20000; ++i) chain += R"({"children":[)" + std::to_string(i + 1) + "]},";
  for (int i = 1; i < 40; ++i) {
    const std::string below = std::to_string(i);
    doubled.append(R"({"children":[)").append(below).append(",").append(below).append("]},");
  }
  expect_contains(error(written("chain.gltf", file(chain + "{}"))), "below each other");
  expect_contains(error(written("doubled.gltf", file(doubled + "{}"))), "more than one parent (1)");
  expect_contains(error(written("ring.gltf", file(R"({},{"children":[2]},{"children":[1]})"))),
                  "below themselves");
  expect_contains(error(written("brackets.gltf", std::string(100000, '['))), "nests its JSON");
  // Assimp's reader takes the first of two, others the last.
  std::string two = file(R"({},{"children":[2]},{"children":[1]})");
  two.insert(two.size() - 1, R"(,"nodes":[])");
  expect_contains(error(written("two.gltf", two)), "has the field \"nodes\" twice");
}

// Of glTF 1.0, which names what 2.0 numbers, too.
TEST_F(MeshFile, NamedNodesOfGltfThatAreNoTreeAreRefused) {
  const auto file = [](const std::string& nodes) {
    return R"({"asset":{"version":"1.0"},"scene":"s","scenes":{"s":{"nodes":["n0"]}},"nodes":{)" +
           nodes + "}}";
  };
  const auto node = [](int i, const std::string& children) {
    return "\"n" + std::to_string(i) + R"(":{"children":[)" + children + "]}";
  };
  expect_contains(error(written("ring.gltf", file(node(0, R"("n1")") + "," + node(1, R"("n0")")))),
                  "below themselves");
  std::string chain;
  for (int i = 0; i < 20000; ++i) chain += node(i, "\"n" + std::to_string(i + 1) + "\"") + ",";
  expect_contains(error(written("chain.gltf", file(chain + node(20000, "")))), "below each other");
}

// It names another file, which is no better than the first.
TEST_F(MeshFile, FilesThatAMeshNamesAreCheckedToo) {
  const std::string pipe = folder_ / "pipe.bin";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  ASSERT_EQ(mkfifo((folder_ / "pipe.mtl").c_str(), 0600), 0);
  for (const char* library : {"pipe.mtl", "PIPE.MTL", "pipe.mtl ", "nowhere.mat"})
    EXPECT_EQ(load(written("painted.obj", std::string("mtllib ") + library +
                                              "\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
                                              "f 1 2 3\n"))
                  .triangles(),
              1U)
        << library;
  const std::string text = error(written("far.gltf", triangle_in("pipe.bin")));
  expect_contains(text, "pipe.bin");
}

TEST_F(MeshFile, FilesOutsideOfTheFolderOfAMeshAreRefused) {
  namespace fs = std::filesystem;
  const std::vector<float> corners{0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::string bytes(reinterpret_cast<const char*>(corners.data()), 36);
  fs::create_directories(folder_ / "model/parts");
  written("far.bin", bytes);
  written("model/near.bin", bytes);
  written("model/parts/part.bin", bytes);
  fs::create_symlink(folder_ / "far.bin", folder_ / "model/link.bin");
  fs::create_directory_symlink(folder_.path(), folder_ / "model/up");
  fs::create_directory_symlink(folder_ / "model", folder_ / "linked");
  const auto mesh = [&](const std::string& uri) {
    return written("model/a.gltf", triangle_in(uri));
  };
  for (const std::string& uri :
       {std::string("../far.bin"), std::string("parts/../../far.bin"), std::string("link.bin"),
        std::string("up/far.bin"), folder_ / "far.bin"}) {
    const std::string text = error(mesh(uri));
    // Assimp puts the folder before whatever is named: an absolute path is none that is there.
    expect_contains(text, uri.starts_with('/') ? uri : uri + ", which is not in its folder");
  }
  for (const char* uri : {"near.bin", "parts/part.bin", "parts/../near.bin", "up/model/near.bin"})
    EXPECT_EQ(load(mesh(uri)).triangles(), 1U) << uri;
  EXPECT_EQ(load(folder_ / "linked/a.gltf").triangles(), 1U);
}

// Whatever is put under its name meanwhile.
TEST_F(MeshFile, IsReadFromOneOpening) {
  for (const auto& [name, content] :
       {std::pair{"a.ply", std::string(kPly)}, {"a.glb", glb()}, {"a.obj", std::string(kObj)}}) {
    const ReplacedFile file(name, {content, "damaged", "damaged", "damaged"});
    if (!file.works()) GTEST_SKIP() << "no leases on this file system";
    EXPECT_GT(load(file.path()).triangles(), 0U);
    EXPECT_EQ(file.openings(), 1) << name;
  }
}

}  // namespace inverse::testing

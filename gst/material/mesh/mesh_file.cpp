// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mesh_file.hpp"

#include <assimp/BaseImporter.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <iterator>
#include <set>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "common/error.hpp"
#include "common/file_extension.hpp"
#include "gltf_nodes.hpp"
#include "mesh_system.hpp"
#include "ply_length.hpp"
#include "sanitize_scene.hpp"

namespace inverse {
namespace {

constexpr float kCrease = 66;  // degrees
constexpr std::array<std::string_view, 4> kExtensions{"obj", "ply", "gltf", "glb"};

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw Error(ErrorKind::file, "mesh " + path + " " + what);
}

/// The content of a file that was checked.
std::string checked(const std::string& path) {
  std::string why;
  std::string content = read_mesh(path, why);
  if (!why.empty()) fail(path, why);
  // Marks of text of some editors, at which Assimp's reader of OBJ stops.
  if (content.starts_with("\xef\xbb\xbf")) content.erase(0, 3);
  const std::string extension = extension_of(path);
  if (std::find(kExtensions.begin(), kExtensions.end(), extension) == kExtensions.end())
    fail(path, "is not named as an OBJ, PLY or glTF file (.obj, .ply, .gltf, .glb)");
  if (extension.starts_with("gl"))
    if (const std::string fault = gltf_nodes_fault(content); !fault.empty()) fail(path, fault);
  if (extension == "ply")
    if (const std::string fault = ply_length_fault(content); !fault.empty()) fail(path, fault);
  return content;
}

/// Of the many formats of Assimp, only ours: fewer surprises.
void keep_our_formats(Assimp::Importer& importer) {
  for (size_t i = importer.GetImporterCount(); i-- > 0;) {
    Assimp::BaseImporter* format = importer.GetImporter(i);
    std::set<std::string> extensions;
    format->GetExtensionList(extensions);
    if (std::none_of(kExtensions.begin(), kExtensions.end(), [&](std::string_view extension) {
          return extensions.count(std::string(extension)) > 0;
        })) {
      importer.UnregisterLoader(format);
      delete format;
    }
  }
}

/// How many triangles will be made of each mesh. Throws if one has a polygon of too many
/// corners.
std::vector<size_t> triangles_of(const aiScene& scene, const std::string& path) {
  std::vector<size_t> triangles(scene.mNumMeshes, 0);
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
    const aiMesh& part = *scene.mMeshes[i];
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const unsigned corners = part.mFaces[f].mNumIndices;
      if (corners > kMaxCorners)
        fail(path, "has a polygon of " + std::to_string(corners) + " corners; at most " +
                       std::to_string(kMaxCorners) +
                       " are taken: triangulate it, with Blender's Triangulate for example");
      triangles[i] += corners > 2 ? corners - 2 : 0;
    }
  }
  return triangles;
}

/// The same of a node and those below it, which may show one mesh many times.
size_t triangles_below(const aiNode& node, const std::vector<size_t>& triangles) {
  size_t sum = 0;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) sum += triangles[node.mMeshes[i]];
  for (unsigned i = 0; i < node.mNumChildren; ++i)
    sum += triangles_below(*node.mChildren[i], triangles);
  return sum;
}

/// How often Assimp will compare corners with each other to give them normals: each with all that
/// lie where it lies, up to a share of the mesh's size.
double comparisons(const aiMesh& part) {
  if (part.mNormals) return 0;
  const auto finite = [](const aiVector3D& p) { return std::isfinite(p.x + p.y + p.z); };
  // Corners of no face may be anything.
  std::vector<aiVector3D> places;
  std::copy_if(part.mVertices, part.mVertices + part.mNumVertices, std::back_inserter(places),
               finite);
  if (places.empty()) return 0;
  aiVector3D low = places[0], high = low;
  for (const aiVector3D& p : places)
    for (unsigned axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  constexpr float kSamePlace = 1e-4F;  // of the diagonal, ComputePositionEpsilon
  const float cell = kSamePlace * (high - low).Length();
  const auto all = static_cast<double>(places.size());
  if (!(cell > 0 && std::isfinite(cell))) return all * all;
  std::unordered_map<uint64_t, double> corners;
  for (const aiVector3D& p : places) {
    uint64_t place = 0;
    for (unsigned axis = 0; axis < 3; ++axis)
      place = place << 21 | static_cast<uint64_t>((p[axis] - low[axis]) / cell);
    ++corners[place];
  }
  double sum = 0;
  for (const auto& [place, count] : corners) sum += count * count;
  return sum;
}

/// Throws if normals would take minutes.
void check_corners(const aiScene& scene, const std::string& path) {
  constexpr double kMaxSum = 1e9;  // some seconds
  double sum = 0;
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) sum += comparisons(*scene.mMeshes[i]);
  if (sum > kMaxSum)
    fail(path,
         "has no normals, and too many faces meet in one place to find them: store it with "
         "normals, or join its corners, with Blender's Merge by Distance for example");
}

void append(Mesh& mesh, const aiMesh& part) {
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D& p = part.mVertices[i];
    mesh.positions.push_back({p.x, p.y, p.z});
    const aiVector3D n = part.mNormals ? part.mNormals[i] : aiVector3D(0, 0, 0);
    mesh.normals.push_back({n.x, n.y, n.z});
  }
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices == 3)
      for (unsigned corner = 0; corner < 3; ++corner)
        mesh.indices.push_back(first + face.mIndices[corner]);
  }
}

/// By which powers of two the coordinates of each mesh become as large as their products allow:
/// Assimp drops triangles and joins corners by tolerances in whatever unit a file has.
std::vector<int> enlargements(const aiScene& scene) {
  constexpr int kLarge = 30;  // products of four coordinates are finite
  std::vector<int> exponents;
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
    const aiMesh& part = *scene.mMeshes[i];
    float largest = 0;
    for (unsigned j = 0; j < part.mNumVertices; ++j)
      for (unsigned axis = 0; axis < 3; ++axis)
        largest = std::max(largest, std::abs(part.mVertices[j][axis]));
    exponents.push_back(largest > 0 ? kLarge - std::ilogb(largest) : 0);
  }
  return exponents;
}

/// Exact, but for what is too small for a float.
void scale(const aiScene& scene, const std::vector<int>& exponents, int sign) {
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
    const aiMesh& part = *scene.mMeshes[i];
    for (unsigned j = 0; j < part.mNumVertices; ++j)
      for (unsigned axis = 0; axis < 3; ++axis)
        part.mVertices[j][axis] = std::ldexp(part.mVertices[j][axis], sign * exponents[i]);
  }
}

Mesh read(const std::string& path, std::string content, std::string& warning) {
  Assimp::Importer importer;
  keep_our_formats(importer);
  importer.SetIOHandler(mesh_system(path, std::move(content)).release());  // now its own
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
                              aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
                                  aiComponent_TEXCOORDS | aiComponent_BONEWEIGHTS |
                                  aiComponent_ANIMATIONS | aiComponent_TEXTURES |
                                  aiComponent_LIGHTS | aiComponent_CAMERAS);
  importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, kCrease);
  if (!importer.ReadFile(path, 0))
    fail(path, std::string("cannot be read: ") + importer.GetErrorString());
  // Ours to change: nobody else has it.
  const FaceCount faces = sanitize(const_cast<aiScene&>(*importer.GetScene()));
  if (faces.dropped)
    warning = "mesh " + path + ": " + std::to_string(faces.dropped) + " of " +
              std::to_string(faces.areas) +
              " faces were dropped: corners missing or not finite; export again";
  if (importer.GetScene()->mNumMeshes == 0)
    fail(path, "has no triangle with an area; nothing can be drawn");
  // Before work is put into it.
  const std::vector<size_t> of_each = triangles_of(*importer.GetScene(), path);
  const aiNode* root = importer.GetScene()->mRootNode;
  const size_t triangles = root ? triangles_below(*root, of_each) : 0;
  if (triangles > Mesh::kMaxTriangles)
    fail(path, "has " + std::to_string(triangles) + " triangles; at most " +
                   std::to_string(Mesh::kMaxTriangles) +
                   " can be drawn: simplify it, with Blender's Decimate for example");
  const std::vector<int> each = enlargements(*importer.GetScene());
  scale(*importer.GetScene(), each, 1);
  const aiScene* scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  if (scene) {
    scale(*scene, each, -1);
    scene =
        importer.ApplyPostProcessing(aiProcess_RemoveComponent | aiProcess_PreTransformVertices);
  }
  if (scene) {
    // All by the same, and for good: Mesh::prepare makes the mesh as large as all others are.
    const std::vector<int> sizes = enlargements(*scene);
    if (!sizes.empty())
      scale(*scene, std::vector<int>(sizes.size(), *std::ranges::min_element(sizes)), 1);
    check_corners(*scene, path);
    scene =
        importer.ApplyPostProcessing(aiProcess_GenSmoothNormals | aiProcess_JoinIdenticalVertices);
  }
  if (!scene) fail(path, std::string("cannot be read: ") + importer.GetErrorString());
  Mesh mesh;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) append(mesh, *scene->mMeshes[i]);
  return mesh;
}

}  // namespace

Mesh parse_mesh(const std::string& path, std::string& warning) {
  warning.clear();
  std::string content = checked(path);
  Mesh mesh;
  try {
    mesh = read(path, std::move(content), warning);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    fail(path, std::string("cannot be read: ") + error.what());
  }
  mesh.prepare(path.c_str());
  return mesh;
}

}  // namespace inverse

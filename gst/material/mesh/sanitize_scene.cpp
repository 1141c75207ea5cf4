// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sanitize_scene.hpp"

#include <assimp/scene.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace inverse {
namespace {

/// Leaves the vertices that faces have; of channels that are removed anyway, anything. Assimp's
/// later steps copy all that there are wherever a mesh is shown, and its reader of glTF makes all
/// of an accessor part of each mesh that has some of it.
void compact(aiMesh& part) {
  if (!part.mVertices) return;  // and so no faces
  constexpr unsigned kUnused = std::numeric_limits<unsigned>::max();
  std::vector<unsigned> place(part.mNumVertices, kUnused);
  std::vector<aiVector3D> positions, normals;
  for (unsigned i = 0; i < part.mNumFaces; ++i)
    for (unsigned corner = 0; corner < part.mFaces[i].mNumIndices; ++corner) {
      unsigned& index = part.mFaces[i].mIndices[corner];
      unsigned& now = place[index];
      if (now == kUnused) {
        now = static_cast<unsigned>(positions.size());
        positions.push_back(part.mVertices[index]);
        if (part.mNormals) normals.push_back(part.mNormals[index]);
      }
      index = now;
    }
  std::copy(positions.begin(), positions.end(), part.mVertices);
  std::copy(normals.begin(), normals.end(), part.mNormals);
  part.mNumVertices = static_cast<unsigned>(positions.size());
}

/// Leaves the faces that are areas of corners that exist.
FaceCount sanitize(aiMesh& part) {
  FaceCount faces;
  unsigned kept = 0;
  part.mPrimitiveTypes = 0;
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    aiFace& face = part.mFaces[i];
    if (face.mNumIndices < 3) continue;
    ++faces.areas;
    const bool good =
        part.mVertices &&
        std::all_of(face.mIndices, face.mIndices + face.mNumIndices, [&](unsigned corner) {
          if (corner >= part.mNumVertices) return false;
          const aiVector3D& p = part.mVertices[corner];
          return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
        });
    if (!good) {
      ++faces.dropped;
      continue;
    }
    part.mPrimitiveTypes |=
        face.mNumIndices == 3 ? aiPrimitiveType_TRIANGLE : aiPrimitiveType_POLYGON;
    aiFace& place = part.mFaces[kept++];
    std::swap(place.mIndices, face.mIndices);
    std::swap(place.mNumIndices, face.mNumIndices);
  }
  part.mNumFaces = kept;
  compact(part);
  return faces;
}

/// Takes meshes that are gone (`place` has −1 for them) out of a node and those below it.
void renumber(aiNode& node, const std::vector<int>& place) {
  unsigned kept = 0;
  for (unsigned i = 0; i < node.mNumMeshes; ++i)
    if (node.mMeshes[i] < place.size() && place[node.mMeshes[i]] >= 0)
      node.mMeshes[kept++] = static_cast<unsigned>(place[node.mMeshes[i]]);
  node.mNumMeshes = kept;
  for (unsigned i = 0; i < node.mNumChildren; ++i) renumber(*node.mChildren[i], place);
}

}  // namespace

FaceCount sanitize(aiScene& scene) {
  FaceCount faces;
  std::vector<int> place(scene.mNumMeshes, -1);
  unsigned kept = 0;
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
    aiMesh* part = scene.mMeshes[i];
    scene.mMeshes[i] = nullptr;
    const FaceCount of_part = sanitize(*part);
    faces.areas += of_part.areas;
    faces.dropped += of_part.dropped;
    if (part->mNumFaces == 0) {
      delete part;
      continue;
    }
    place[i] = static_cast<int>(kept);
    scene.mMeshes[kept++] = part;
  }
  scene.mNumMeshes = kept;
  if (scene.mRootNode) renumber(*scene.mRootNode, place);
  return faces;
}

}  // namespace inverse

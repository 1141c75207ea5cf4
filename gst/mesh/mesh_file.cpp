#include "mesh_file.hpp"

#include <assimp/BaseImporter.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <set>
#include <string_view>

#include "error.hpp"

namespace inverse {
namespace {

constexpr uintmax_t kMaxBytes = uintmax_t{1} << 30;
constexpr float kCrease = 66;  // degrees
constexpr std::array<std::string_view, 4> kExtensions{"obj", "ply", "gltf", "glb"};

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw Error(ErrorKind::file, "mesh " + path + " " + what);
}

void check_file(const std::string& path) {
  std::error_code status;
  if (!std::filesystem::is_regular_file(path, status))
    fail(path, status ? "cannot be read: " + status.message() : "is no file");
  std::string extension = std::filesystem::path(path).extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (std::find(kExtensions.begin(), kExtensions.end(), extension) == kExtensions.end())
    fail(path, "is not named as an OBJ, PLY or glTF file (.obj, .ply, .gltf, .glb)");
  if (std::filesystem::file_size(path, status) > kMaxBytes)
    fail(path, "is larger than 1 GiB; simplify it, with Blender's Decimate for example");
  if (!std::ifstream(path)) fail(path, "cannot be read: permission denied");
}

/// Of the many formats that Assimp knows, only ours: fewer surprises.
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

Mesh read(const std::string& path) {
  Assimp::Importer importer;
  keep_our_formats(importer);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                              aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
                              aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
                                  aiComponent_TEXCOORDS | aiComponent_BONEWEIGHTS |
                                  aiComponent_ANIMATIONS | aiComponent_TEXTURES |
                                  aiComponent_LIGHTS | aiComponent_CAMERAS);
  importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, kCrease);
  if (!importer.ReadFile(path, 0))
    fail(path, std::string("cannot be read: ") + importer.GetErrorString());
  // Before work is put into it.
  size_t faces = 0;
  for (unsigned i = 0; i < importer.GetScene()->mNumMeshes; ++i)
    faces += importer.GetScene()->mMeshes[i]->mNumFaces;
  if (faces > Mesh::kMaxTriangles)
    fail(path, "has " + std::to_string(faces) + " faces; at most " +
                   std::to_string(Mesh::kMaxTriangles) +
                   " triangles can be drawn: simplify it, with Blender's Decimate for example");
  const aiScene* scene = importer.ApplyPostProcessing(
      aiProcess_RemoveComponent | aiProcess_Triangulate | aiProcess_PreTransformVertices |
      aiProcess_GenSmoothNormals | aiProcess_FindInvalidData | aiProcess_SortByPType |
      aiProcess_JoinIdenticalVertices);
  if (!scene) fail(path, std::string("cannot be read: ") + importer.GetErrorString());
  Mesh mesh;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) append(mesh, *scene->mMeshes[i]);
  return mesh;
}

}  // namespace

Mesh load_mesh(const std::string& path) {
  check_file(path);
  Mesh mesh;
  try {
    mesh = read(path);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    fail(path, std::string("cannot be read: ") + error.what());
  }
  mesh.prepare(path.c_str());
  return mesh;
}

}  // namespace inverse

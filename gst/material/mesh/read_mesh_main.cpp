// SPDX-License-Identifier: LGPL-2.1-or-later
// inverse-read-mesh FILE: reads a mesh for the plugin that started it (mesh_process.hpp).
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>

#include "mesh_file.hpp"
#include "mesh_stream.hpp"

namespace {

using inverse::Mesh;
using inverse::MeshHeader;

void limit(__rlimit_resource_t resource, rlim_t most) {
  rlimit limits{};
  if (getrlimit(resource, &limits) != 0) return;
  limits.rlim_cur = std::min(limits.rlim_max, most);
  setrlimit(resource, &limits);
}

void write(const void* data, size_t bytes) {
  if (std::fwrite(data, 1, bytes, stdout) != bytes) std::_Exit(2);  // nobody reads
}

int send(const Mesh& mesh, std::string warning, std::string error) {
  warning.resize(std::min<size_t>(warning.size(), MeshHeader::kMaxText));
  error.resize(std::min<size_t>(error.size(), MeshHeader::kMaxText));
  const MeshHeader header{.error = static_cast<uint32_t>(error.size()),
                          .warning = static_cast<uint32_t>(warning.size()),
                          .vertices = static_cast<uint32_t>(mesh.positions.size()),
                          .indices = static_cast<uint32_t>(mesh.indices.size())};
  write(&header, sizeof header);
  write(error.data(), error.size());
  write(warning.data(), warning.size());
  write(mesh.positions.data(), mesh.positions.size() * sizeof(Mesh::Vec3));
  write(mesh.normals.data(), mesh.normals.size() * sizeof(Mesh::Vec3));
  write(mesh.indices.data(), mesh.indices.size() * sizeof(uint32_t));
  return std::fflush(stdout) == 0 ? 0 : 2;
}

}  // namespace

int main(int count, char** words) {
  if (count != 2) {
    std::fprintf(stderr, "inverse-read-mesh FILE: for materialclone, which draws the mesh\n");
    return 2;
  }
  limit(RLIMIT_CPU, 60);
  limit(RLIMIT_CORE, 0);
  if (LIMITS_MEMORY) limit(RLIMIT_AS, rlim_t{4} << 30);
  std::string warning;
  try {
    const Mesh mesh = inverse::parse_mesh(words[1], warning);
    return send(mesh, warning, {});
  } catch (const std::bad_alloc&) {
    return send({}, {}, std::string("mesh ") + words[1] + " needs more than 4 GiB to be read");
  } catch (const std::exception& error) {
    return send({}, {}, error.what());
  }
}

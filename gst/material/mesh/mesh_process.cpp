// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mesh_process.hpp"

#include <dlfcn.h>
#include <gio/gio.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <memory>

#include "common/error.hpp"
#include "mesh_stream.hpp"

namespace inverse {
namespace {

struct Unref {
  void operator()(gpointer object) const { g_object_unref(object); }
};

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw Error(ErrorKind::file, "mesh " + path + " cannot be read: " + what);
}

/// Whether as many bytes came.
bool read(GInputStream* from, void* to, size_t bytes) {
  gsize got = 0;
  return bytes == 0 ||
         (g_input_stream_read_all(from, to, bytes, &got, nullptr, nullptr) && got == bytes);
}

std::string read_text(GInputStream* from, uint32_t bytes, bool& whole) {
  std::string text(bytes, ' ');
  whole = whole && read(from, text.data(), bytes);
  return text;
}

/// Reads what the header counts; whether it is whole and can be.
bool receive(GInputStream* from, Mesh& mesh, std::string& warning, std::string& error) {
  MeshHeader header;
  if (!read(from, &header, sizeof header) || header.magic != MeshHeader::kMagic ||
      std::max(header.error, header.warning) > MeshHeader::kMaxText ||
      std::max(header.vertices, header.indices) > 3 * Mesh::kMaxTriangles)
    return false;
  bool whole = true;
  error = read_text(from, header.error, whole);
  warning = read_text(from, header.warning, whole);
  mesh.positions.resize(header.vertices);
  mesh.normals.resize(header.vertices);
  mesh.indices.resize(header.indices);
  whole = whole && read(from, mesh.positions.data(), header.vertices * sizeof(Mesh::Vec3)) &&
          read(from, mesh.normals.data(), header.vertices * sizeof(Mesh::Vec3)) &&
          read(from, mesh.indices.data(), header.indices * sizeof(uint32_t));
  return whole &&
         std::ranges::all_of(mesh.indices, [&](uint32_t index) { return index < header.vertices; });
}

}  // namespace

std::string mesh_reader() {
  Dl_info own{};
  if (!dladdr(reinterpret_cast<void*>(&mesh_reader), &own) || !own.dli_fname) return {};
  return std::filesystem::path(own.dli_fname).replace_filename("inverse-read-mesh");
}

Mesh load_mesh(const std::string& path, std::string& warning, const std::string& reader) {
  warning.clear();
  GError* fault = nullptr;
  const std::unique_ptr<GSubprocess, Unref> process(g_subprocess_new(
      G_SUBPROCESS_FLAGS_STDOUT_PIPE, &fault, reader.c_str(), path.c_str(), nullptr));
  if (!process) {
    const std::string why = fault->message;
    g_error_free(fault);
    fail(path, why + "; install gst-inverse anew");
  }
  Mesh mesh;
  std::string error;
  const bool whole = receive(g_subprocess_get_stdout_pipe(process.get()), mesh, warning, error);
  if (!whole) g_subprocess_force_exit(process.get());
  g_subprocess_wait(process.get(), nullptr, nullptr);
  if (!error.empty() && whole) throw Error(ErrorKind::file, error);
  if (whole && g_subprocess_get_successful(process.get())) return mesh;
  warning.clear();
  if (g_subprocess_get_if_signaled(process.get()) &&
      g_subprocess_get_term_sig(process.get()) == SIGXCPU)
    fail(path, "it takes more than a minute; simplify it, with Blender's Decimate for example");
  fail(path,
       "its reader failed, as the file is damaged; export it again, with Blender for example");
}

}  // namespace inverse

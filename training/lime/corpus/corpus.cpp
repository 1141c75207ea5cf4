// SPDX-License-Identifier: LGPL-2.1-or-later
// The corpus as a C library, for Python's ctypes (lime/corpus.py).
#include <atomic>
#include <exception>
#include <string>
#include <thread>
#include <vector>

#include "blinn_phong.hpp"
#include "sample.hpp"
#include "shapes.hpp"

using namespace inverse::lime;

struct LimeCorpus {
  std::vector<NamedMap> maps;
};

namespace {
thread_local std::string last_error;
thread_local std::string names;
}  // namespace

extern "C" {

/// Why lime_open returned null.
const char* lime_error() { return last_error.c_str(); }

/// `folder` of Radiance maps; empty: rooms only. Null on failure.
LimeCorpus* lime_open(const char* folder) try {
  auto* corpus = new LimeCorpus;
  if (*folder) corpus->maps = load_maps(folder);
  return corpus;
} catch (const std::exception& error) {
  last_error = error.what();
  return nullptr;
}

void lime_close(LimeCorpus* corpus) { delete corpus; }

/// Names of the maps of a split, one a line.
const char* lime_maps(const LimeCorpus* corpus, int held_out) {
  names.clear();
  for (const NamedMap& map : corpus->maps)
    if (map.held_out == (held_out != 0)) names += map.name + "\n";
  return names.c_str();
}

int lime_is_held_out_shape(int family, float trait) { return is_held_out(Family(family), trait); }

/// Floats of a sample's parameters.
int lime_parameters() { return kParameters; }

/// Samples first … first + count − 1, on `threads` threads. Flags: 1 test split, 2 clean, 4 whole
/// frame, 8 may be painted, 16 everyday. Images are as in sample.hpp, one sample after another.
void lime_render(const LimeCorpus* corpus, std::uint64_t seed, std::uint64_t first, int count,
                 int size, int flags, int threads, std::uint8_t* image, std::uint8_t* coverage,
                 float* diffuse, float* specular, float* mirror, float* parameters) {
  std::atomic<int> next{0};
  const auto work = [&] {
    for (int i = next++; i < count; i = next++) {
      Request request{seed,
                      first + std::uint64_t(i),
                      flags & 1 ? Split::test : Split::train,
                      size,
                      (flags & 2) != 0,
                      (flags & 4) != 0,
                      (flags & 8) != 0,
                      (flags & 16) != 0};
      const auto plane = std::size_t(size) * std::size_t(size), n = std::size_t(i);
      Parameters p;
      render(request, corpus->maps,
             {image + 3 * plane * n, coverage + plane * n, diffuse + 3 * plane * n,
              specular + 3 * plane * n, mirror + 3 * plane * n},
             p);
      const auto* values = reinterpret_cast<const float*>(&p);
      std::copy(values, values + kParameters, parameters + std::size_t(kParameters) * n);
    }
  };
  std::vector<std::thread> pool;
  for (int i = 1; i < threads; ++i) pool.emplace_back(work);
  work();
  for (std::thread& thread : pool) thread.join();
}

/// D and S (Eq. 6.3, RGB) for `count` normals and views under a map of rows × 2 rows texels; `all`:
/// no tile is left out.
void lime_shade(const float* map, int rows, int count, const float* normals, const float* views,
                float shininess, int all, float* diffuse, float* specular) {
  Environment environment{rows, std::vector<Vec>(std::size_t(2 * rows * rows))};
  for (std::size_t i = 0; i < environment.radiance.size(); ++i)
    environment.radiance[i] = {map[3 * i], map[3 * i + 1], map[3 * i + 2]};
  const Lights lights(environment);
  for (int i = 0; i < count; ++i) {
    const Vec n{normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]};
    const Vec o{views[3 * i], views[3 * i + 1], views[3 * i + 2]};
    const Vec d = lights.diffuse(n), s = lights.specular(n, o, shininess, all != 0);
    diffuse[3 * i] = d.x, diffuse[3 * i + 1] = d.y, diffuse[3 * i + 2] = d.z;
    specular[3 * i] = s.x, specular[3 * i + 1] = s.y, specular[3 * i + 2] = s.z;
  }
}

}  // extern "C"

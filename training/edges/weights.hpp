// SPDX-License-Identifier: LGPL-2.1-or-later
// Files of fitted weights: hidden values of the edges' net and of the cells', how many numbers
// follow, the numbers.
#pragma once

#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace inverse::training {

/// Both nets (net.hpp), the edges' first, in one vector.
struct Weights {
  int edge_hidden = 0, cell_hidden = 0;
  std::vector<float> values;
};

inline void save_weights(const Weights& w, const std::string& path) {
  const std::unique_ptr<FILE, int (*)(FILE*)> f(std::fopen(path.c_str(), "w"), std::fclose);
  if (!f) throw std::runtime_error("cannot write " + path);
  std::fprintf(f.get(), "%d %d %zu\n", w.edge_hidden, w.cell_hidden, w.values.size());
  for (float v : w.values) std::fprintf(f.get(), "%.6g\n", double(v));
}

/// Throws std::runtime_error where the file holds no weights or not all of them.
inline Weights load_weights(const std::string& path) {
  const std::unique_ptr<FILE, int (*)(FILE*)> f(std::fopen(path.c_str(), "r"), std::fclose);
  Weights w;
  std::size_t n = 0;
  if (!f || std::fscanf(f.get(), "%d %d %zu", &w.edge_hidden, &w.cell_hidden, &n) != 3 ||
      w.edge_hidden < 1 || w.cell_hidden < 1 || n > 1000000)
    throw std::runtime_error(path + " holds no weights");
  w.values.resize(n);
  for (float& v : w.values)
    if (std::fscanf(f.get(), "%f", &v) != 1) throw std::runtime_error(path + " is cut short");
  return w;
}

}  // namespace inverse::training

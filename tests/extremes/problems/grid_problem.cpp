// SPDX-License-Identifier: LGPL-2.1-or-later
#include "grid_problem.hpp"

#include <algorithm>

#include "kernels/image/pyramid.hpp"
#include "kernels/intrinsic/chroma/chroma_bins.hpp"
#include "kernels/intrinsic/multigrid/multigrid.hpp"
#include "tests/reference/intrinsic/intrinsic_decomposition.hpp"

namespace inverse::extremes {
namespace {

/// Weight of pixel `at` of `count` in the mean of its cell of four along one axis: nested means of
/// two, the last pixel of an odd border twice.
double share(uint32_t at, uint32_t count) {
  const uint32_t size = std::min(count - at / 4 * 4, 4U);
  constexpr double kShares[4][4] = {
      {1, 0, 0, 0}, {0.5, 0.5, 0, 0}, {0.25, 0.25, 0.5, 0}, {0.25, 0.25, 0.25, 0.25}};
  return kShares[size - 1][at % 4];
}

}  // namespace

GridSystem::GridSystem(Extent size) : extent(size), cells(half_of(half_of(size))) {
  for (auto* plane : {&right, &down, &f}) plane->assign(extent.pixels(), 0.0F);
  for (auto* plane : {&screen, &pull, &anchor}) plane->assign(cells.pixels(), 0.0F);
}

Eigen::MatrixXd matrix_of(const GridSystem& system) {
  const auto [width, height] = system.extent;
  const auto pixels = static_cast<Eigen::Index>(system.extent.pixels());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(pixels, pixels);
  const auto edge = [&](size_t a, size_t b, double weight) {
    matrix(a, a) += weight;
    matrix(b, b) += weight;
    matrix(a, b) -= weight;
    matrix(b, a) -= weight;
  };
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      const size_t n = system.at(x, y), cell = system.cell(x, y);
      matrix(n, n) +=
          static_cast<double>(system.anchor[cell]) + static_cast<double>(reference::kMinDiagonal);
      if (x + 1 < width) edge(n, n + 1, static_cast<double>(system.right[n]));
      if (y + 1 < height) edge(n, n + width, static_cast<double>(system.down[n]));
      for (uint32_t v = y / 4 * 4; v < std::min(height, y / 4 * 4 + 4); ++v)
        for (uint32_t u = x / 4 * 4; u < std::min(width, x / 4 * 4 + 4); ++u)
          matrix(n, system.at(u, v)) += static_cast<double>(system.screen[cell]) * share(x, width) *
                                        share(y, height) * share(u, width) * share(v, height);
    }
  return matrix;
}

std::vector<double> right_hand_side(const GridSystem& system) {
  const auto [width, height] = system.extent;
  std::vector<double> b;
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x)
      b.push_back(static_cast<double>(system.f[system.at(x, y)]) +
                  static_cast<double>(system.pull[system.cell(x, y)]) * share(x, width) *
                      share(y, height));
  return b;
}

std::vector<std::vector<double>> cycles_on_device(const Lab& lab, const GridSystem& system,
                                                  uint32_t cycles, bool last) {
  const Extent extent = system.extent, cells = system.cells;
  Multigrid multigrid(lab.device(), extent);
  Guide guide(lab.device(), extent);
  ChromaBins bins(lab.device(), cells);
  const uint32_t packs = pack4_count(extent.width), cell_packs = pack4_count(cells.width);
  Pixels pixels(pack4_count(extent) * 12, 0.0F), terms(pack4_count(cells) * 16, 0.0F);
  Pixels source(pack4_count(cells) * 12, 0.0F);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      float* pack = &pixels[12 * (static_cast<size_t>(y) * packs + x / 4) + x % 4];
      const size_t n = system.at(x, y);
      pack[0] = x + 1 < extent.width ? system.right[n] : 0;
      pack[4] = y + 1 < extent.height ? system.down[n] : 0;
      pack[8] = system.f[n];
    }
  for (uint32_t y = 0; y < cells.height; ++y)
    for (uint32_t x = 0; x < cells.width; ++x) {
      const size_t n = static_cast<size_t>(y) * cells.width + x;
      const size_t pack = static_cast<size_t>(y) * cell_packs + x / 4;
      terms[16 * pack + x % 4] = source[12 * pack + 4 + x % 4] = system.screen[n];
      terms[16 * pack + 4 + x % 4] = system.pull[n];  // no chroma term: the bins have no say
      source[12 * pack + 8 + x % 4] = system.anchor[n];
    }
  const auto frame = lab.upload(Pixels(4 * extent.pixels(), 0.5F));
  const auto system_buffer = lab.upload(pixels), terms_buffer = lab.upload(terms),
             source_buffer = lab.upload(source);
  const Multigrid::Params params;
  const ChromaBins::State state{terms_buffer,
                                multigrid.cell_means(),
                                multigrid.cell_correction(),
                                multigrid.cell_residual(),
                                multigrid.cell_system(),
                                multigrid.cell_source_term()};
  lab.run([&](gpu::Commands& commands) {
    guide.record(commands, frame, nullptr);
    commands.fill(multigrid.field());
    commands.copy(system_buffer, multigrid.system(), system_buffer->bytes());
    commands.copy(source_buffer, multigrid.cell_source_term(), source_buffer->bytes());
    multigrid.record_operators(commands, params);
    bins.record_weights(commands, guide, terms_buffer, 1);
  });
  std::vector<std::vector<double>> solutions;
  for (uint32_t k = 0; k < cycles; ++k) {
    lab.run([&](gpu::Commands& commands) {
      multigrid.record_cycle(
          commands, params, k, {}, [&] { bins.record(commands, guide, state); },
          [&] { bins.record_source_term(commands, state); });
    });
    if (last && k + 1 < cycles) continue;
    const Pixels got = lab.download(multigrid.field());
    std::vector<double>& solution = solutions.emplace_back();
    for (uint32_t y = 0; y < extent.height; ++y)
      for (uint32_t x = 0; x < extent.width; ++x)
        solution.push_back(
            static_cast<double>(got[4 * (static_cast<size_t>(y) * packs + x / 4) + x % 4]));
  }
  return solutions;
}

}  // namespace inverse::extremes

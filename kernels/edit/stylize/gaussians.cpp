// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gaussians.hpp"

#include <cmath>

namespace inverse {
namespace {

constexpr float kMinCellSigma = 1.5F;  // of a cell that is more than a pixel
constexpr float kReach = 3;            // radius of a kernel, in sigma

/// Weights of the distances 0, 1 … of a Gaussian. Both sides add up to 1.
std::vector<double> gaussian(double sigma, int radius) {
  std::vector<double> weights(static_cast<size_t>(radius) + 1);
  double sum = 0;
  for (size_t k = 0; k < weights.size(); ++k) {
    const double distance = static_cast<double>(k) / sigma;
    weights[k] = std::exp(-.5 * distance * distance);
    sum += k == 0 ? weights[k] : 2 * weights[k];
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

}  // namespace

Gaussians::Grid Gaussians::grid_of(float sigma) {
  Grid grid{.factor = 1, .cell_sigma = sigma, .wide_cell_sigma = kRatio * sigma, .radius = 0};
  while (sigma / static_cast<float>(2 * grid.factor) >= kMinCellSigma) grid.factor *= 2;
  if (grid.factor > 1) {
    const float f = static_cast<float>(grid.factor);
    // Of a box of f pixels, and of linear interpolation, on average over the places between cells.
    const float other = (f * f - 1) / (12 * f * f) + 1.F / 6;
    const auto in_cells = [&](float s) { return std::sqrt(s * s / (f * f) - other); };
    grid.cell_sigma = in_cells(sigma);
    grid.wide_cell_sigma = in_cells(kRatio * sigma);
  }
  grid.radius = static_cast<int>(std::ceil(kReach * grid.wide_cell_sigma));
  return grid;
}

Gaussians::Gaussians(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device),
      extent_(extent),
      reduce_(device),
      along_rows_(device, {.down = false}),
      along_columns_(device, {.down = true}) {}

void Gaussians::resize(uint32_t factor) {
  if (factor == factor_) return;
  const Extent cells{(extent_.width - 1) / factor + 1, (extent_.height - 1) / factor + 1};
  for (gpu::BufferPtr* buffer : {&near_, &wide_, &near_half_, &wide_half_})
    *buffer = gpu::Buffer::create_by_rows(device_, gpu::Element::scalar, cells.pixels());
  factor_ = factor;
  cells_ = cells;
}

void Gaussians::record(gpu::Commands& commands, const Plane& intrinsic, float sigma) {
  const Grid grid = grid_of(sigma);
  resize(grid.factor);
  const auto near = gaussian(double{grid.cell_sigma}, grid.radius);
  const auto wide = gaussian(double{grid.wide_cell_sigma}, grid.radius);
  std::vector<std::array<float, 4>> weights(near.size());
  for (size_t k = 0; k < weights.size(); ++k)
    weights[k] = {static_cast<float>(near[k]), static_cast<float>(wide[k]), 0, 0};
  commands.write_table(weights_, gpu::Element::vec4, weights);
  const gpu::Rows rows{cells_.width, cells_.height, 1};
  commands.dispatch_rows(reduce_, {.intrinsic = intrinsic.buffer, .cells = gpu::by_rows(near_)},
                         {.size = cells_, .frame = extent_, .factor = grid.factor, .first_row = 0},
                         rows);
  const shaders::edit_stylize_blur::Push push{
      .size = cells_, .radius = grid.radius, .first_row = 0};
  commands.dispatch_rows(along_rows_,
                         {.near = near_,
                          .wide = near_,
                          .weights = weights_,
                          .near_blurred = gpu::by_rows(near_half_),
                          .wide_blurred = gpu::by_rows(wide_half_)},
                         push, rows);
  commands.dispatch_rows(along_columns_,
                         {.near = near_half_,
                          .wide = wide_half_,
                          .weights = weights_,
                          .near_blurred = gpu::by_rows(near_),
                          .wide_blurred = gpu::by_rows(wide_)},
                         push, rows);
}

}  // namespace inverse

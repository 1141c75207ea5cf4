// SPDX-License-Identifier: LGPL-2.1-or-later
#include "thesis_problem.hpp"

#include <cmath>

#include "kernels/gpu/reduce.hpp"
#include "tests/thesis/reference/intrinsic_thesis.hpp"

namespace inverse::extremes {
namespace {

constexpr uint32_t kStrip = 8, kBlock = 16, kBlockGroup = 64;

Pixels pixels_of(const reference::Plane& plane) {
  Pixels pixels;
  for (const reference::Vec4& value : plane.data)
    for (const double channel : value) pixels.push_back(static_cast<float>(channel));
  return pixels;
}

}  // namespace

ThesisLab::ThesisLab(const Lab& lab, const reference::Plane& image,
                     const reference::ThesisParams& params)
    : lab_(lab),
      extent_{static_cast<uint32_t>(image.width), static_cast<uint32_t>(image.height)},
      params_(params) {
  const auto& device = lab.device();
  setup_ = {device};
  reweight_ = {device};
  direction_ = {device};
  update_ = {device};
  scalars_kernel_ = {device, {}, gpu::kOneGroup};
  schwarz_ = {device, {}, kBlockGroup};
  const uint64_t n = extent_.pixels();
  for (auto* buffer : {&links_, &edges_, &nodes_, &preconditioned_, &products_, &solution_, &spare_,
                       &directions_[0], &directions_[1]})
    *buffer = lab.buffer(n);
  image_ = lab.upload(pixels_of(image));
  sources_ = lab.upload(Pixels(4 * n, 0.0F));
  partials_ = lab.buffer(
      gpu::partial_count(*direction_.kernel(), {extent_.width, (extent_.height - 1) / kStrip + 1}));
  scalars_ =
      gpu::Buffer::create(device, gpu::Element::scalar, shaders::thesis_shared_scalars::CG_SIZE);
  lab.run([&](gpu::Commands& commands) {
    commands.fill(partials_);
    commands.fill(scalars_);
    commands.fill(solution_);
  });
}

ThesisLab::Push ThesisLab::push() const {
  auto push = zero_push<Push>();
  push.size = extent_;
  const auto set = [](auto& to, double from) { to = static_cast<float>(from); };
  set(push.w_data, params_.w_data), set(push.w_intensity, params_.w_intensity);
  set(push.w_reflectance, params_.w_reflectance), set(push.w_shading, params_.w_shading);
  set(push.w_chromaticity, params_.w_chromaticity);
  set(push.w_cs, params_.w_cs), set(push.alpha_cs, params_.alpha_cs);
  set(push.log_floor, params_.log_floor), set(push.chroma_floor, params_.chroma_floor);
  // A frozen system comes with its weights: p = 2 leaves them alone.
  const double p = frozen_ ? 2 : params_.p;
  set(push.p, p), set(push.epsilon2, frozen_ ? 1 : params_.epsilon * params_.epsilon);
  set(push.irls_factor, params_.consistent_irls ? p / 2 : 1);
  return push;
}

void ThesisLab::set_up() const {
  lab_.run([&](gpu::Commands& commands) {
    commands.dispatch(setup_, {.image = image_, .links = links_}, push(),
                      {extent_.width, extent_.height});
  });
}

void ThesisLab::set_edges(const reference::Plane& edges) {
  frozen_ = true;
  links_ = lab_.upload(pixels_of(edges));
}

void ThesisLab::set_sources(const reference::SourcePlane& sources) {
  sources_ = lab_.upload(pixels_of(sources));
}

void ThesisLab::set_solution(const reference::Plane& x) {
  const auto host = lab_.upload(pixels_of(x));
  lab_.run([&](gpu::Commands& commands) { commands.copy(host, solution_, host->bytes()); });
}

reference::Plane ThesisLab::solution() const {
  return to_reference(extent_, lab_.download(solution_));
}

void ThesisLab::conjugate_gradients(gpu::Commands& commands, int iterations) const {
  using Scalars = shaders::thesis_shared_scalars;
  const Push push = this->push();
  const gpu::Items strips{extent_.width, (extent_.height - 1) / kStrip + 1};
  const auto count = static_cast<int32_t>(gpu::partial_count(*direction_.kernel(), strips));
  const auto reduce = [&](int mode) {
    commands.dispatch(scalars_kernel_, {.partials = partials_, .scalars = scalars_},
                      {.count = count, .mode = mode, .first = 1, .tolerance = 0}, {gpu::kOneGroup});
  };
  reduce(Scalars::kSystem);
  for (int k = 0; k < iterations; ++k) {
    const auto& before = directions_[static_cast<size_t>(k + 1) % 2];
    const auto& direction = directions_[static_cast<size_t>(k) % 2];
    commands.dispatch(direction_,
                      {.preconditioned = preconditioned_,
                       .previous = before,
                       .edges = edges_,
                       .nodes = nodes_,
                       .scalars = scalars_,
                       .directions = direction,
                       .products = products_,
                       .partials = partials_,
                       .stroke_mask = links_,  // not read
                       .stroke_means = links_},
                      push, strips);
    reduce(Scalars::kAlpha);
    commands.dispatch(update_,
                      {.solution = gpu::aliased(solution_),
                       .preconditioned = gpu::aliased(preconditioned_),
                       .directions = direction,
                       .products = products_,
                       .nodes = nodes_,
                       .scalars = scalars_,
                       .solution_out = solution_,
                       .preconditioned_out = preconditioned_,
                       .partials = partials_},
                      push, strips);
    reduce(Scalars::kBeta);
  }
}

void ThesisLab::step(bool schwarz, int iterations, int step) {
  lab_.run([&](gpu::Commands& commands) {
    Push push = this->push();
    commands.dispatch(reweight_,
                      {.solution = solution_,
                       .links = links_,
                       .sources = sources_,
                       .image = image_,
                       .edges = edges_,
                       .nodes = nodes_,
                       .preconditioned = preconditioned_,
                       .partials = partials_,
                       .stroke_mask = links_,
                       .stroke_means = links_},
                      push, {extent_.width, (extent_.height - 1) / kStrip + 1});
    if (!schwarz) {
      conjugate_gradients(commands, iterations);
      return;
    }
    const auto shift = reference::schwarz_shift(step);
    push.count = iterations;
    push.shift = shift;
    const auto blocks = [](uint32_t size, int shifted) {
      return (size + static_cast<uint32_t>(shifted) - 1) / kBlock + 1;
    };
    commands.dispatch(
        schwarz_,
        {.solution = solution_,
         .preconditioned = preconditioned_,
         .edges = edges_,
         .nodes = nodes_,
         .result = spare_,
         .stroke_mask = links_,
         .stroke_means = links_},
        push, {blocks(extent_.width, shift[0]) * kBlockGroup, blocks(extent_.height, shift[1])});
    std::swap(solution_, spare_);
  });
}

reference::Plane in_single_precision(reference::Plane plane) {
  for (reference::Vec4& value : plane.data)
    for (double& channel : value) channel = static_cast<double>(static_cast<float>(channel));
  return plane;
}

Eigen::MatrixXd matrix_of(const reference::ThesisSystem& system) {
  const int width = system.node.width, height = system.node.height;
  const auto unknowns = static_cast<Eigen::Index>(4 * system.node.size());
  Eigen::MatrixXd matrix(unknowns, unknowns);
  reference::Plane unit(width, height), column(width, height);
  for (size_t n = 0; n < unit.size(); ++n)
    for (size_t c = 0; c < 4; ++c) {
      unit.data[n][c] = 1;
      reference::apply(system, unit, 0, 0, width, height, &column);
      unit.data[n][c] = 0;
      for (size_t m = 0; m < column.size(); ++m)
        for (size_t k = 0; k < 4; ++k) matrix(4 * m + k, 4 * n + c) = column.data[m][k];
    }
  return matrix;
}

}  // namespace inverse::extremes

// SPDX-License-Identifier: LGPL-2.1-or-later
#include "global_thesis_problem.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "kernels/gpu/reduce.hpp"
#include "kernels/image/layers.hpp"
#include "kernels/thesis_chapter5_solve_mix.spv.hpp"
#include "kernels/thesis_chapter5_solve_product.spv.hpp"
#include "kernels/thesis_chapter5_solve_reweight.spv.hpp"
#include "kernels/thesis_chapter5_solve_update.spv.hpp"
#include "kernels/thesis_shared_scalars.spv.hpp"
#include "tests/thesis/reference/global_thesis_energy.hpp"
#include "thesis_problem.hpp"

namespace inverse::extremes {
namespace {

using reference::GlobalField;
using reference::GlobalThesisScene;
using Params = reference::GlobalThesisParams;

constexpr int kWidth = 7, kHeight = 5;  // 280 unknowns
constexpr int32_t kGroups = 1;          // planes of four layers
constexpr size_t kLayers = 4 * kGroups;
constexpr int kRuns = 4, kIterations = 280;
constexpr uint32_t kStrip = 8;

/// A step from x.
struct Step {
  GlobalThesisScene scene;
  GlobalField x;
  Params params;
};

double single(double value) { return static_cast<double>(static_cast<float>(value)); }

using Push = shaders::thesis_chapter5_solve_reweight::Push;
using Scalars = shaders::thesis_shared_scalars;

Push push_of(const Step& step) {
  const Params& p = step.params;
  auto push = zero_push<Push>();
  push.size = {kWidth, kHeight};
  push.layers = kLayers;
  const auto set = [](auto& to, double from) { to = static_cast<float>(from); };
  set(push.lambda_data, p.lambda_data), set(push.lambda_clustering, p.lambda_clustering);
  set(push.lambda_r_sparsity, p.lambda_r_sparsity);
  set(push.lambda_monochrome, p.lambda_monochrome);
  set(push.lambda_i_sparsity, p.lambda_i_sparsity);
  set(push.lambda_smoothness, p.lambda_smoothness);
  set(push.lambda_non_negativity, p.lambda_non_negativity);
  set(push.p, p.p), set(push.irls_r, p.p / 2), set(push.irls_light, 0.5);
  set(push.epsilon, p.epsilon), set(push.epsilon_r, p.epsilon_r);
  return push;
}

/// The numbers of a field as the kernels keep them: planes of (r, T_0) and of four layers.
Pixels planes_of(const GlobalField& x) {
  Pixels pixels;
  for (size_t plane = 0; plane <= kGroups; ++plane)
    for (size_t n = 0; n < x.pixels(); ++n)
      for (size_t k = 0; k < 4; ++k) pixels.push_back(static_cast<float>(x.at(n)[4 * plane + k]));
  return pixels;
}

/// The change that conjugate gradients find, in the order of the matrix.
std::vector<double> solve_on_device(const Lab& lab, const Step& step) {
  const auto& device = lab.device();
  const uint64_t n = uint64_t{kWidth} * kHeight, field = (kGroups + 1) * n;
  const bool unit = step.params.p == 1;
  const gpu::Program<shaders::thesis_chapter5_solve_reweight> reweight(
      device, {.groups = kGroups, .unit_exponent = unit});
  const gpu::Program<shaders::thesis_chapter5_solve_mix> mix(
      device, {.groups = kGroups, .unit_exponent = unit});
  const gpu::Program<shaders::thesis_chapter5_solve_product> product(
      device, {.groups = kGroups, .unit_exponent = unit});
  const gpu::Program<shaders::thesis_chapter5_solve_update> update(
      device, {.groups = kGroups, .unit_exponent = unit});
  const gpu::Program<Scalars> scalars(device, {}, gpu::kOneGroup);
  Pixels image, sources, features, table(4 * 3 * kMaxBases, 0.0F);
  for (size_t i = 0; i < n; ++i) {
    const reference::Vec4& target = step.scene.targets.data[i];
    const double weight = step.params.lambda_clustering * target[3];
    for (size_t c = 0; c < 3; ++c) {
      image.push_back(static_cast<float>(step.scene.image.data[i][c]));
      sources.push_back(static_cast<float>(weight * target[c]));
    }
    image.push_back(1);
    sources.push_back(static_cast<float>(weight));
    const double monochrome = step.params.lambda_monochrome * step.scene.retinex[i];
    features.insert(features.end(), {0, 0, static_cast<float>(monochrome), 0});
  }
  for (size_t k = 0; k < kLayers; ++k) {
    float* color = &table[4 * (2 * kMaxBases + k)];
    for (size_t c = 0; c < 3; ++c) color[c] = static_cast<float>(step.scene.colors[k][c]);
    color[3] = 1;
  }
  const auto image_buffer = lab.upload(image), sources_buffer = lab.upload(sources),
             features_buffer = lab.upload(features), table_buffer = lab.upload(table),
             state = lab.upload(planes_of(step.x));
  const auto nodes = lab.buffer(2 * n), pixel_products = lab.buffer(2 * n);
  const auto diagonals = lab.buffer(field), preconditioned = lab.buffer(field),
             next = lab.buffer(field), directions = lab.buffer(field), products = lab.buffer(field);
  const gpu::Items pixels{kWidth, kHeight}, strips{kWidth, (kHeight - 1) / kStrip + 1, kGroups + 1},
      tall{kWidth, (kHeight * (kGroups + 1) - 1) / kStrip + 1};
  const auto partials_of = [](const auto& program, gpu::Items items) {
    return static_cast<int32_t>(gpu::partial_count(*program.kernel(), items));
  };
  const int32_t after_reweight = partials_of(reweight, pixels),
                after_product = partials_of(product, strips),
                after_update = partials_of(update, tall);
  const auto partials =
      lab.buffer(static_cast<uint64_t>(std::max({after_reweight, after_product, after_update})));
  const auto numbers = gpu::Buffer::create(device, gpu::Element::scalar, Scalars::CG_SIZE);
  const Push push = push_of(step);
  const auto reduce = [&](gpu::Commands& commands, int mode, int32_t count) {
    commands.dispatch(scalars, {.partials = partials, .scalars = numbers},
                      {.count = count, .mode = mode, .first = 1, .tolerance = 0}, {gpu::kOneGroup});
  };
  lab.run([&](gpu::Commands& commands) {
    for (const auto& buffer : {partials, numbers, directions}) commands.fill(buffer);
    commands.dispatch(reweight,
                      {.table = table_buffer,
                       .state = state,
                       .image = image_buffer,
                       .features = features_buffer,
                       .sources = sources_buffer,
                       .nodes = nodes,
                       .diagonals = diagonals,
                       .preconditioned = preconditioned,
                       .next = next,
                       .partials = partials},
                      push, pixels);
    reduce(commands, Scalars::kSystem, after_reweight);
    commands.fill(next);  // the change alone: beside x it would lose digits
  });
  for (int run = 0; run < kRuns; ++run)
    lab.run([&](gpu::Commands& commands) {
      for (int k = 0; k < kIterations; ++k) {
        commands.dispatch(mix,
                          {.table = table_buffer,
                           .preconditioned = preconditioned,
                           .previous = directions,
                           .nodes = nodes,
                           .scalars = numbers,
                           .directions = gpu::aliased(directions),
                           .pixel_products = pixel_products},
                          push, pixels);
        commands.dispatch(product,
                          {.table = table_buffer,
                           .directions = directions,
                           .state = state,
                           .pixel_products = pixel_products,
                           .diagonals = diagonals,
                           .products = products,
                           .partials = partials},
                          push, strips);
        reduce(commands, Scalars::kAlpha, after_product);
        commands.dispatch(update,
                          {.solution = next,
                           .preconditioned = preconditioned,
                           .directions = directions,
                           .products = products,
                           .diagonals = diagonals,
                           .scalars = numbers,
                           .solution_out = gpu::aliased(next),
                           .preconditioned_out = gpu::aliased(preconditioned),
                           .partials = partials},
                          push, tall);
        reduce(commands, Scalars::kBeta, after_update);
      }
    });
  const Pixels got = lab.download(next);
  std::vector<double> x;
  for (size_t i = 0; i < n; ++i)
    for (size_t k = 0; k < 4 + kLayers; ++k)
      x.push_back(static_cast<double>(got[4 * (k / 4 * n + i) + k % 4]));
  return x;
}

Problem problem_of(const std::string& name, const Step& step) {
  const auto kept = std::make_shared<const Step>(step);
  const reference::SampleFrame nothing = make_sample_frame(kept->scene, kept->x);
  const reference::GlobalSystem system =
      assemble(kept->scene, kept->x, {{&nothing}, 0}, kept->params);
  const size_t unknowns = 4 + kLayers;
  const size_t size = kept->x.data.size();
  Eigen::MatrixXd matrix(size, size);
  GlobalField unit(kWidth, kHeight, kLayers), column = unit;
  for (size_t n = 0; n < size; ++n) {
    unit.at(n / unknowns)[n % unknowns] = 1;
    reference::apply(system, unit, &column);
    unit.at(n / unknowns)[n % unknowns] = 0;
    for (size_t m = 0; m < size; ++m) matrix(m, n) = column.data[m];
  }
  return {name,
          Solver::global_thesis,
          matrix,
          system.b.data,
          [kept](const Lab& lab) { return solve_on_device(lab, *kept); },
          kRuns * kIterations};
}

/// Where a step starts: four paints in patches under a ramp of light that spans `decades` more,
/// reflectance at its clusters, direct light what explains the frame, a tenth of it in every layer;
/// or `flat`: no difference anywhere.
struct Setting {
  Params params;
  bool flat = false;
  double decades = 0;
  double alike = 0;     ///< how much the base colors are one, 0…1
  double negative = 0;  ///< light below zero in every second pixel
};

Step step_of(Setting setting) {
  constexpr double kPaints[kLayers][3] = {
      {0.8, 0.3, 0.2}, {0.2, 0.5, 0.7}, {0.6, 0.6, 0.55}, {0.15, 0.3, 0.1}};
  setting.params.samples = 0;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-0.01, 0.01);
  reference::Plane image(kWidth, kHeight), clusters(kWidth, kHeight);
  GlobalField x(kWidth, kHeight, kLayers);
  for (int y = 0; y < kHeight; ++y)
    for (int column = 0; column < kWidth; ++column) {
      const size_t n = image.index(column, y),
                   paint = static_cast<size_t>(column / 3 + 2 * (y / 2)) % kLayers;
      const double light = (0.4 + 0.1 * y) * std::pow(10, -setting.decades * column / (kWidth - 1));
      double* unknowns = x.at(n);
      double shading = 0;
      for (size_t c = 0; c < 3; ++c) {
        image.data[n][c] = kPaints[paint][c] * light * (1 + noise(random));
        clusters.data[n][c] = std::log(kPaints[paint][c]);
        unknowns[c] = single(setting.flat ? -1 : clusters.data[n][c] + 0.1 * noise(random));
        shading += image.data[n][c] / kPaints[paint][c] / 3;
      }
      clusters.data[n][3] = 1;
      unknowns[3] = single(setting.flat ? 0.5 : shading);
      for (size_t k = 0; k < kLayers; ++k)
        unknowns[4 + k] =
            single(setting.flat                    ? 0.05
                   : setting.negative > 0 && n % 2 ? -setting.negative
                                                   : 0.1 * shading / static_cast<double>(kLayers));
    }
  std::vector<reference::Vec3> colors;
  for (const auto& paint : kPaints) {
    const double largest = std::max({paint[0], paint[1], paint[2]});
    reference::Vec3 color{};
    for (size_t c = 0; c < 3; ++c)
      color[c] = single(setting.alike + (1 - setting.alike) * paint[c] / largest);
    colors.push_back(color);
  }
  return {GlobalThesisScene(in_single_precision(image), in_single_precision(clusters), colors,
                            setting.params),
          x, setting.params};
}

}  // namespace

void add_global_thesis(std::vector<Problem>& problems) {
  const auto add = [&](const std::string& name, auto change) {
    Setting setting;
    change(setting);
    problems.push_back(problem_of(name, step_of(setting)));
  };
  add("defaults", [](Setting&) {});
  for (const double epsilon : {1.0, 1e-2, 1e-3, 1e-4})
    add("epsilons " + decade(epsilon) + " at zero gradient", [epsilon](Setting& s) {
      s.flat = true;
      s.params.epsilon = s.params.epsilon_r = epsilon;
    });
  for (const double data : {1.0, 1e6})
    add("data " + decade(data), [data](Setting& s) { s.params.lambda_data = data; });
  add("p 0", [](Setting& s) { s.params.p = 0; });
  add("p 2", [](Setting& s) { s.params.p = 2; });
  for (const double decades : {2.0, 4.0, 8.0})
    add("light over " + decade(decades) + " decades",
        [decades](Setting& s) { s.decades = decades; });
  add("sparsity 1e4", [](Setting& s) { s.params.lambda_i_sparsity = 1e4; });
  add("smoothness 1e4", [](Setting& s) { s.params.lambda_smoothness = 1e4; });
  add("clusters 1e-4", [](Setting& s) { s.params.lambda_clustering = 1e-4; });
  add("clusters 1e-4, data 1e6", [](Setting& s) {
    s.params.lambda_clustering = 1e-4;
    s.params.lambda_data = 1e6;
  });
  add("clusters 1e-4, epsilons 1e-4 at zero gradient", [](Setting& s) {
    s.flat = true;
    s.params.lambda_clustering = 1e-4;
    s.params.epsilon = s.params.epsilon_r = 1e-4;
  });
  add("clusters 1e-4, smoothness 1e6", [](Setting& s) {
    s.params.lambda_clustering = 1e-4;
    s.params.lambda_smoothness = 1e6;
  });
  add("base colors that are nearly one", [](Setting& s) { s.alike = 0.999; });
  for (const double penalty : {1e3, 1e6})
    add("negative light, penalty " + decade(penalty), [penalty](Setting& s) {
      s.negative = 0.01;
      s.params.lambda_non_negativity = penalty;
    });
}

}  // namespace inverse::extremes

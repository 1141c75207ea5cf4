// SPDX-License-Identifier: LGPL-2.1-or-later
// Stiff systems of increasing condition. Strokes (Eq. 4.7: a weight on a pixel's diagonal, weight ·
// target on its right-hand side) are not a feature yet: a pull of one pixel towards a constant,
// which is the same system, stands in for them in intrinsicdecompthesis, and the anchor of one cell
// in intrinsicdecomp.
#include <algorithm>
#include <cmath>
#include <random>

#include "global_thesis_problem.hpp"
#include "grid_problem.hpp"
#include "tests/extremes/support/problem.hpp"
#include "thesis_problem.hpp"

namespace inverse::extremes {
namespace {

using reference::ThesisParams;

constexpr int kWidth = 10, kHeight = 7;              // of thesis systems: 280 unknowns
constexpr Extent kGrid{20, 13};                      // of the multigrid's: 260
constexpr int kRestarts = 4, kIterations = 280;      // PCG
constexpr int kSweeps = 120, kInnerIterations = 64;  // Schwarz
constexpr uint32_t kCycles = 240;                    // multigrid
constexpr int kPlainIterations = 4000;

/// Four paints in patches under a ramp of light, noise on top.
reference::Plane patches(unsigned seed) {
  constexpr double kPaints[4][3] = {
      {0.8, 0.3, 0.2}, {0.2, 0.5, 0.7}, {0.6, 0.6, 0.55}, {0.15, 0.3, 0.1}};
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> noise(-0.01, 0.01);
  reference::Plane image(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (size_t c = 0; c < 3; ++c)
        image.at(x, y)[c] =
            kPaints[(x / 4 + 2 * (y / 3)) % 4][c] * (0.3 + 0.06 * y) + noise(random);
  return in_single_precision(image);
}

/// A frozen system of the thesis' method as a problem for one of its solvers.
Problem thesis_problem(const std::string& name, Solver solver, const reference::Plane& image,
                       const ThesisParams& params, const reference::SourcePlane& sources,
                       reference::ThesisSystem system) {
  system.edges = in_single_precision(system.edges);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      reference::Vec4& node = system.node.at(x, y);
      const reference::Vec4& here = system.edges.at(x, y);
      for (const size_t kind : {0U, 2U})
        node[kind / 2 + 2] = here[kind] + here[kind + 1] +
                             (x > 0 ? system.edges.at(x - 1, y)[kind] : 0) +
                             (y > 0 ? system.edges.at(x, y - 1)[kind + 1] : 0);
    }
  std::vector<double> b;
  for (const reference::Vec4& value : system.b.data) b.insert(b.end(), value.begin(), value.end());
  const auto on_device = [image, params, sources, edges = system.edges, solver](const Lab& lab) {
    ThesisLab method(lab, image, params);
    method.set_edges(edges);
    method.set_sources(sources);
    const bool schwarz = solver == Solver::schwarz;
    for (int k = 0; k < (schwarz ? kSweeps : kRestarts); ++k)
      method.step(schwarz, schwarz ? kInnerIterations : kIterations, k);
    std::vector<double> x;
    for (const reference::Vec4& value : method.solution().data)
      x.insert(x.end(), value.begin(), value.end());
    return x;
  };
  return {name,
          solver,
          matrix_of(system),
          b,
          on_device,
          solver == Solver::schwarz ? kSweeps * kInnerIterations : kRestarts * kIterations};
}

/// The system of an IRLS step where `x0` says what the step starts from.
enum class Start { image, flat };
Problem irls_problem(const std::string& name, Solver solver, const ThesisParams& params,
                     Start start, const std::vector<double>& strokes) {
  const reference::Plane image = patches(1);
  const reference::ThesisLevel level(image, params);
  reference::Plane x0 = level.log_image;
  for (reference::Vec4& value : x0.data)
    value = start == Start::flat ? reference::Vec4{-1, -1, -1, -1}
                                 : reference::Vec4{value[0] / 2, value[1] / 2, value[2] / 2, 0};
  reference::SourcePlane sources(kWidth, kHeight);
  for (size_t k = 0; k < strokes.size(); ++k) {
    reference::Vec4& source = sources.at(static_cast<int>(2 + 3 * k), static_cast<int>(1 + 2 * k));
    source = {-0.5 * strokes[k], -0.7 * strokes[k], -1.1 * strokes[k], strokes[k]};
  }
  sources = in_single_precision(sources);
  return thesis_problem(name, solver, image, params, sources, assemble(level, x0, sources, params));
}

void add_thesis(std::vector<Problem>& problems, Solver solver) {
  const auto add = [&](const std::string& name, const ThesisParams& params, Start start,
                       const std::vector<double>& strokes) {
    problems.push_back(irls_problem(name, solver, params, start, strokes));
  };
  add("defaults", {}, Start::image, {10, 10});
  for (const double epsilon : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
    ThesisParams params{.epsilon = epsilon};
    add("epsilon " + decade(epsilon) + " at zero gradient", params, Start::flat, {10, 10});
  }
  for (const double p : {2.0, 1.0, 0.3, 0.01}) {
    ThesisParams params{.p = p};
    params.epsilon = p == 1 ? 1e-6 : params.epsilon;
    add("p " + decade(p) + (p == 1 ? ", epsilon 1e-06" : "") + " at zero gradient", params,
        Start::flat, {10, 10});
  }
  for (const double stroke : {1e-2, 1e3, 1e5})
    add("stroke of " + decade(stroke), {}, Start::image, {stroke, stroke});
  add("strokes of 1e-1 and 1e5", {}, Start::image, {1e-1, 1e5});
  ThesisParams params{.w_data = 1e6};
  add("data 1e6", params, Start::image, {10, 10});
  params = {};
  params.w_reflectance = 1e4;
  params.w_shading = 1e-2;
  add("reflectance 1e4, shading 1e-2", params, Start::image, {10, 10});
  params = {};
  params.w_shading = 1e6;
  params.w_reflectance = 1e-6;
  add("shading 1e6, reflectance 1e-6", params, Start::image, {10, 10});
  for (const double decades : {6.0, 12.0}) {
    // Every edge's weight by itself, uniform in its logarithm.
    const reference::Plane image = patches(2);
    const reference::ThesisLevel level(image, {});
    reference::SourcePlane sources(kWidth, kHeight);
    for (reference::Vec4& source : sources.data) source = {-0.5, -0.75, -1.125, 1};
    reference::ThesisSystem system = assemble(level, level.log_image, sources, {});
    std::mt19937 random(3);
    std::uniform_real_distribution<double> exponent(-decades / 2, decades / 2);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        reference::Vec4& edge = system.edges.at(x, y);
        for (double& weight : edge) weight = std::pow(10, exponent(random));
        if (x + 1 == kWidth) edge[0] = edge[2] = 0;
        if (y + 1 == kHeight) edge[1] = edge[3] = 0;
      }
    problems.push_back(thesis_problem("edges over " + decade(decades) + " decades", solver, image,
                                      {}, sources, system));
  }
}

Problem grid_problem(const std::string& name, const GridSystem& system) {
  return {name,
          Solver::multigrid,
          matrix_of(system),
          right_hand_side(system),
          [system](const Lab& lab) { return cycles_on_device(lab, system, kCycles).back(); },
          static_cast<int>(kCycles)};
}

/// Edges 10^low … 10^high, uniform in the logarithm; every cell screened by `screen`.
GridSystem random_grid(unsigned seed, double low, double high, float screen) {
  GridSystem system(kGrid);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> exponent(low, high), unit(-0.5, 0.5);
  for (size_t n = 0; n < system.f.size(); ++n) {
    system.right[n] = static_cast<float>(std::pow(10, exponent(random)));
    system.down[n] = static_cast<float>(std::pow(10, exponent(random)));
  }
  for (size_t n = 0; n < system.screen.size(); ++n) {
    system.screen[n] = screen;
    system.pull[n] = screen * static_cast<float>(unit(random) - 1);
  }
  return system;
}

/// Patches of 8 × 8 pixels whose insides hold together with `inside` and each other with `between`.
GridSystem patched_grid(float inside, float between, float screen) {
  GridSystem system = random_grid(5, 0, 0, screen);
  for (uint32_t y = 0; y < kGrid.height; ++y)
    for (uint32_t x = 0; x < kGrid.width; ++x) {
      system.right[system.at(x, y)] = x % 8 == 7 ? between : inside;
      system.down[system.at(x, y)] = y % 8 == 7 ? between : inside;
    }
  return system;
}

void add_grids(std::vector<Problem>& problems) {
  for (const double decades : {0.0, 2.0, 4.0, 6.0, 8.0, 12.0})
    problems.push_back(
        grid_problem("edges over " + decade(decades) + " decades",
                     random_grid(static_cast<unsigned>(decades), -decades / 2, decades / 2, 1)));
  for (const float inside : {1e2F, 1e4F, 1e6F})
    problems.push_back(
        grid_problem("patches of " + decade(static_cast<double>(inside)) + " that 1 joins",
                     patched_grid(inside, 1, 0.1F)));
  for (const float screen : {1e3F, 1e-2F, 1e-4F})
    problems.push_back(grid_problem("cells held by " + decade(static_cast<double>(screen)),
                                    random_grid(7, -1, 1, screen)));
  for (const float anchor : {1e3F, 1e5F}) {
    GridSystem system = random_grid(8, -1, 1, 1);
    system.anchor[7] = anchor;
    for (uint32_t y = 4; y < 8; ++y)
      for (uint32_t x = 8; x < 12; ++x) system.f[system.at(x, y)] = -0.7F * anchor;
    problems.push_back(
        grid_problem("stroke of " + decade(static_cast<double>(anchor)) + " on a cell", system));
  }
}

}  // namespace

std::string decade(double value) {
  char text[32];
  snprintf(text, sizeof text, "%g", value);
  return text;
}

const char* name_of(Solver solver) {
  switch (solver) {
    case Solver::multigrid:
      return "multigrid";
    case Solver::pcg:
      return "pcg";
    case Solver::schwarz:
      return "schwarz";
    case Solver::global:
      return "global";
    case Solver::global_thesis:
      return "global-thesis";
  }
  return "";
}

std::vector<Problem> stiff_problems() {
  std::vector<Problem> problems;
  add_grids(problems);
  add_thesis(problems, Solver::pcg);
  add_thesis(problems, Solver::schwarz);
  add_global_thesis(problems);
  return problems;
}

Outcome judge(const Problem& problem, const Lab& lab) {
  Outcome outcome;
  outcome.condition = condition_number(problem.matrix);
  outcome.condition_preconditioned = condition_number(scaled_by_diagonal(problem.matrix));
  const std::vector<double> exact = solve(problem.matrix, problem.b);
  outcome.digits_plain =
      digits_kept(plain_single_precision(problem.matrix, problem.b, kPlainIterations), exact);
  const std::vector<double> x = problem.solve_on_device(lab);
  outcome.finite = std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
  outcome.digits_preconditioned = digits_kept(x, exact);
  return outcome;
}

}  // namespace inverse::extremes

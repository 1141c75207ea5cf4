// SPDX-License-Identifier: LGPL-2.1-or-later
#include "global_thesis.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace inverse::reference {
namespace {

double dot(const GlobalField& a, const GlobalField& b) {
  return std::inner_product(a.data.begin(), a.data.end(), b.data.begin(), 0.0);
}

double squared(double v) { return v * v; }

Vec3 chromaticity(const Vec3& color) {
  const double mean = std::max((color[0] + color[1] + color[2]) / 3, kDarkestColor);
  return {color[0] / mean, color[1] / mean, color[2] / mean};
}

/// ∂C/∂b at b: row c, column d of (δ_cd − c_c/3)/|b|.
double chromaticity_slope(const Vec3& color, std::size_t row, std::size_t column) {
  const double mean = std::max((color[0] + color[1] + color[2]) / 3, kDarkestColor);
  return ((row == column ? 1 : 0) - chromaticity(color)[row] / 3) / mean;
}

}  // namespace

Vec3 base_color(const Vec3& color) {
  constexpr double kBlack = 1e-6;
  const double largest = std::max({color[0], color[1], color[2], 0.0});
  Vec3 result{};
  for (std::size_t c = 0; c < 3; ++c)
    result[c] = std::clamp((color[c] + kBlack) / (largest + kBlack), kDarkestColor, 1.0);
  return result;
}

Plane cluster_targets(const Plane& linear, const std::vector<Vec3>& centers,
                      const std::vector<Vec3>& colors, double chroma_floor) {
  Plane targets(linear.width, linear.height);
  if (centers.empty()) return targets;
  for (std::size_t n = 0; n < linear.size(); ++n) {
    Vec3 light{};
    for (std::size_t c = 0; c < 3; ++c) light[c] = finite_light(linear.data[n][c]);
    const double mean = (light[0] + light[1] + light[2]) / 3 + chroma_floor;
    std::size_t nearest = 0;
    double best = 0;
    for (std::size_t k = 0; k < centers.size(); ++k) {
      double distance = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        distance += squared(std::log((light[c] + chroma_floor) / mean) - centers[k][c]);
      }
      if (k == 0 || distance < best) {
        nearest = k;
        best = distance;
      }
    }
    for (std::size_t c = 0; c < 3; ++c) {
      targets.data[n][c] = std::log(std::max(colors[nearest][c], kDarkestColor));
    }
    targets.data[n][3] = 1;
  }
  return targets;
}

GlobalField global_start(const GlobalThesisScene& scene, const GlobalThesisParams& params) {
  const std::size_t layers = scene.layers();
  GlobalField x(scene.image.width, scene.image.height, layers);
  Vec3 light = {1, 1, 1};  // of T_0 = 1
  const double share = layers > 0 ? params.indirect_start / static_cast<double>(layers) : 0;
  for (const Vec3& color : scene.colors) {
    for (std::size_t c = 0; c < 3; ++c) light[c] += share * color[c];
  }
  for (std::size_t n = 0; n < x.pixels(); ++n) {
    double* v = x.at(n);
    const Vec4& i = scene.image.data[n];
    const double largest = std::max({i[0], i[1], i[2], params.log_floor});
    double fit = 0;
    double norm = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      v[c] = scene.targets.data[n][3] > 0
                 ? scene.targets.data[n][c]
                 : std::log(std::max(i[c], params.log_floor * largest) / largest);
      const double model = std::exp(v[c]) * light[c];
      fit += model * i[c];
      norm += model * model;
    }
    v[3] = fit / norm;
    for (std::size_t k = 0; k < layers; ++k) v[4 + k] = share * v[3];
  }
  return x;
}

GlobalField conjugate_gradients(const GlobalSystem& system, int iterations, double tolerance) {
  const GlobalField m = diagonal(system);
  GlobalField residual = system.b;
  GlobalField delta(m.width, m.height, m.unknowns - 4);
  GlobalField z = delta;
  GlobalField product = delta;
  const auto precondition = [&] {
    for (std::size_t i = 0; i < z.data.size(); ++i) {
      z.data[i] = m.data[i] > 0 ? residual.data[i] / m.data[i] : 0;
    }
  };
  precondition();
  GlobalField direction = z;
  double rz = dot(residual, z);
  const double stop = rz * tolerance * tolerance;
  for (int k = 0; k < iterations && rz > stop; ++k) {
    apply(system, direction, &product);
    const double curvature = dot(direction, product);
    if (!(curvature > 0)) break;
    const double alpha = rz / curvature;
    for (std::size_t i = 0; i < z.data.size(); ++i) {
      delta.data[i] += alpha * direction.data[i];
      residual.data[i] -= alpha * product.data[i];
    }
    precondition();
    const double next = dot(residual, z);
    const double beta = next / rz;
    rz = next;
    for (std::size_t i = 0; i < z.data.size(); ++i) {
      direction.data[i] = z.data[i] + beta * direction.data[i];
    }
  }
  return delta;
}

void take_step(const GlobalField& delta, GlobalField* x) {
  for (std::size_t i = 0; i < x->data.size(); ++i) {
    double& v = x->data[i];
    if (i % x->unknowns < 3) {
      v = std::clamp(v + std::clamp(delta.data[i], -kLargestStep, kLargestStep), kSmallestLog,
                     kLargestLog);
    } else {
      v = std::clamp(v + delta.data[i], -kLargestLight, kLargestLight);
    }
  }
}

bool step_is_good(const GlobalEnergy& start, const GlobalEnergy& before, const GlobalEnergy& after,
                  bool samples) {
  const double first = start.total() - start.r_consistency;
  const double from = before.total() - before.r_consistency;
  const double rest = after.total() - after.r_consistency - after.non_negativity;
  return rest <= from * (1 + 1e-5) || (samples && rest <= std::min(from, first) * 1.05);
}

RefinementSystem refinement_system(const GlobalThesisScene& scene, const GlobalField& x,
                                   const std::vector<Vec3>& initial,
                                   const GlobalThesisParams& params) {
  const std::size_t colors = scene.layers(), size = 3 * colors;
  RefinementSystem system{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size)};
  for (std::size_t n = 0; n < x.pixels(); ++n) {
    const double* v = x.at(n);
    const Vec3 s = shading(scene, v);
    for (std::size_t c = 0; c < 3; ++c) {
      const double reflectance = std::exp(v[c]);
      const double e = scene.image.data[n][c] - reflectance * s[c];
      for (std::size_t k = 0; k < colors; ++k) {
        const double slope = params.lambda_data * reflectance * v[4 + k];
        system.b[3 * k + c] += slope * e;
        for (std::size_t l = 0; l < colors; ++l) {
          system.matrix(3 * k + c, 3 * l + c) += slope * reflectance * v[4 + l];
        }
      }
    }
  }
  for (std::size_t k = 0; k < colors; ++k) {
    const Vec3 now = chromaticity(scene.colors[k]);
    const Vec3 wanted = chromaticity(initial[k]);
    for (std::size_t c = 0; c < 3; ++c) {
      system.matrix(3 * k + c, 3 * k + c) += params.lambda_ir;
      for (std::size_t row = 0; row < 3; ++row) {
        const double slope = params.lambda_cr * chromaticity_slope(scene.colors[k], row, c);
        system.b[3 * k + c] -= slope * (now[row] - wanted[row]);
        for (std::size_t d = 0; d < 3; ++d) {
          system.matrix(3 * k + c, 3 * k + d) +=
              slope * chromaticity_slope(scene.colors[k], row, d);
        }
      }
    }
  }
  return system;
}

double refinement_energy(const GlobalThesisScene& scene, const GlobalField& x,
                         const std::vector<Vec3>& initial, const std::vector<Vec3>& delta,
                         const GlobalThesisParams& params) {
  double energy = 0;
  for (std::size_t n = 0; n < x.pixels(); ++n) {
    const double* v = x.at(n);
    Vec3 s = shading(scene, v);
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t k = 0; k < delta.size(); ++k) s[c] += delta[k][c] * v[4 + k];
      energy += params.lambda_data * squared(scene.image.data[n][c] - std::exp(v[c]) * s[c]);
    }
  }
  for (std::size_t k = 0; k < delta.size(); ++k) {
    for (std::size_t row = 0; row < 3; ++row) {
      double change = chromaticity(scene.colors[k])[row] - chromaticity(initial[k])[row];
      for (std::size_t c = 0; c < 3; ++c) {
        change += chromaticity_slope(scene.colors[k], row, c) * delta[k][c];
      }
      energy += params.lambda_ir * squared(delta[k][row]) + params.lambda_cr * squared(change);
    }
  }
  return energy;
}

std::vector<Vec3> solve_refinement(const RefinementSystem& system) {
  const Eigen::VectorXd solution = system.matrix.llt().solve(system.b);
  std::vector<Vec3> delta;
  for (Eigen::Index k = 0; k < solution.size(); k += 3)
    delta.push_back({solution[k], solution[k + 1], solution[k + 2]});
  return delta;
}

std::vector<Vec3> refined(const std::vector<Vec3>& colors, const std::vector<Vec3>& delta) {
  std::vector<Vec3> result = colors;
  for (std::size_t k = 0; k < colors.size(); ++k) {
    for (std::size_t c = 0; c < 3; ++c) {
      result[k][c] = std::clamp(colors[k][c] + delta[k][c], kDarkestColor, 1.0);
    }
  }
  return result;
}

GlobalSamples GlobalThesis::samples(const SampleFrame& current) const {
  GlobalSamples result;
  result.frames = {&current};
  for (const SampleFrame& keyframe : used_keyframes_) result.frames.push_back(&keyframe);
  result.epoch = params_.resample ? frame_ : 0;
  return result;
}

GlobalField GlobalThesis::decompose(const Plane& linear, const Plane& targets,
                                    std::vector<Vec3> colors) {
  scenes_.clear();
  scenes_.emplace_back(linear, targets, std::move(colors), params_);
  GlobalThesisScene& scene = scenes_.back();
  for (std::size_t n = 0; n < chromaticities_.size(); ++n) {
    scene.sampling.packed[n] = chromaticities_.data[n][3];
  }
  shortened_ = 0;
  used_keyframes_.assign(keyframes_.begin(), keyframes_.end());
  GlobalField x = global_start(scene, params_);
  const GlobalEnergy start = global_energy(scene, x, samples(make_sample_frame(scene, x)), params_);
  for (int step = 0; step <= params_.steps; ++step) {
    const SampleFrame current = make_sample_frame(scene, x);
    if (trace_) trace_(step - 1, global_energy(scene, x, samples(current), params_));
    if (step == params_.steps) break;
    const GlobalField from = x;
    const GlobalEnergy before = global_energy(scene, from, samples(current), params_);
    take_step(
        conjugate_gradients(assemble(scene, x, samples(current), params_), params_.pcg_iterations),
        &x);
    for (int trial = 0; trial < 3 && params_.line_search; ++trial) {
      const GlobalEnergy after = global_energy(scene, x, samples(current), params_);
      if (step_is_good(start, before, after, params_.samples > 0)) break;
      if (trial == 0) ++shortened_;
      for (std::size_t i = 0; i < x.data.size(); ++i)
        x.data[i] = from.data[i] + (trial == 2 ? 0 : 0.25) * (x.data[i] - from.data[i]);
    }
  }
  if (params_.keyframes > 0 && frame_ % static_cast<std::uint32_t>(params_.keyframe_spacing) == 0) {
    keyframes_.push_back(make_sample_frame(scene, x));
    if (static_cast<int>(keyframes_.size()) > params_.keyframes) keyframes_.pop_front();
  }
  ++frame_;
  return x;
}

GlobalEnergy GlobalThesis::energy(const GlobalField& x) const {
  const SampleFrame current = make_sample_frame(scene(), x);
  GlobalSamples drawn = samples(current);
  drawn.epoch = params_.resample ? frame_ - 1 : 0;
  return global_energy(scene(), x, drawn, params_);
}

}  // namespace inverse::reference

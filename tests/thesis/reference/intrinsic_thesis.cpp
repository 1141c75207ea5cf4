// SPDX-License-Identifier: LGPL-2.1-or-later
#include "intrinsic_thesis.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace inverse::reference {
namespace {

constexpr int kBlock = 16;
constexpr std::array<double, 5> kBinomial = {1.0 / 16, 4.0 / 16, 6.0 / 16, 4.0 / 16, 1.0 / 16};

/// The radical inverse of n in a base, times 16, rounded down.
int halton16(int n, int base) {
  int digits = 0;
  int denominator = 1;
  for (; n > 0; n /= base) {
    digits = digits * base + n % base;
    denominator *= base;
  }
  return kBlock * digits / denominator;
}

double dot(const Plane& a, const Plane& b, int x0, int y0, int x1, int y1) {
  double sum = 0;
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      for (int c = 0; c < 4; ++c) sum += a.at(x, y)[c] * b.at(x, y)[c];
    }
  }
  return sum;
}

}  // namespace

int thesis_levels(int width, int height, int levels) {
  int possible = 1;
  for (int side = std::max(width, height); side > 1; side = (side + 1) / 2) ++possible;
  int wanted = levels;
  if (levels == 0) {
    wanted = 3;
    for (int side = std::min(width, height) / 4; side >= 48 && wanted < 5; side /= 2) ++wanted;
  }
  return std::min(wanted, possible);
}

Plane downsample(const Plane& fine) {
  Plane coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
  for (int y = 0; y < coarse.height; ++y) {
    for (int x = 0; x < coarse.width; ++x) {
      for (int dy = -2; dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) {
          const Vec4& value = fine.at(std::clamp(2 * x + dx, 0, fine.width - 1),
                                      std::clamp(2 * y + dy, 0, fine.height - 1));
          const double weight = kBinomial[dx + 2] * kBinomial[dy + 2];
          for (int c = 0; c < 4; ++c) coarse.at(x, y)[c] += weight * value[c];
        }
      }
    }
  }
  return coarse;
}

Plane prolong(const Plane& coarse, int width, int height) {
  Plane fine(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int x1 = std::min((x + 1) / 2, coarse.width - 1);
      const int y1 = std::min((y + 1) / 2, coarse.height - 1);
      for (int c = 0; c < 4; ++c) {
        fine.at(x, y)[c] = (coarse.at(x / 2, y / 2)[c] + coarse.at(x1, y / 2)[c] +
                            coarse.at(x / 2, y1)[c] + coarse.at(x1, y1)[c]) /
                           4;
      }
    }
  }
  return fine;
}

StrokeMask coarse_strokes(const StrokeMask& fine, int width, int height) {
  StrokeMask coarse{fine.kinds, {}, {}};
  for (int y = 0; y < (height + 1) / 2; ++y) {
    for (int x = 0; x < (width + 1) / 2; ++x) {
      std::map<int, double> sums;
      std::vector<int> order;  // of two equal sums the first one counts
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const auto at = static_cast<std::size_t>(std::clamp(2 * y + dy, 0, height - 1)) *
                              static_cast<std::size_t>(width) +
                          static_cast<std::size_t>(std::clamp(2 * x + dx, 0, width - 1));
          if (fine.stroke[at] < 0) continue;
          sums[fine.stroke[at]] += (2 - std::abs(dx)) * (2 - std::abs(dy)) / 16.0 * fine.weight[at];
          order.push_back(fine.stroke[at]);
        }
      }
      int best = -1;
      for (const int stroke : order)
        if (sums[stroke] > (best < 0 ? 0 : sums[best])) best = stroke;
      coarse.stroke.push_back(best);
      coarse.weight.push_back(best < 0 ? 0 : sums[best]);
    }
  }
  return coarse;
}

std::array<int, 2> schwarz_shift(int iteration) {
  return {halton16(iteration, 2), halton16(iteration, 3)};
}

ConjugateGradients::ConjugateGradients(int width, int height, bool single)
    : residual_(width, height),
      z_(width, height),
      direction_(width, height),
      product_(width, height),
      single_(single) {}

void ConjugateGradients::run(const ThesisSystem& system, int iterations, double tolerance, int x0,
                             int y0, int x1, int y1, const Plane& start, Plane* x) {
  const int width = x->width;
  const int height = x->height;
  const auto store = [&](double value) {
    return single_ ? static_cast<double>(static_cast<float>(value)) : value;
  };
  const auto for_block = [&](auto f) {
    for (int row = y0; row < y1; ++row) {
      for (int column = x0; column < x1; ++column) f(x->index(column, row));
    }
  };
  const auto precondition = [&](std::size_t n) {
    const Vec4 d = diagonal(system, n);
    for (int c = 0; c < 4; ++c) z_.data[n][c] = d[c] > 0 ? residual_.data[n][c] / d[c] : 0;
  };
  // Values outside the block enter through the residual: lagged Dirichlet.
  const int left = std::max(x0 - 1, 0);
  const int top = std::max(y0 - 1, 0);
  apply(system, start, left, top, std::min(x1 + 1, width), std::min(y1 + 1, height), &product_);
  for_block([&](std::size_t n) {
    for (int c = 0; c < 4; ++c) residual_.data[n][c] = system.b.data[n][c] - product_.data[n][c];
    precondition(n);
  });
  double rz = dot(residual_, z_, x0, y0, x1, y1);
  const double stop = rz * tolerance * tolerance;
  double beta = 0;
  for (int k = 0; k < iterations && rz > stop; ++k) {
    for_block([&](std::size_t n) {
      for (int c = 0; c < 4; ++c) {
        direction_.data[n][c] = store(z_.data[n][c] + beta * direction_.data[n][c]);
      }
    });
    apply(system, direction_, x0, y0, x1, y1, &product_);
    const double curvature = dot(direction_, product_, x0, y0, x1, y1);
    if (!(curvature > 0)) break;
    const double alpha = rz / curvature;
    for_block([&](std::size_t n) {
      for (int c = 0; c < 4; ++c) {
        x->data[n][c] = store(x->data[n][c] + alpha * direction_.data[n][c]);
        residual_.data[n][c] = store(residual_.data[n][c] - alpha * product_.data[n][c]);
      }
      precondition(n);
    });
    const double next = dot(residual_, z_, x0, y0, x1, y1);
    beta = next / rz;
    rz = next;
  }
}

void IntrinsicThesis::irls_step(const ThesisSystem& system, int step, Plane* x) const {
  if (converged_) {
    ConjugateGradients(x->width, x->height)
        .run(system, 2000, 1e-8, 0, 0, x->width, x->height, *x, x);
    return;
  }
  if (!params_.schwarz) {
    ConjugateGradients(x->width, x->height, single_)
        .run(system, params_.pcg_iterations, 0, 0, 0, x->width, x->height, *x, x);
    return;
  }
  // Additive: every block starts from the same x and writes a new one.
  const auto [shift_x, shift_y] = schwarz_shift(step);
  ConjugateGradients solver(x->width, x->height, single_);
  const Plane start = *x;
  for (int y = -shift_y; y < x->height; y += kBlock) {
    for (int column = -shift_x; column < x->width; column += kBlock) {
      const int x0 = std::max(column, 0);
      const int y0 = std::max(y, 0);
      const int x1 = std::min(column + kBlock, x->width);
      const int y1 = std::min(y + kBlock, x->height);
      if (x0 >= x1 || y0 >= y1) continue;
      solver.run(system, params_.pcg_iterations, 0, x0, y0, x1, y1, start, x);
    }
  }
}

std::vector<const SampleFrame*> IntrinsicThesis::frames(int index,
                                                        const SampleFrame& current) const {
  std::vector<const SampleFrame*> result = {&current};
  for (const Keyframe& keyframe : used_keyframes_) {
    result.push_back(&keyframe.levels[static_cast<std::size_t>(index)]);
  }
  return result;
}

ThesisEnergy IntrinsicThesis::energy_of(int index, const Plane& x, const Plane& clusters,
                                        const std::vector<const SampleFrame*>& sources,
                                        std::uint32_t epoch) const {
  const auto at = static_cast<std::size_t>(index);
  ThesisEnergy energy = thesis_energy(levels_[at], x, clusters, sources,
                                      static_cast<std::uint32_t>(index), epoch, params_);
  if (!strokes_.empty()) energy.user = user_energy(strokes_[at], stroke_means(strokes_[at], x), x);
  if (!known_levels_.empty())
    energy.stabilization = stabilization_energy(known_levels_[at], known_weight_, x);
  return energy;
}

void IntrinsicThesis::solve_level(int index) {
  const auto at = static_cast<std::size_t>(index);
  const ThesisLevel& level = levels_[at];
  Plane& x = solutions_[at];
  const auto stream = static_cast<std::uint32_t>(index);
  const Plane& clusters = index == 0 ? cluster_plane_ : Plane();
  double previous = 0;
  const int steps = converged_ ? 400 : params_.irls_iterations;
  for (int step = 0; step <= steps; ++step) {
    const SampleFrame current = make_sample_frame(level, x);
    const auto sources = frames(index, current);
    if (trace_ || converged_) {
      const ThesisEnergy energy = energy_of(index, x, clusters, sources, epoch());
      if (trace_) trace_(index, step - 1, energy);
      if (converged_ && std::abs(previous - energy.total()) <= 1e-10 * energy.total()) break;
      previous = energy.total();
    }
    if (step == steps) break;
    SourcePlane source = draw_samples(level, sources, stream, epoch(), params_);
    for (std::size_t n = 0; n < clusters.size(); ++n) {
      const Vec4& cluster = clusters.data[n];
      for (int c = 0; c < 3; ++c) source.data[n][c] += cluster[3] * cluster[c];
      source.data[n][3] += cluster[3];
    }
    if (!known_levels_.empty()) add_known(known_levels_[at], known_weight_, &source);
    ShadingSource shading;
    if (!strokes_.empty())
      add_strokes(strokes_[at], stroke_means(strokes_[at], x), &source, &shading);
    irls_step(assemble(level, x, source, params_, shading), step, &x);
  }
}

Plane IntrinsicThesis::decompose(const Plane& linear) {
  const int count = thesis_levels(linear.width, linear.height, params_.levels);
  Plane image = linear;
  for (Vec4& value : image.data) {
    for (double& channel : value) channel = finite_light(channel);
  }
  levels_.clear();
  solutions_.assign(static_cast<std::size_t>(count), Plane());
  levels_.emplace_back(image, params_);
  for (int n = 1; n < count; ++n) levels_.emplace_back(downsample(levels_.back().image), params_);
  for (std::size_t n = 0; n < chromaticities_.size(); ++n) {
    for (std::size_t k = 0; k < levels_[n].packed.size(); ++k) {
      levels_[n].packed[k] = chromaticities_[n].data[k][3];
    }
  }
  strokes_.clear();
  known_levels_.clear();
  if (!drawn_strokes_.kinds.empty()) strokes_.push_back(drawn_strokes_);
  if (known_.size() > 0) known_levels_.push_back(known_);
  for (std::size_t n = 1; n < levels_.size(); ++n) {
    const Plane& finer = levels_[n - 1].image;
    if (!strokes_.empty())
      strokes_.push_back(coarse_strokes(strokes_.back(), finer.width, finer.height));
    if (!known_levels_.empty()) known_levels_.push_back(downsample(known_levels_.back()));
  }
  used_keyframes_.assign(keyframes_.begin(), keyframes_.end());

  cluster_plane_ = Plane();
  for (int n = count - 1; n >= 0; --n) {
    const ThesisLevel& level = levels_[static_cast<std::size_t>(n)];
    Plane& x = solutions_[static_cast<std::size_t>(n)];
    if (n == count - 1) {
      // r = i/2, s = |i|/2: reflectance and shading have the same magnitude. What is known is r.
      x = level.log_image;
      for (std::size_t k = 0; k < x.size(); ++k) {
        const Vec4 known =
            known_levels_.empty() ? Vec4{} : known_levels_[static_cast<std::size_t>(n)].data[k];
        Vec4& value = x.data[k];
        value[3] = 0;
        for (int c = 0; c < 3; ++c) {
          const double r = known[c] + (1 - known[3]) * value[c] / 2;
          value[3] += (value[c] - r) / 3;
          value[c] = r;
        }
      }
    } else {
      x = prolong(solutions_[static_cast<std::size_t>(n) + 1], level.image.width,
                  level.image.height);
    }
    if (n == 0 && count > 1) {
      if (clusters_) {
        cluster_plane_ = *clusters_;
      } else {
        palette_.update(solutions_[1]);
        cluster_plane_ = clustered(x, palette_.log_colors());
      }
      for (std::size_t k = 0; k < cluster_plane_.size(); ++k) {
        const double weight =
            params_.w_clustering *
            std::exp(-params_.alpha_clustering * level.chromaticity.data[k][3]);  // (3.15)
        cluster_plane_.data[k][3] = cluster_plane_.data[k][3] < 0 ? 0 : weight;
      }
    }
    solve_level(n);
  }
  if (count == 1 && !clusters_) palette_.update(solutions_[0]);

  if (params_.keyframes > 0 && frame_ % static_cast<std::uint32_t>(params_.keyframe_spacing) == 0) {
    Keyframe keyframe;
    for (int n = 0; n < count; ++n) {
      const auto at = static_cast<std::size_t>(n);
      keyframe.levels.push_back(make_sample_frame(levels_[at], solutions_[at]));
    }
    keyframes_.push_back(std::move(keyframe));
    if (static_cast<int>(keyframes_.size()) > params_.keyframes) keyframes_.pop_front();
  }
  ++frame_;
  return solutions_[0];
}

ThesisEnergy IntrinsicThesis::energy(const Plane& x) const {
  const SampleFrame current = make_sample_frame(levels_[0], x);
  return energy_of(0, x, cluster_plane_, frames(0, current), params_.resample ? frame_ - 1 : 0);
}

}  // namespace inverse::reference

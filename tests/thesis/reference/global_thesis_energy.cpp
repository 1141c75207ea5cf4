// SPDX-License-Identifier: LGPL-2.1-or-later
#include "global_thesis_energy.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {
namespace {

/// What chapter 3's samples (3.12), (3.13) are drawn and weighted by.
ThesisParams sampling_params(const GlobalThesisParams& params) {
  const ThesisParams sampling{.w_intensity = params.w_intensity,
                              .w_non_local = params.lambda_r_consistency,
                              .tau_cc = params.tau_cc,
                              .log_floor = params.log_floor,
                              .chroma_floor = params.chroma_floor,
                              .samples = params.samples,
                              .seed = params.seed};
  return sampling;
}

/// The factor p/2 that makes the weights of (5.16) a majorizer, or 1, as printed.
double irls_factor(double p, const GlobalThesisParams& params) {
  return params.consistent_irls ? p / 2 : 1;
}

double squared(double v) { return v * v; }

double r_difference2(const double* a, const double* b) {
  return squared(a[0] - b[0]) + squared(a[1] - b[1]) + squared(a[2] - b[2]);
}

double smooth_abs(double v, double epsilon) {
  // √(v² + ε²) − ε without cancellation.
  return v * v / (std::sqrt(v * v + epsilon * epsilon) + epsilon);
}

double abs_weight(double v, const GlobalThesisParams& params) {
  return irls_factor(1, params) / std::sqrt(v * v + squared(params.epsilon));
}

double negativity(double v, double epsilon) {
  const double t = std::max(-v, 0.0);
  return t - epsilon * std::log1p(t / epsilon);
}

/// Weight of T² (5.6.4.1): 0 for T > 0, else 1/(|T| + ε).
double negativity_weight(double v, const GlobalThesisParams& params) {
  return v > 0 ? 0 : irls_factor(1, params) / (-v + params.epsilon);
}

/// Calls f(pixel, neighbor) for every edge once, to the right and down.
template <typename F>
void for_each_edge(int width, int height, F f) {
  const auto stride = static_cast<std::size_t>(width);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t n = static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x);
      if (x + 1 < width) f(n, n + 1, 0);
      if (y + 1 < height) f(n, n + stride, 1);
    }
  }
}

Plane sanitized(Plane image) {
  for (Vec4& value : image.data) {
    for (double& channel : value) channel = finite_light(channel);
  }
  return image;
}

/// v less the mean of its channels.
Vec3 colored(const Vec3& v) {
  const double mean = (v[0] + v[1] + v[2]) / 3;
  return {v[0] - mean, v[1] - mean, v[2] - mean};
}

}  // namespace

GlobalThesisScene::GlobalThesisScene(const Plane& linear, const Plane& clusters,
                                     std::vector<Vec3> base_colors,
                                     const GlobalThesisParams& params)
    : image(sanitized(linear)),
      sampling(image, sampling_params(params)),
      retinex(linear.size(), 0.0),
      targets(clusters),
      colors(std::move(base_colors)) {
  // (5.10): the largest step of chromaticity to one of the four neighbors.
  for_each_edge(image.width, image.height, [&](std::size_t a, std::size_t b, int) {
    double distance = 0;
    for (int c = 0; c < 3; ++c) {
      distance += squared(sampling.chromaticity.data[a][c] - sampling.chromaticity.data[b][c]);
    }
    const double weight = 1 - std::exp(-params.alpha_sr * std::sqrt(distance));
    for (const std::size_t end : {a, b}) retinex[end] = std::max(retinex[end], weight);
  });
}

Vec3 shading(const GlobalThesisScene& scene, const double* unknowns) {
  Vec3 s = {unknowns[3], unknowns[3], unknowns[3]};
  for (std::size_t k = 0; k < scene.layers(); ++k) {
    for (int c = 0; c < 3; ++c) s[c] += scene.colors[k][c] * unknowns[4 + k];
  }
  return s;
}

SampleFrame make_sample_frame(const GlobalThesisScene& scene, const GlobalField& x) {
  SampleFrame frame(x.width, x.height);
  for (std::size_t n = 0; n < frame.size(); ++n) {
    const double* v = x.at(n);
    frame.data[n] = {v[0], v[1], v[2], scene.sampling.packed[n]};
  }
  return frame;
}

GlobalEnergy global_energy(const GlobalThesisScene& scene, const GlobalField& x,
                           const GlobalSamples& samples, const GlobalThesisParams& params) {
  GlobalEnergy energy;
  Plane r(x.width, x.height);
  for (std::size_t n = 0; n < x.pixels(); ++n) {
    const double* v = x.at(n);
    r.data[n] = {v[0], v[1], v[2], 0};
    const Vec3 s = shading(scene, v);
    const Vec3 tint = colored(s);
    for (int c = 0; c < 3; ++c) {
      energy.data +=
          params.lambda_data * squared(scene.image.data[n][c] - std::exp(v[c]) * s[c]);  // (5.4)
      energy.clustering += params.lambda_clustering * scene.targets.data[n][3] *
                           squared(v[c] - scene.targets.data[n][c]);                        // (5.6)
      energy.monochrome += params.lambda_monochrome * scene.retinex[n] * squared(tint[c]);  // (5.9)
    }
    for (std::size_t k = 3; k < x.unknowns; ++k) {
      if (k > 3) energy.i_sparsity += params.lambda_i_sparsity * smooth_abs(v[k], params.epsilon);
      energy.non_negativity +=
          params.lambda_non_negativity * negativity(v[k], params.epsilon);  // (5.13)
    }
  }
  for_each_edge(x.width, x.height, [&](std::size_t a, std::size_t b, int) {
    const double* va = x.at(a);
    const double* vb = x.at(b);
    // (5.7): both pixels of an edge are the other's neighbor.
    energy.r_sparsity +=
        2 * params.lambda_r_sparsity *
        (std::pow(r_difference2(va, vb) + squared(params.epsilon_r), params.p / 2) -
         std::pow(params.epsilon_r, params.p));
    for (std::size_t k = 3; k < x.unknowns; ++k) {
      energy.smoothness +=
          params.lambda_smoothness * smooth_abs(va[k] - vb[k], params.epsilon);  // (5.12)
    }
  });
  energy.r_consistency = thesis_energy(scene.sampling, r, Plane(), samples.frames, 0, samples.epoch,
                                       sampling_params(params))
                             .non_local;  // (3.12)
  return energy;
}

GlobalSystem assemble(const GlobalThesisScene& scene, const GlobalField& x,
                      const GlobalSamples& samples, const GlobalThesisParams& params) {
  const std::size_t layers = scene.layers();
  GlobalSystem system;
  system.scene = &scene;
  system.lambda_data = params.lambda_data;
  system.reflectance.resize(x.pixels());
  system.product.resize(x.pixels());
  system.monochrome.resize(x.pixels());
  system.weight.resize(x.pixels());
  for (GlobalField* field : {&system.local, &system.right, &system.down, &system.b}) {
    *field = GlobalField(x.width, x.height, layers);
  }
  const SourcePlane drawn =
      draw_samples(scene.sampling, samples.frames, 0, samples.epoch, sampling_params(params));
  for (std::size_t n = 0; n < x.pixels(); ++n) {
    const double* v = x.at(n);
    double* b = system.b.at(n);
    double* local = system.local.at(n);
    const Vec4& target = scene.targets.data[n];
    const Vec3 s = shading(scene, v);
    const Vec3 tint = colored(s);
    const double clustering = params.lambda_clustering * target[3];
    system.monochrome[n] = params.lambda_monochrome * scene.retinex[n];
    system.weight[n] = clustering + drawn.data[n][3];
    for (std::size_t k = 3; k < x.unknowns; ++k) {
      if (k > 3) local[k] = params.lambda_i_sparsity * abs_weight(v[k], params);
      local[k] += params.lambda_non_negativity * negativity_weight(v[k], params);
      b[k] = -local[k] * v[k];
    }
    for (int c = 0; c < 3; ++c) {
      const double reflectance = std::exp(v[c]);
      system.reflectance[n][c] = reflectance;
      system.product[n][c] = reflectance * s[c];
      const double e = scene.image.data[n][c] - reflectance * s[c];
      b[c] = params.lambda_data * e * reflectance * s[c] + clustering * (target[c] - v[c]) +
             drawn.data[n][c] - drawn.data[n][3] * v[c];
      const double shading = params.lambda_data * e * reflectance - system.monochrome[n] * tint[c];
      b[3] += shading;
      for (std::size_t k = 0; k < layers; ++k) b[4 + k] += scene.colors[k][c] * shading;
    }
  }
  for_each_edge(x.width, x.height, [&](std::size_t n, std::size_t m, int down) {
    double* weight = (down ? system.down : system.right).at(n);
    const double* a = x.at(n);
    const double* o = x.at(m);
    const double edge = 2 * params.lambda_r_sparsity * irls_factor(params.p, params) *
                        std::pow(r_difference2(a, o) + squared(params.epsilon_r), params.p / 2 - 1);
    for (std::size_t k = 0; k < x.unknowns; ++k) {
      weight[k] = k < 3 ? edge : params.lambda_smoothness * abs_weight(a[k] - o[k], params);
      system.b.at(n)[k] -= weight[k] * (a[k] - o[k]);
      system.b.at(m)[k] += weight[k] * (a[k] - o[k]);
    }
  });
  return system;
}

void apply(const GlobalSystem& system, const GlobalField& v, GlobalField* out) {
  const GlobalThesisScene& scene = *system.scene;
  for (std::size_t n = 0; n < v.pixels(); ++n) {
    const double* d = v.at(n);
    double* q = out->at(n);
    const Vec3 ds = shading(scene, d);
    const Vec3 tint = colored(ds);
    for (std::size_t k = 3; k < v.unknowns; ++k) q[k] = system.local.at(n)[k] * d[k];
    for (int c = 0; c < 3; ++c) {
      // Minus the change of the data residual.
      const double change = system.product[n][c] * d[c] + system.reflectance[n][c] * ds[c];
      q[c] = system.lambda_data * system.product[n][c] * change + system.weight[n] * d[c];
      const double force =
          system.lambda_data * system.reflectance[n][c] * change + system.monochrome[n] * tint[c];
      q[3] += force;
      for (std::size_t k = 0; k < scene.layers(); ++k) q[4 + k] += scene.colors[k][c] * force;
    }
  }
  for_each_edge(v.width, v.height, [&](std::size_t n, std::size_t m, int down) {
    const double* weight = (down ? system.down : system.right).at(n);
    for (std::size_t k = 0; k < v.unknowns; ++k) {
      const double flow = weight[k] * (v.at(n)[k] - v.at(m)[k]);
      out->at(n)[k] += flow;
      out->at(m)[k] -= flow;
    }
  });
}

GlobalField diagonal(const GlobalSystem& system) {
  const GlobalThesisScene& scene = *system.scene;
  GlobalField result = system.local;
  for (std::size_t n = 0; n < result.pixels(); ++n) {
    double* d = result.at(n);
    for (int c = 0; c < 3; ++c) {
      const double data = system.lambda_data * squared(system.reflectance[n][c]);
      d[c] = system.lambda_data * squared(system.product[n][c]) + system.weight[n];
      d[3] += data;
      for (std::size_t k = 0; k < scene.layers(); ++k) {
        d[4 + k] += data * squared(scene.colors[k][c]) +
                    system.monochrome[n] * squared(colored(scene.colors[k])[c]);
      }
    }
  }
  for_each_edge(result.width, result.height, [&](std::size_t n, std::size_t m, int down) {
    const double* weight = (down ? system.down : system.right).at(n);
    for (std::size_t k = 0; k < result.unknowns; ++k) {
      result.at(n)[k] += weight[k];
      result.at(m)[k] += weight[k];
    }
  });
  return result;
}

double sparsity_score(const GlobalField& x, const std::vector<std::uint8_t>& region) {
  double score = 0;
  for (std::size_t n = 0; n < x.pixels(); ++n) {
    if (!region[n]) continue;
    for (std::size_t k = 4; k < x.unknowns; ++k) score += std::abs(x.at(n)[k]);
  }
  return score;
}

}  // namespace inverse::reference

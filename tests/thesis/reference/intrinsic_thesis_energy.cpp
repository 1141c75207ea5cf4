// SPDX-License-Identifier: LGPL-2.1-or-later
#include "intrinsic_thesis_energy.hpp"

#include <algorithm>
#include <cmath>

#include "tests/reference/random.hpp"

namespace inverse::reference {
namespace {

/// ω_c of (3.5), ITU-R BT.601; (4.4) has none.
Vec3 channel_weight(const ThesisParams& params) {
  return params.chapter4 ? Vec3{1, 1, 1} : Vec3{0.299, 0.587, 0.114};
}

/// ω_l, the weight of data, smooth shading and chromaticity at a pixel: ω_iw of (3.5) and (3.11);
/// (4.4) and (4.5) have none.
double local_weight(const ThesisLevel& level, std::size_t pixel, const ThesisParams& params) {
  return params.chapter4 ? 1 : level.log_image.data[pixel][3];
}

double mean(const Vec4& v) { return (v[0] + v[1] + v[2]) / 3; }

double squared_distance(const Vec4& a, const Vec4& b) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
  return sum;
}

/// (3.19) with the factor p/2 that makes it a majorizer, or as printed.
double irls_weight(double squared, const ThesisParams& params) {
  const double factor = params.consistent_irls ? params.p / 2 : 1;
  return factor * std::pow(squared + params.epsilon * params.epsilon, params.p / 2 - 1);
}

double shading_weight(const ThesisSystem& system, std::size_t pixel) {
  return system.shading_weight.empty() ? 0 : system.shading_weight[pixel];
}

/// Calls f(frame, index, agree) for every sample of a pixel.
template <typename F>
void for_each_sample(const ThesisLevel& level, const std::vector<const SampleFrame*>& frames,
                     std::size_t pixel, std::uint32_t stream, std::uint32_t epoch,
                     const ThesisParams& params, F f) {
  const auto width = static_cast<std::uint32_t>(level.image.width);
  const auto height = static_cast<std::uint32_t>(level.image.height);
  const double own = level.packed[pixel];
  const double own_red = std::floor(own / 4096);
  const double own_blue = own - own_red * 4096;
  const double threshold = params.tau_cc * 4095 / 3;
  for (int i = 0; i < params.samples; ++i) {
    const auto random =
        pcg3d(static_cast<std::uint32_t>(pixel), static_cast<std::uint32_t>(i) + stream * 256u,
              params.seed + epoch * 0x9E3779B9u);
    const std::uint32_t x = random_below(random[0], width);
    const std::uint32_t y = random_below(random[1], height);
    const std::uint32_t frame = random_below(random[2], static_cast<std::uint32_t>(frames.size()));
    const std::size_t index = static_cast<std::size_t>(y) * width + x;
    const Vec4& sample = frames[frame]->data[index];
    const double red = std::floor(sample[3] / 4096) - own_red;
    const double blue = sample[3] - std::floor(sample[3] / 4096) * 4096 - own_blue;
    const double green = -(red + blue);
    const bool agree = red * red + green * green + blue * blue < threshold * threshold;
    f(sample, agree);
  }
}

}  // namespace

double finite_light(double value) {
  if (std::isnan(value)) return 0;
  if (std::isinf(value)) return value > 0 ? 1 : 0;
  return std::clamp(value, 0.0, 65504.0);
}

ThesisLevel::ThesisLevel(const Plane& linear, const ThesisParams& params)
    : image(linear),
      log_image(linear.width, linear.height),
      chromaticity(linear.width, linear.height),
      edges(linear.width, linear.height) {
  for (std::size_t n = 0; n < image.size(); ++n) {
    const Vec4& value = image.data[n];
    const double intensity = std::clamp(mean(value), 0.0, 1.0);
    const double chroma_mean = mean(value) + params.chroma_floor;
    for (int c = 0; c < 3; ++c) {
      log_image.data[n][c] = std::log(std::max(value[c], params.log_floor));
      chromaticity.data[n][c] = (value[c] + params.chroma_floor) / chroma_mean;
    }
    log_image.data[n][3] = 1 - params.w_intensity * (1 - intensity);  // (3.6)
    chromaticity.data[n][3] = intensity;
    packed.push_back(pack_chromaticity(chromaticity.data[n]));
  }
  const auto link = [&](std::size_t a, std::size_t b, int slot) {
    const double distance = std::sqrt(squared_distance(chromaticity.data[a], chromaticity.data[b]));
    const double cs = params.w_cs * std::exp(-params.alpha_cs * distance);  // (3.7)
    const double both = local_weight(*this, a, params) + local_weight(*this, b, params);
    edges.data[a][slot] = 2 * params.w_reflectance * cs;           // (3.8), both directions
    edges.data[a][slot + 2] = params.w_shading * both * (1 - cs);  // (3.9), (3.11)
  };
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const std::size_t here = image.index(x, y);
      if (x + 1 < image.width) link(here, here + 1, 0);
      if (y + 1 < image.height) link(here, image.index(x, y + 1), 1);
    }
  }
}

double pack_chromaticity(const Vec4& chromaticity) {
  const double red = std::floor(chromaticity[0] * (4095.0 / 3) + 0.5);
  const double blue = std::floor(chromaticity[2] * (4095.0 / 3) + 0.5);
  return red * 4096 + blue;
}

SampleFrame make_sample_frame(const ThesisLevel& level, const Plane& x) {
  SampleFrame frame = x;
  for (std::size_t n = 0; n < frame.size(); ++n) {
    frame.data[n][3] = level.packed[n];
  }
  return frame;
}

SourcePlane draw_samples(const ThesisLevel& level, const std::vector<const SampleFrame*>& frames,
                         std::uint32_t stream, std::uint32_t epoch, const ThesisParams& params) {
  SourcePlane source(level.image.width, level.image.height);
  for (std::size_t n = 0; n < source.size(); ++n) {
    const double g = params.w_non_local * level.log_image.data[n][3];  // (3.13)
    for_each_sample(level, frames, n, stream, epoch, params, [&](const Vec4& sample, bool agree) {
      if (!agree) return;
      for (int c = 0; c < 3; ++c) source.data[n][c] += g * sample[c];
      source.data[n][3] += g;
    });
  }
  return source;
}

ThesisEnergy thesis_energy(const ThesisLevel& level, const Plane& x, const Plane& clusters,
                           const std::vector<const SampleFrame*>& frames, std::uint32_t stream,
                           std::uint32_t epoch, const ThesisParams& params) {
  ThesisEnergy energy;
  const Vec3 channel = channel_weight(params);
  const auto edge = [&](std::size_t a, std::size_t b, int slot) {
    const double squared = squared_distance(x.data[a], x.data[b]) + params.epsilon * params.epsilon;
    const double ds = x.data[a][3] - x.data[b][3];
    energy.reflectance += level.edges.data[a][slot] * std::pow(squared, params.p / 2);  // (3.8)
    energy.shading += level.edges.data[a][slot + 2] * ds * ds;                          // (3.9)
  };
  for (int row = 0; row < x.height; ++row) {
    for (int column = 0; column < x.width; ++column) {
      const std::size_t n = x.index(column, row);
      const Vec4& i = level.log_image.data[n];
      const Vec4& value = x.data[n];
      const double local = local_weight(level, n, params);
      Vec4 difference{};
      for (int c = 0; c < 3; ++c) difference[c] = i[c] - value[c];
      const double offset = mean(difference);
      for (int c = 0; c < 3; ++c) {
        const double residual = difference[c] - value[3];
        energy.data += params.w_data * local * channel[c] * residual * residual;  // (3.5), (4.4)
        const double chroma = difference[c] - offset;  // (3.10) in log form: P (i − r)
        energy.chromaticity += params.w_chromaticity * local * chroma * chroma;
      }
      if (column + 1 < x.width) edge(n, n + 1, 0);
      if (row + 1 < x.height) edge(n, x.index(column, row + 1), 1);
      const double g = params.w_non_local * i[3];
      for_each_sample(level, frames, n, stream, epoch, params, [&](const Vec4& sample, bool agree) {
        if (agree) energy.non_local += g * squared_distance(value, sample);  // (3.12)
      });
      if (clusters.size() != 0) {
        energy.clustering += clusters.data[n][3] * squared_distance(value, clusters.data[n]);
      }
    }
  }
  return energy;
}

std::vector<Vec4> stroke_means(const StrokeMask& strokes, const Plane& x) {
  std::vector<Vec4> means(strokes.kinds.size(), Vec4{});
  std::vector<double> weights(means.size());
  for (std::size_t n = 0; n < x.size(); ++n) {
    if (strokes.stroke[n] < 0) continue;
    const auto k = static_cast<std::size_t>(strokes.stroke[n]);
    for (int c = 0; c < 4; ++c) means[k][c] += strokes.weight[n] * x.data[n][c];
    weights[k] += strokes.weight[n];
  }
  for (std::size_t k = 0; k < means.size(); ++k) {
    for (double& value : means[k]) value = weights[k] > 0 ? value / weights[k] : 0;
  }
  return means;
}

double user_energy(const StrokeMask& strokes, const std::vector<Vec4>& means, const Plane& x) {
  double energy = 0;
  for (std::size_t n = 0; n < x.size(); ++n) {
    if (strokes.stroke[n] < 0) continue;
    const auto k = static_cast<std::size_t>(strokes.stroke[n]);
    const double ds = x.data[n][3] - means[k][3];
    energy +=
        kUserWeight * strokes.weight[n] *
        (strokes.kinds[k] == StrokeKind::shading ? ds * ds : squared_distance(x.data[n], means[k]));
  }
  return energy;
}

void add_strokes(const StrokeMask& strokes, const std::vector<Vec4>& means, SourcePlane* source,
                 ShadingSource* shading) {
  shading->target.resize(source->size());
  shading->weight.resize(source->size());
  for (std::size_t n = 0; n < source->size(); ++n) {
    if (strokes.stroke[n] < 0) continue;
    const auto k = static_cast<std::size_t>(strokes.stroke[n]);
    const double weight = kUserWeight * strokes.weight[n];
    if (strokes.kinds[k] == StrokeKind::shading) {
      shading->target[n] += weight * means[k][3];
      shading->weight[n] += weight;
    } else {
      for (int c = 0; c < 3; ++c) source->data[n][c] += weight * means[k][c];
      source->data[n][3] += weight;
    }
  }
}

double stabilization_energy(const Plane& known, double weight, const Plane& x) {
  double energy = 0;
  for (std::size_t n = 0; n < known.size(); ++n) {
    Vec4 target = known.data[n];
    if (!(target[3] > 0)) continue;
    for (int c = 0; c < 3; ++c) target[c] /= target[3];
    energy += weight * target[3] * squared_distance(x.data[n], target);
  }
  return energy;
}

void add_known(const Plane& known, double weight, SourcePlane* source) {
  for (std::size_t n = 0; n < known.size(); ++n)
    for (int c = 0; c < 4; ++c) source->data[n][c] += weight * known.data[n][c];
}

ThesisSystem assemble(const ThesisLevel& level, const Plane& x, const SourcePlane& source,
                      const ThesisParams& params, const ShadingSource& shading) {
  ThesisSystem system;
  system.edges = Plane(x.width, x.height);
  system.node = Plane(x.width, x.height);
  system.b = Plane(x.width, x.height);
  system.shading_weight = shading.weight;
  system.w_data = params.w_data;
  system.w_chromaticity = params.w_chromaticity;
  system.channel_weight = channel_weight(params);
  const auto link = [&](std::size_t a, std::size_t b, int slot) {
    const double weight = irls_weight(squared_distance(x.data[a], x.data[b]), params);
    Vec4& edge = system.edges.data[a];
    edge[slot] = level.edges.data[a][slot] * weight;
    edge[slot + 2] = level.edges.data[a][slot + 2];
    for (const std::size_t end : {a, b}) {
      system.node.data[end][2] += edge[slot];
      system.node.data[end][3] += edge[slot + 2];
    }
  };
  for (int row = 0; row < x.height; ++row) {
    for (int column = 0; column < x.width; ++column) {
      const std::size_t n = x.index(column, row);
      if (column + 1 < x.width) link(n, n + 1, 0);
      if (row + 1 < x.height) link(n, x.index(column, row + 1), 1);
      const Vec4& i = level.log_image.data[n];
      const double local = local_weight(level, n, params);
      const double m = mean(i);
      system.node.data[n][0] = local;
      system.node.data[n][1] = source.data[n][3];
      Vec4& b = system.b.data[n];
      for (int c = 0; c < 3; ++c) {
        b[c] = params.w_data * local * system.channel_weight[c] * i[c] +
               params.w_chromaticity * local * (i[c] - m) + source.data[n][c];
        b[3] += params.w_data * local * system.channel_weight[c] * i[c];
      }
      if (!shading.target.empty()) b[3] += shading.target[n];
    }
  }
  return system;
}

void apply(const ThesisSystem& system, const Plane& v, int x0, int y0, int x1, int y1, Plane* out) {
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      const std::size_t n = v.index(x, y);
      const Vec4& node = system.node.data[n];
      const Vec4& own = v.data[n];
      const double data = system.w_data * node[0];
      const double chroma = system.w_chromaticity * node[0];
      const double m = mean(own);
      Vec4 result{};
      for (int c = 0; c < 3; ++c) {
        const double residual = data * system.channel_weight[c] * (own[c] + own[3]);
        result[c] = residual + (node[1] + node[2]) * own[c] + chroma * (own[c] - m);
        result[3] += residual;
      }
      result[3] += (node[3] + shading_weight(system, n)) * own[3];
      const auto subtract = [&](std::size_t edge, int slot, std::size_t other) {
        const double a = system.edges.data[edge][slot];
        for (int c = 0; c < 3; ++c) result[c] -= a * v.data[other][c];
        result[3] -= system.edges.data[edge][slot + 2] * v.data[other][3];
      };
      const auto stride = static_cast<std::size_t>(v.width);
      if (x + 1 < x1) subtract(n, 0, n + 1);
      if (x > x0) subtract(n - 1, 0, n - 1);
      if (y + 1 < y1) subtract(n, 1, n + stride);
      if (y > y0) subtract(n - stride, 1, n - stride);
      out->data[n] = result;
    }
  }
}

Vec4 diagonal(const ThesisSystem& system, std::size_t pixel) {
  const Vec4& node = system.node.data[pixel];
  Vec4 result{};
  for (int c = 0; c < 3; ++c) {
    result[c] = system.w_data * node[0] * system.channel_weight[c] + node[1] + node[2] +
                system.w_chromaticity * node[0] * (2.0 / 3);
    result[3] += system.w_data * node[0] * system.channel_weight[c];
  }
  result[3] += node[3] + shading_weight(system, pixel);
  return result;
}

}  // namespace inverse::reference

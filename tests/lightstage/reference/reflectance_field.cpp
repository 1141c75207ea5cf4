// SPDX-License-Identifier: LGPL-2.1-or-later
#include "reflectance_field.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace inverse::reference {
namespace {

double given(const Vec3& u, const Vec3& w, double p) {
  const double cosine = dot(u, w);
  return cosine > 0 ? std::pow(cosine, p) : 0;
}

}  // namespace

Vec3 mean_direction(const Vec3& a, const Vec3& b, double noise) {
  Vec3 m{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double f = a[c] + b[c];
    m[c] = (a[c] - b[c]) * f / (f * f + noise * noise);
  }
  const double length = std::sqrt(dot(m, m));
  if (length > 1)
    for (double& x : m) x /= length;
  return m;
}

Vec3 seen_mean(const Vec3& v, const Stage& stage) {
  const double size = std::sqrt(dot(v, v)), count = static_cast<double>(stage.lights.size());
  Vec3 mean{};
  for (const Vec3& w : stage.lights)
    for (std::size_t k = 0; k < 3; ++k) mean[k] += w[k] / count;
  if (size < 1e-9) return mean;
  const CosineLobe lobe = lobe_of({1, 1, 1}, v, stage);
  Vec3 moment{};
  double sum = 0;
  for (const Vec3& w : stage.lights) {
    const double g = given(lobe.direction, w, lobe.exponent);
    sum += g;
    for (std::size_t k = 0; k < 3; ++k) moment[k] += g * w[k];
  }
  const double known = std::min(1.0, sum / (0.25 * count / (2 * (lobe.exponent + 1))));
  const double even = (lobe.exponent + 1) / (lobe.exponent + 2);
  Vec3 result{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double seen = sum > 0 ? moment[k] / sum : 0;
    result[k] = (1 - lobe.share) * mean[k] +
                lobe.share * (known * seen + (1 - known) * even * lobe.direction[k]);
    const double limit = (stage.largest_exponent + 1) / (stage.largest_exponent + 2);
    result[k] += lobe.direction[k] * std::max(0.0, size - limit);
  }
  return result;
}

CosineLobe lobe_of(const Vec3& full, const Vec3& v, const Stage& stage) {
  const double size = std::sqrt(dot(v, v));
  CosineLobe lobe;
  lobe.full = full;
  lobe.direction = size > 1e-6 ? Vec3{v[0] / size, v[1] / size, v[2] / size} : Vec3{0, 0, 1};
  lobe.share = std::min(1.0, 2 * size);
  // |v| = (p + 1) / (p + 2)
  lobe.exponent = size <= 0.5 ? 0 : size >= 1 ? 1e9 : (2 * size - 1) / (1 - size);
  lobe.exponent = std::min(lobe.exponent, stage.largest_exponent);
  return lobe;
}

double lobe_sum(const Vec3& u, double p, const Stage& stage) {
  double sum = 0;
  for (const Vec3& w : stage.lights) sum += given(u, w, p);
  return std::max(sum, 0.25 * static_cast<double>(stage.lights.size()) / (2 * (p + 1)));
}

Vec3 relit(const CosineLobe& lobe, const std::vector<Lamp>& lamps, const Stage& stage) {
  const double s = lobe_sum(lobe.direction, lobe.exponent, stage);
  Vec3 result{};
  for (const Lamp& lamp : lamps) {
    const double directed = given(lobe.direction, lamp.direction, lobe.exponent) / s;
    const double even = 1 / static_cast<double>(stage.lights.size());
    for (std::size_t c = 0; c < 3; ++c)
      result[c] +=
          lobe.full[c] * lamp.weight[c] * ((1 - lobe.share) * even + lobe.share * directed);
  }
  return result;
}

Measured measured_light(const std::vector<Lamp>& lamps) {
  Measured result;
  for (std::size_t c = 0; c < 3; ++c) {
    double mean = 0;
    for (const Lamp& lamp : lamps)
      mean += std::abs(lamp.weight[c]) / static_cast<double>(lamps.size());
    if (mean == 0) continue;
    Eigen::Vector4d plane = Eigen::Vector4d::Zero();
    for (int step = 0; step < 20; ++step) {
      Eigen::Matrix4d a = Eigen::Matrix4d::Zero();
      Eigen::Vector4d b = Eigen::Vector4d::Zero();
      for (const Lamp& lamp : lamps) {
        const Eigen::Vector4d x{1, lamp.direction[0], lamp.direction[1], lamp.direction[2]};
        const double away = lamp.weight[c] - plane.dot(x);
        const double trust =
            step == 0 ? 1 : std::pow(std::max(std::abs(away) / mean, 0.02), 1.4 - 2);
        a += trust * x * x.transpose();
        b += trust * lamp.weight[c] * x;
      }
      a.diagonal().array() += 1e-9 * a.trace();
      plane = a.llt().solve(b);
    }
    if (plane.lpNorm<Eigen::Infinity>() < 1e-2 * mean) continue;
    result.even[c] = plane[0];
    for (std::size_t k = 0; k < 3; ++k) result.along[k][c] = (k == c ? 1 : 0.7) * plane[k + 1];
  }
  return result;
}

Vec3 measured_picture(const Measured& light, const Vec3& a, const Vec3& b, double noise) {
  Vec3 m{}, result{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double full = a[k] + b[k];
    m[k] = (a[k] - b[k]) * full / (full * full + noise * noise);
  }
  for (std::size_t c = 0; c < 3; ++c) {
    double sum = light.even[c];
    for (std::size_t k = 0; k < 3; ++k) sum += light.along[k][c] * m[k];
    result[c] = (a[c] + b[c]) * sum;
  }
  return result;
}

Plane network_light(const RelightModels& models, const Plane& a, const Plane& b,
                    const Vec3& light) {
  const auto width = static_cast<uint32_t>(a.width), height = static_cast<uint32_t>(a.height);
  Image input{{6, height, width}, std::vector<double>(a.size() * 6)};
  Plane root(a.width, a.height), result(a.width, a.height);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const double full = std::max(0.0, a.data[i][c] + b.data[i][c]);
      root.data[i][c] = std::sqrt(full);
      input.data[c * a.size() + i] = root.data[i][c];
      input.data[(3 + c) * a.size() + i] = (a.data[i][c] - b.data[i][c]) / (full + 0.004);
    }
  const Image features = run_network(models.features, std::vector{input})[0];
  constexpr std::size_t kIn = RelightModels::kPlanes + RelightModels::kHarmonics;
  const auto& [x, y, z] = light;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::vector<double> u(kIn), out(RelightModels::kOut);
    for (std::size_t k = 0; k < RelightModels::kPlanes; ++k) {
      const auto f = [&](std::size_t n) { return features.data[(4 * k + n) * a.size() + i]; };
      u[k] = std::max(0.0, f(0) * x + f(1) * y + f(2) * z + f(3));
    }
    const double phi[] = {x, y, z, x * y, y * z, z * x, x * x - y * y, 3 * z * z - 1};
    std::copy(std::begin(phi), std::end(phi), u.begin() + RelightModels::kPlanes);
    for (std::size_t o = 0; o < RelightModels::kOut; ++o) out[o] = models.outer_bias[o];
    for (std::size_t j = 0; j < RelightModels::kHidden; ++j) {
      double v = models.inner_bias[j];
      for (std::size_t k = 0; k < kIn; ++k) v += models.inner[j * kIn + k] * u[k];
      for (std::size_t o = 0; o < RelightModels::kOut; ++o)
        out[o] += models.outer[o * RelightModels::kHidden + j] * std::max(0.0, v);
    }
    const Vec4& r = root.data[i];
    for (std::size_t c = 0; c < 3; ++c) {
      const double q = std::max(0.0, r[c] * out[c] + (r[0] + r[1] + r[2]) / 3 * out[3]);
      result.data[i][c] = q * q;
    }
  }
  return result;
}

}  // namespace inverse::reference

// SPDX-License-Identifier: LGPL-2.1-or-later
// A one-hidden-layer network with skip connections over planes of cues, and its gradient.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace inverse::training {

using Plane = std::vector<float>;

/// out = bias2 + skip f + outer softsign(bias1 + inner f). Parameters lie in one flat vector from
/// `offset`: inner (H x I), bias1 (H), outer (O x H), skip (O x I), bias2 (O).
struct Net {
  int inputs, hidden, outputs, offset;

  int count() const {
    return hidden * inputs + hidden + outputs * hidden + outputs * inputs + outputs;
  }
  int inner(int h, int i) const { return offset + h * inputs + i; }
  int bias1(int h) const { return offset + hidden * inputs + h; }
  int outer(int o, int h) const { return offset + hidden * (inputs + 1) + o * hidden + h; }
  int skip(int o, int i) const { return outer(outputs, 0) + o * inputs + i; }
  int bias2(int o) const { return skip(outputs, 0) + o; }

  /// `out`: as many planes as outputs.
  template <class Planes>
  void forward(const std::vector<float>& p, const std::vector<Plane>& f, std::vector<Plane>& mid,
               Planes& out) const {
    const int n = int(f[0].size());
    mid.assign(std::size_t(hidden), Plane(std::size_t(n)));
    for (Plane& plane : out) plane.assign(std::size_t(n), 0);
    for (int s = 0; s < n; s += kChunk) {
      const int e = std::min(n, s + kChunk);
      for (int h = 0; h < hidden; ++h) {
        float* a = mid[std::size_t(h)].data();
        std::fill(a + s, a + e, p[std::size_t(bias1(h))]);
        for (int i = 0; i < inputs; ++i)
          add(a, f[std::size_t(i)], p[std::size_t(inner(h, i))], s, e);
        for (int k = s; k < e; ++k) a[k] /= 1 + std::fabs(a[k]);
      }
      for (int o = 0; o < outputs; ++o) {
        float* a = out[std::size_t(o)].data();
        std::fill(a + s, a + e, p[std::size_t(bias2(o))]);
        for (int i = 0; i < inputs; ++i)
          add(a, f[std::size_t(i)], p[std::size_t(skip(o, i))], s, e);
        for (int h = 0; h < hidden; ++h)
          add(a, mid[std::size_t(h)], p[std::size_t(outer(o, h))], s, e);
      }
    }
  }

  /// Adds the gradient of the parameters to `gradient`, given that of the outputs.
  template <class Planes>
  void backward(const std::vector<float>& p, const std::vector<Plane>& f,
                const std::vector<Plane>& mid, const Planes& d_out,
                std::vector<double>& gradient) const {
    const int n = int(f[0].size());
    Plane d(kChunk);
    for (int s = 0; s < n; s += kChunk) {
      const int e = std::min(n, s + kChunk);
      for (int o = 0; o < outputs; ++o) {
        const float* g = d_out[std::size_t(o)].data() + s;
        for (int k = s; k < e; ++k) gradient[std::size_t(bias2(o))] += g[k - s];
        for (int i = 0; i < inputs; ++i)
          gradient[std::size_t(skip(o, i))] += dot(g, f[std::size_t(i)], s, e);
        for (int h = 0; h < hidden; ++h)
          gradient[std::size_t(outer(o, h))] += dot(g, mid[std::size_t(h)], s, e);
      }
      for (int h = 0; h < hidden; ++h) {
        std::fill(d.begin(), d.end(), 0.0F);
        for (int o = 0; o < outputs; ++o) {
          const float w = p[std::size_t(outer(o, h))];
          for (int k = s; k < e; ++k)
            d[std::size_t(k - s)] += w * d_out[std::size_t(o)][std::size_t(k)];
        }
        for (int k = s; k < e; ++k) {
          const float q =
              1 - std::fabs(mid[std::size_t(h)][std::size_t(k)]);  // softsign' = (1 - |y|)^2
          d[std::size_t(k - s)] *= q * q;
          gradient[std::size_t(bias1(h))] += d[std::size_t(k - s)];
        }
        for (int i = 0; i < inputs; ++i)
          gradient[std::size_t(inner(h, i))] += dot(d.data(), f[std::size_t(i)], s, e);
      }
    }
  }

 private:
  static constexpr int kChunk = 512;
  static void add(float* a, const Plane& x, float w, int s, int e) {
    for (int k = s; k < e; ++k) a[k] += w * x[std::size_t(k)];
  }
  static float dot(const float* g, const Plane& x, int s, int e) {
    float sum = 0;
    for (int k = s; k < e; ++k) sum += g[k - s] * x[std::size_t(k)];
    return sum;
  }
};

}  // namespace inverse::training

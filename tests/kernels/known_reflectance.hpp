// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <limits>
#include <random>

#include "kernels/camera/known_reflectance.hpp"
#include "tests/lab.hpp"
#include "tests/reference/intrinsic/recall.hpp"

namespace inverse::testing {

struct Known {
  reference::KnownReflectance expected;
  KnownReflectance given;
};

/// Something known, part of it nearer or farther than the frame, or unknown, or of another color.
/// `extreme`: with numbers as broken data have them.
inline Known known_of(const Lab& lab, Extent extent, unsigned seed, float weight,
                      bool extreme = false) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  Known known{{int(extent.width), int(extent.height), {}, {}, {}, {}, double{weight}}, {}};
  Pixels reflectance, depth, known_depth;
  for (size_t i = 0; i < extent.pixels(); ++i) {
    const float z = 0.5F + 3 * unit(random), kind = unit(random);
    depth.push_back(kind < 0.1F ? 0 : z);
    known_depth.push_back(kind > 0.9F ? 0 : kind > 0.8F ? z + 0.5F : z + 0.004F * unit(random));
    for (int c = 0; c < 3; ++c) reflectance.push_back(-3 * unit(random));
    reflectance.push_back(kind > 0.5F && kind < 0.6F ? 0 : unit(random));
    if (extreme && i % 7 == 0) {
      const float nan = std::numeric_limits<float>::quiet_NaN();
      for (size_t c = 0; c < 3; ++c) reflectance[4 * i + c] = i % 2 ? nan : 1e30F;
      reflectance[4 * i + 3] = 0;
      depth[i] = i % 3 ? 1e30F : 65.534F;
    }
    for (size_t c = 0; c < 3; ++c)
      known.expected.log_reflectance.push_back(double{reflectance[4 * i + c]});
    known.expected.confidence.push_back(double{reflectance[4 * i + 3]});
  }
  known.expected.depth.assign(depth.begin(), depth.end());
  known.expected.known_depth.assign(known_depth.begin(), known_depth.end());
  const auto scalars = [&](const Pixels& values) {
    auto buffer =
        gpu::Buffer::create(lab.device(), gpu::Element::scalar, values.size(), gpu::Memory::upload);
    memcpy(buffer->map(), values.data(), values.size() * sizeof(float));
    return buffer;
  };
  known.given = {extent,         lab.upload(reflectance),  scalars(known_depth),
                 scalars(depth), lab.upload({1, 0, 0, 0}), weight};
  return known;
}

}  // namespace inverse::testing

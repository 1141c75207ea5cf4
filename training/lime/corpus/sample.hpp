// SPDX-License-Identifier: LGPL-2.1-or-later
// One training image with everything that made it.
#pragma once

#include <cstdint>
#include <vector>

#include "hdri.hpp"

namespace inverse::lime {

enum class Split { train, test };

/// What to render. Sample (seed, index) of a split is always the same.
struct Request {
  std::uint64_t seed = 0, index = 0;
  Split split = Split::train;
  int size = 128;  ///< Pixels on a side.
  bool clean =
      false;  ///< No lens blur and no sensor noise: the linear image is exactly ma + md D + ms S.
  /// As where an object is looked for in a whole frame: every seventh image shows none, a third
  /// of the objects are small, a fifth so large that the frame cuts them, many stand before
  /// something plain or black and throw a shadow, the camera's exposure and white balance may be
  /// off, and half of the frames are wider or higher than the square.
  bool whole_frame = false;
  bool may_be_painted = false;  ///< Every fourth object has paint of several colors.
  /// As many things in use are: three in ten are white, gray or black or nearly so, which uniform
  /// in YUV is seldom, and every fourth bears sharp-edged marks, many of them white. Of both 40 %
  /// are matte (alpha and m_s are 0, and their shininess says nothing), of the others an eighth.
  bool everyday = false;
};

/// Material and circumstances; the order of these floats is the C interface's.
struct Parameters {
  float diffuse[3];  ///< m_d, linear RGB, uniform in YUV but for pale ones; of painted objects the
                     ///< mean.
  float alpha;       ///< Specular albedo before the lobe's normalization, 0.03 … 0.9; 0: matte.
  float shininess;   ///< s, log-uniform in its bin.
  float bin;         ///< 0 … 7 of the edges 2^(1 + 9 b / 8).
  float ambient;     ///< m_a.
  float specular;    ///< m_s = alpha · (s + 8) / 16 for s > 8, else alpha.
  float exposure;    ///< k, already multiplied into D, S and M.
  float family, trait;  ///< Of the shape (shapes.hpp).
  float map;            ///< Index into the maps; −1: a room.
  float empty;          ///< 1: no object.
};
constexpr int kParameters = sizeof(Parameters) / sizeof(float);

/// Planar images, channels × size × size, rows from the top. D, S and M are zero where coverage is.
struct Images {
  std::uint8_t* image;     ///< 3: sRGB, 8 bit, the object over a background.
  std::uint8_t* coverage;  ///< 1: 255 × the share of the pixel that the object covers.
  float* diffuse;          ///< 3: D, linear, exposed; of painted objects times albedo over m_d.
  float* specular;         ///< 3: S, linear, exposed.
  float* mirror;           ///< 3: M = k E(reflected view), linear.
};

void render(const Request& request, const std::vector<NamedMap>& maps, const Images& images,
            Parameters& parameters);

}  // namespace inverse::lime

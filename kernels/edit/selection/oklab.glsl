// SPDX-License-Identifier: LGPL-2.1-or-later
// Oklab (Bjorn Ottosson, A perceptual color space for image processing, 2020) of linear RGB with sRGB's primaries, at least 0.
vec3 oklab(vec3 rgb) {
  vec3 cones = mat3(0.4122214708, 0.2119034982, 0.0883024619, 0.5363325363, 0.6806995451, 0.2817188376, 0.0514459929, 0.1073969566,
                    0.6299787005) * rgb;
  cones = pow(max(cones, vec3(1e-12)), vec3(1.0 / 3.0));
  return mat3(0.2104542553, 1.9779984951, 0.0259040371, 0.7936177850, -2.4285922050, 0.7827717662, -0.0040720468, 0.4505937099,
              -0.8086757660) * cones;
}

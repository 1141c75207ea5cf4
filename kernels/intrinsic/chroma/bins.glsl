// SPDX-License-Identifier: LGPL-2.1-or-later
// The chroma grid of the non-local term: kBins x kBins bins of kBinWidth over (c0, c1), bilinear hats. Sums are in fixed point of
// 64 bits, so that they do not depend on order, and cells of little weight count in frames of any size: weights in steps of 1 / scale,
// weighted (r / kMaxReflectance + 1) / 2 likewise. A table of sums is all low words, then all high words.
const int kBins = 48;
const float kBinWidth = 0.1;
const float kMaxReflectance = 16.0;  // |m - s| beyond this counts as this
const float kEmptyBin = 1e30;         // mean of an empty bin

// The lower left of the four bins around a chroma, and the distance from it in bins.
uvec2 bin_of(vec2 chroma, out vec2 fraction) {
  vec2 place = clamp(chroma / kBinWidth + float(kBins / 2), vec2(0.0), vec2(float(kBins) - 1.001));
  uvec2 bin = uvec2(place);
  fraction = place - vec2(bin);
  return bin;
}
vec4 hats(vec2 fraction) {
  return vec4((1.0 - fraction.x) * (1.0 - fraction.y), fraction.x * (1.0 - fraction.y),
              (1.0 - fraction.x) * fraction.y, fraction.x * fraction.y);
}

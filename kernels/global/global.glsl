// Light on the small grid and at pixels (docs/method-globalintrinsic.md). Log chroma: coordinates of ln RGB along (1, -1, 0) / √2
// and (1, 1, -2) / √6.
const float kU = 0.70710678, kV = 0.40824829;
const float kDarkest = 3e-3;    // added before logarithms: black becomes neutral
const float kFloor = 2e-3;      // as in guide.glsl: of m
const float kBrightest = 0.9;   // what the largest channel of every albedo is taken for at first
const float kMostLight = 1e4;
const uint kSlots = 16u;        // base colors at most
const uint kSide = 64u;         // bins of the chroma histogram along either axis
const uint kBins = kSide * kSide;
const float kBinWidth = 0.08;
const uint kCandidates = 16u;   // amounts
const float kLeastAmount = 0.06, kAmountRatio = 1.24;

vec3 sanitize(vec3 rgb) {
  return mix(vec3(0.0), mix(min(rgb, kMostLight), vec3(1.0), isinf(rgb)), greaterThan(rgb, vec3(0.0)));
}
float mean_of(vec3 rgb) { return (rgb.r + rgb.g + rgb.b) / 3.0; }
float brightest_of(vec3 rgb) { return max(max(rgb.r, rgb.g), rgb.b); }

vec2 chroma_of(vec3 rgb) {
  vec3 light = rgb + kDarkest;
  return vec2(kU * log(light.r / light.g), kV * log(light.r * light.g / (light.b * light.b)));
}
vec3 color_of(vec2 chroma) {
  float u = kU * chroma.x, v = kV * chroma.y;
  return exp(vec3(u + v, v - u, -2.0 * v));
}

// Light of mean `shading` as a white direct part (x of the result) and an indirect one, at most all; .y is its share.
vec2 split_light(float shading, inout vec3 indirect) {
  float all = mean_of(indirect), k = all > shading ? shading / all : 1.0;
  indirect *= k;
  return vec2(max(shading - k * all, 0.0), min(all / max(shading, 1e-6), 1.0));
}
// Its log chroma, and that share in z.
vec3 tint_of(float shading, vec3 indirect) {
  vec2 part = split_light(shading, indirect);
  return vec3(chroma_of(part.x + indirect), part.y);
}

float candidate(uint i) { return kLeastAmount * pow(kAmountRatio, float(i)); }

// The bin whose center is nearest.
uint bin_at(vec2 chroma) {
  uvec2 place = uvec2(clamp(floor(chroma / kBinWidth + 0.5 * float(kSide)), 0.0, float(kSide) - 1.0));
  return place.y * kSide + place.x;
}
// The lower left of the four bins around a chroma, and the shares of the four.
uint bins_around(vec2 chroma, out vec4 hats) {
  vec2 place = clamp(chroma / kBinWidth + 0.5 * float(kSide - 1u), 0.0, float(kSide) - 1.001);
  uvec2 bin = uvec2(place);
  vec2 f = place - vec2(bin);
  hats = vec4((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y);
  return bin.y * kSide + bin.x;
}
vec2 bin_center(uint bin) { return kBinWidth * (vec2(bin % kSide, bin / kSide) - 0.5 * float(kSide - 1u)); }

// Where a fine point lies between the points of a grid, `factor` fine ones wide: the four points around it and their shares.
ivec4 points_around(uvec2 fine, uint factor, uvec2 size, out vec4 shares) {
  vec2 at = clamp((vec2(fine) + 0.5) / float(factor) - 0.5, vec2(0.0), vec2(size) - 1.0);
  ivec2 low = ivec2(at), high = min(low + 1, ivec2(size) - 1);
  vec2 f = at - vec2(low);
  shares = vec4((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y);
  return ivec4(low.y * int(size.x) + ivec2(low.x, high.x), high.y * int(size.x) + ivec2(low.x, high.x));
}
#define BLEND(name, at, shares) \
  (shares.x * FETCH(name, at.x) + shares.y * FETCH(name, at.y) + shares.z * FETCH(name, at.z) + shares.w * FETCH(name, at.w))
#define MIXED(values, shares) \
  (shares.x * values[0] + shares.y * values[1] + shares.z * values[2] + shares.w * values[3])

uvec2 place_of(uint i, uint columns) { return uvec2(i % columns, i / columns); }

// The scene's numbers, vec4 each.
#define SCENE_STATE 0       // 1: nothing is taken over; mean weight; frames before this one; what a frame renews
#define SCENE_MEAN 1        // mean I
#define SCENE_AMOUNT 2      // kappa; confidence
#define SCENE_STATISTICS 3  // rms tint of all-indirect light; share of the residual
#define SCENE_SIZE 4

// How far a residual is believed.
float belief(vec2 residual, float fraction, float full) {
  float wide = 0.7 * full * fraction;
  return exp(-dot(residual, residual) / (2.0 * (0.35 * 0.35 + wide * wide)));
}

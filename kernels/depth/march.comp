// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/camera.glsl"
#include "camera/voxel.glsl"

// What a camera sees of the volume: the first place along each ray where the distance turns from positive to negative. One pixel an
// invocation.
WORD_IN(0, table);
WORD_IN(1, voxels);
WORD_IN(2, colors);
SCALAR_IN(3, start);      // of approach.comp
WORD_IN(4, farthest);
PLANE_IN(5, pose);
SCALAR_OUT(6, depth);       // meters along the optical axis; 0: nothing
PLANE_OUT(7, reflectance);  // rgb: ln reflectance; w: confidence, 0: unknown
WORD_OUT(8, strokes);       // of the nearest voxel
layout(push_constant) uniform Push {
  vec4 lens;
  uvec2 size;
  uint tiles;  // a row
  uint table_mask;
  float voxel;
  float truncation;
} push;
#include "camera/find_block.glsl"
#include "camera/distance.glsl"
#include "ray.glsl"

const int kRefinements = 2;

void main() {
  uint line = line_index();
  uvec2 pixel = uvec2(line % push.size.x, line / push.size.x);
  if (pixel.y >= push.size.y) return;
  float end = uintBitsToFloat(FETCH1(farthest, int((pixel.y >> 3) * push.tiles + (pixel.x >> 3))));
  // From where the first one of the rays around it came near a surface.
  uvec2 rays = (push.size + 1u) / 2u, low = pixel / 2u, high = min(low + 1u, rays - 1u);
  int above = int(low.y * rays.x), below = int(high.y * rays.x);
  float z = min(min(FETCH1(start, above + int(low.x)), FETCH1(start, above + int(high.x))),
                min(FETCH1(start, below + int(low.x)), FETCH1(start, below + int(high.x))));
  Ray ray = ray_through(push.lens, vec2(pixel), FETCH(pose, 0), FETCH(pose, 1));
  float before = 0.0, behind = 0.0, before_z = z, hit = 0.0;  // distances and depths on both sides of the surface
  for (uint i = 0u; i < kMaxSteps && z < end; ++i) {
    float step;
    Voxel v = voxel_at(ray, z, step);
    bool known = v.weight > 0.0;
    if (known && v.distance <= 0.0 && before > 0.0) {
      hit = z;
      behind = v.distance;
      break;
    }
    before = known ? max(v.distance, 0.0) : 0.0;  // 0: from behind, or from where nothing is known
    before_z = before > 0.0 ? z : before_z;
    z += step;
  }
  // Where the interpolated distance is zero: by secants, from where the line through both voxels is.
  float result = 0.0;
  vec4 color = vec4(0.0);
  uint stroke = 0u;
  if (hit > 0.0) {
    float slope = min((behind - before) / (hit - before_z), -0.2 / ray.truncation);
    result = before_z - before / slope;
    float off = 0.0, last = result;
    for (int i = 0; i < kRefinements; ++i) {
      float now = distance_at(ray.origin + result * ray.along);
      if (abs(now) > 1.0) break;
      float step = result - last, found = (now - off) / step;
      slope = i > 0 && abs(step) > 0.02 * ray.voxel && found * ray.truncation < -0.1 ? found : slope;
      last = result;
      off = now;
      result -= clamp(now / slope, -ray.voxel, ray.voxel);
    }
    vec3 at = ray.origin + result * ray.along;
    ivec3 voxel = ivec3(floor(at - 0.5));
    vec3 share = at - 0.5 - vec3(voxel);
    uint places[8] = corners(voxel);
    float total = 0.0, most = 0.0;
    uint place = 0u;
    for (uint n = 0u; n < 8u; ++n) {
      bool none = places[n] == kNoBlock;
      uint index = none ? 0u : places[n];
      int word = int(color_index(index / kBlockVoxels, index % kBlockVoxels));
      vec4 c = reflectance_of(uvec2(FETCH1(colors, word), FETCH1(colors, word + int(kBlockVoxels))));
      float weight = none ? 0.0 : corner_weight(share, n), sure = weight * c.w;
      color += vec4(sure * c.rgb, sure);
      total += weight;
      place = weight > most ? index : place;
      most = max(most, weight);
    }
    stroke = most > 0.0 ? voxel_of(FETCH1(voxels, int(place))).stroke : 0u;
    color = color.w > 0.0 ? vec4(color.rgb / color.w, color.w / total) : vec4(0.0);
  }
  uint to = pixel.y * push.size.x + pixel.x;
  STORE(depth, to, result);
  STORE(reflectance, to, color);
  STORE(strokes, to, stroke);
}

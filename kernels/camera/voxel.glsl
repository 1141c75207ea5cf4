// SPDX-License-Identifier: LGPL-2.1-or-later
// A voxel: one word with signed distance (in units of the truncation, -1…1, positive in front of the surface), weight and stroke; and two words
// with ln reflectance and its confidence.
const float kWeightSteps = 8.0;                      // of a sample of confidence 1
const float kMinLogReflectance = -7.0, kMaxLogReflectance = 1.5;

struct Voxel {
  float distance;  // truncations
  float weight;    // 0…255; 0: never seen
  uint stroke;     // 0: none
};
Voxel voxel_of(uint word) {
  return Voxel(unpackSnorm2x16(word).x, float(word >> 16 & 255u), word >> 24);
}
uint word_of(Voxel v) {
  return (packSnorm2x16(vec2(v.distance, 0.0)) & 0xffffu) | uint(clamp(v.weight, 0.0, 255.0) + 0.5) << 16 | v.stroke << 24;
}
// rgb: ln reflectance; w: confidence, 0…1, 0: unknown.
vec4 reflectance_of(uvec2 words) {
  vec4 u = vec4(unpackUnorm2x16(words.x), unpackUnorm2x16(words.y));
  return vec4(mix(vec3(kMinLogReflectance), vec3(kMaxLogReflectance), u.rgb), u.w);
}
uvec2 words_of(vec4 reflectance) {
  vec3 u = (reflectance.rgb - kMinLogReflectance) / (kMaxLogReflectance - kMinLogReflectance);
  return uvec2(packUnorm2x16(u.rg), packUnorm2x16(vec2(u.b, reflectance.w)));
}

// SPDX-License-Identifier: LGPL-2.1-or-later
// Spatio-temporal samples (3.4.3): the frames that they are drawn from, at bindings 0 to 5.
//
// A frame holds (r, packed chromaticity) a pixel, so that a sample costs one gather. The frames of a level lie one
// behind the other, the current one first, kSlots to a buffer: one buffer if the device can bind it. Bindings that
// a level does not need are bound to the first buffer again.
//
// Of the push constants it takes size, samples (drawn a pixel), frames (to draw from: the current one and the keyframes so
// far), ring_start (slot of the oldest keyframe, from 0), ring_capacity (keyframe slots), stream and seed (of the random
// numbers) and sample_threshold (τ_cc² on the grid of packed chromaticities).
#include "image/random.glsl"

layout(constant_id = 1) const int kSlots = 6;

PLANE_IN(0, frames0);
PLANE_IN(1, frames1);
PLANE_IN(2, frames2);
PLANE_IN(3, frames3);
PLANE_IN(4, frames4);
PLANE_IN(5, frames5);

vec4 sample_frame(int slot, int index) {
  // Everything but the first fetch is folded away by the specialization constant if one buffer holds all slots.
  // Fetches of buffers that the slot is not in go to pixel 0, which is in the cache.
  int b = kSlots < 6 ? slot / kSlots : 0;
  int at = (slot - b * kSlots) * push.size.x * push.size.y + index;
  vec4 value = FETCH(frames0, b == 0 ? at : 0);
  if (kSlots < 6) value = b == 1 ? FETCH(frames1, b == 1 ? at : 0) : value;
  if (kSlots < 3) value = b == 2 ? FETCH(frames2, b == 2 ? at : 0) : value;
  if (kSlots < 2) {
    value = b == 3 ? FETCH(frames3, b == 3 ? at : 0) : value;
    value = b == 4 ? FETCH(frames4, b == 4 ? at : 0) : value;
    value = b == 5 ? FETCH(frames5, b == 5 ? at : 0) : value;
  }
  return value;
}

const int kCurrent = 1, kKeyframes = 2;

/// (Σ r_ti, count) over the samples that agree in chromaticity with pixel n, whose packed chromaticity is `own`;
/// `spread` receives Σ |r − r_ti|² over them. `which`: from the current frame, keyframes or both.
vec4 draw_samples(int n, float own, vec3 r, int which, out float spread) {
  vec4 sum = vec4(0.0);
  spread = 0.0;
  float own_red = floor(own * (1.0 / 4096.0));
  float own_blue = own - own_red * 4096.0;
  for (int i = 0; i < push.samples; ++i) {
    uvec3 random = pcg3d(uvec3(uint(n), uint(i) + push.stream * 256u, push.seed)) >> 16u;
    uvec3 draw = (random * uvec3(push.size, push.frames)) >> 16u;
    int slot = int(draw.z);
    int keyframe = push.ring_start + slot;  // 1 is the oldest; the ring's end wraps
    slot = slot == 0 ? 0 : keyframe - (keyframe > push.ring_capacity ? push.ring_capacity : 0);
    bool wanted = ((slot == 0 ? kCurrent : kKeyframes) & which) != 0;
    // Both sides of a branch are fetched on some devices: choose the address, so that what is not wanted costs a
    // fetch that is in the cache.
    int address = wanted ? int(draw.y) * push.size.x + int(draw.x) : n;
    vec4 value = sample_frame(wanted ? slot : 0, address);
    float red = floor(value.w * (1.0 / 4096.0));
    float blue = value.w - red * 4096.0 - own_blue;
    red -= own_red;
    float green = red + blue;
    bool agrees = red * red + green * green + blue * blue < push.sample_threshold;
    // A choice, not a product: the current frame may not be written yet.
    vec3 d = r - value.rgb;
    sum += wanted && agrees ? vec4(value.rgb, 1.0) : vec4(0.0);
    spread += wanted && agrees ? dot(d, d) : 0.0;
  }
  return sum;
}

#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gauge.glsl"

// One invocation: the mean around a quantile of the counts, the gauge that it asks for, filtered in time, and the counts back to zero.
//   gauge[0] = ln c, where R c and S / c go out; 1 once a frame had a say; ln c as the last frame would have it;
//   how much ln c moved
WORD_INOUT(0, counts);
PLANE_IN(1, verdict);  // .y = 0 at a cut (verdict.comp)
PLANE_INOUT(2, gauge);
layout(push_constant) uniform Push {
  float quantile;
  float log_target;  // ln of the value that the quantile comes to
  float share;       // of the newest frame
  uint history;      // 0: no frame before; 1: one, which the verdict is on; 2: one without a verdict
  uint stays;        // 1: what is known stays
} push;

void main() {
  if (gl_GlobalInvocationID.x > 0u) return;
  uint total = 0u;
  for (uint i = 0u; i < kGaugeBins; ++i) total += LOAD(counts, i);
  // Ranks around the quantile, half of what lies above it wide on either side: a quantile alone jumps where it falls between
  // two surfaces.
  float center = push.quantile * float(total), reach = max(0.5 * (float(total) - center), 0.5);
  float low = clamp(center - reach, 0.0, float(total) - 0.5), high = min(center + reach, float(total));
  float below = 0.0, sum = 0.0;
  for (uint i = 0u; i < kGaugeBins; ++i) {
    float above = below + float(LOAD(counts, i));
    sum += max(min(above, high) - max(below, low), 0.0) * gauge_value(i);
    below = above;
    STORE(counts, i, 0u);
  }
  vec4 before = LOAD(gauge, 0);
  bool carries = push.history == 2u || (push.history == 1u && FETCH(verdict, 0).y > 0.0);
  bool known = carries && before.y > 0.0;
  // A frame that is all dark has no say; where nothing is known either, the solver's own scale stays.
  if (total == 0u) {
    STORE(gauge, 0, known ? vec4(before.xyz, 0.0) : vec4(0.0));
    return;
  }
  float wanted = push.log_target - sum / (high - low);
  float share = push.stays == 1u ? 0.0 : push.share;
  float value = known ? mix(before.x, wanted, share) : wanted;
  STORE(gauge, 0, vec4(value, 1.0, wanted, known ? value - before.x : 0.0));
}

#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "model.glsl"

// The points of the grid: mean color and how much it counts, its log chroma, and what the mean shading of its pixels seems
// to be. One point an invocation.
layout(constant_id = 1) const bool kFirst = false;
PLANE_IN(0, frame);
SCALAR_IN(1, memory);  // mean ln R
PLANE_OUT(2, colors);  // rgb; weight
PLANE_OUT(3, points);  // chroma, shading
layout(push_constant) uniform Push {
  SIZES
  float gauge;
} push;

const float kDark = 0.01, kBright = 0.98;  // what has a color to trust

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= push.grid.x * push.grid.y) return;
  ivec2 first = push.factor * ivec2(i % push.grid.x, i / push.grid.x), last = min(first + push.factor, push.size);
  vec4 sum = vec4(0.0);
  for (int y = first.y; y < last.y; ++y)
    for (int x = first.x; x < last.x; ++x) {
      int n = y * push.size.x + x;
      vec3 rgb = sanitize(FETCH(frame, n).rgb);
      sum += vec4(rgb, GUESSED(rgb, memory, n, push.gauge));
    }
  sum /= float((last.x - first.x) * (last.y - first.y));
  float mean = mean3(sum.rgb);
  bool fair = mean > kDark && max(max(sum.r, sum.g), sum.b) < kBright;
  STORE(colors, i, vec4(sum.rgb, fair ? mean : 0.0));
  STORE(points, i, vec4(chroma_of(sum.rgb), sum.w, 0.0));
}

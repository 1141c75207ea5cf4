// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/energy/energy.glsl"
#include "relax.glsl"

// The coarse levels of the multigrid in one dispatch of one workgroup: all levels, down to a single pixel, are consecutive in one
// buffer. With kSetup computes their operators, once a frame (as coarsen.comp), and reads its own output; else a V-cycle, with single
// packs as blocks, from the field and the right-hand side of the first level. Those of the others are in shared memory only.
layout(constant_id = 1) const bool kSetup = false;
layout(set = 0, binding = 0, std430) coherent restrict buffer system_block { vec4 system_data[]; };
PLANE_IN(1, operators);  // the same buffer as `system`
PLANE_INOUT(2, field);   // of the first level
const uint kMaxPacks = 512u;  // of all levels: 16 KiB, which every device has
shared vec4 field_of[kMaxPacks], rhs_of[kMaxPacks];
layout(push_constant) uniform Push {
  uvec2 size;  // of the first level
  float scale;
} push;

#define SYNC if (kSetup) memoryBarrierBuffer(); barrier()
#define EVERY_PACK(i, packs, height) for (uint i = gl_LocalInvocationID.x; i < (packs) * (height); i += gl_WorkGroupSize.x)
#define SYSTEM(at, slot) LOAD(system, 4u * (at) + slot)
#define OPERATOR(at, slot) FETCH(operators, int(4u * (at) + slot))

// Half a block Gauss-Seidel pass over the level of `size` that starts at pack `base`.
void smooth_color(uint base, uvec2 size, uint color) {
  uint packs = PACK4(size.x), pairs = (packs + 1u) / 2u;
  EVERY_PACK(i, pairs, size.y) {
    uint y = i / pairs, x = 2u * (i - y * pairs) + ((y + color) & 1u);
    if (x < packs) {
      uint at = base + y * packs + x;
      vec4 right = OPERATOR(at, SYSTEM_RIGHT), down = OPERATOR(at, SYSTEM_DOWN);
      vec4 f = rhs_of[at], d = OPERATOR(at, SYSTEM_MASS);
      float left = 0.0;
      if (x > 0u) {
        left = OPERATOR(at - 1u, SYSTEM_RIGHT).w;
        f.x += left * field_of[at - 1u].w;
      }
      if (x + 1u < packs) f.w += right.w * field_of[at + 1u].x;
      if (y > 0u) {
        vec4 up = OPERATOR(at - packs, SYSTEM_DOWN);
        f += up * field_of[at - packs];
        d += up;
      }
      if (y + 1u < size.y) f += down * field_of[at + packs];
      field_of[at] = solve_pack(d + right + SHIFT_RIGHT(right, vec4(left)) + down, right, f);
    }
  }
  SYNC;
}

// The right-hand side of one pack of the next level, at `to`, from the level of `size` at `base`: x, y are its place there.
void restrict_pack(uint base, uvec2 size, uint x, uint y, uint to) {
  uint packs = PACK4(size.x);
  vec4 rhs = vec4(0.0);
  for (uint part = 0u; part < 4u; ++part) {  // two rows of two packs
    uint qx = 2u * x + (part & 1u), qy = 2u * y + (part >> 1u);
    if (qx < packs && qy < size.y) {
      uint at = base + qy * packs + qx;
      vec4 right = OPERATOR(at, SYSTEM_RIGHT);
      vec4 u = field_of[at], f = rhs_of[at] - OPERATOR(at, SYSTEM_MASS) * u;
      vec4 flow = right * (SHIFT_LEFT(u, qx + 1u < packs ? field_of[at + 1u] : u) - u);
      float left = 0.0;
      if (qx > 0u) left = OPERATOR(at - 1u, SYSTEM_RIGHT).w * (u.x - field_of[at - 1u].w);
      f += flow - SHIFT_RIGHT(flow, vec4(left));
      if (qy > 0u) f += OPERATOR(at - packs, SYSTEM_DOWN) * (field_of[at - packs] - u);
      if (qy + 1u < size.y) f += OPERATOR(at, SYSTEM_DOWN) * (field_of[at + packs] - u);
      rhs += (part & 1u) != 0u ? vec4(0.0, 0.0, f.xz + f.yw) : vec4(f.xz + f.yw, 0.0, 0.0);
    }
  }
  rhs_of[to] = rhs;
  field_of[to] = vec4(0.0);
}

// The operator of that pack.
void aggregate(uint base, uvec2 size, uint x, uint y, uint to) {
  uint packs = PACK4(size.x);
  vec4 mass = vec4(0.0), across = vec4(0.0), inside = vec4(0.0), along[3];
  along[0] = along[1] = along[2] = vec4(0.0);
  for (uint part = 0u; part < 4u; ++part) {  // two rows of two packs
    uint qx = 2u * x + (part & 1u), qy = 2u * y + (part >> 1u);
    if (qx < packs && qy < size.y) {
      uint at = base + qy * packs + qx;
      bool second = (part & 1u) != 0u;
      vec4 right = SYSTEM(at, SYSTEM_RIGHT), down = SYSTEM(at, SYSTEM_DOWN), m = SYSTEM(at, SYSTEM_MASS);
      vec2 pair = m.xz + m.yw;
      mass += second ? vec4(0.0, 0.0, pair) : vec4(pair, 0.0, 0.0);
      across += second ? vec4(0.0, 0.0, right.yw) : vec4(right.yw, 0.0, 0.0);
      inside += second ? vec4(0.0, 0.0, right.xz) : vec4(right.xz, 0.0, 0.0);
      pair = down.xz + down.yw;
      along[part >> 1u] += second ? vec4(0.0, 0.0, pair) : vec4(pair, 0.0, 0.0);
    }
  }
  uint first = base + 2u * y * packs + 2u * x;
  float next = 0.0;  // stiffness within the aggregate after this pack
  if (2u * x + 2u < packs) {
    next = SYSTEM(first + 2u, SYSTEM_RIGHT).x;
    if (2u * y + 1u < size.y) next += SYSTEM(first + packs + 2u, SYSTEM_RIGHT).x;
  }
  if (2u * y + 2u < size.y) {
    vec4 a = SYSTEM(first + 2u * packs, SYSTEM_DOWN);
    along[2].xy = a.xz + a.yw;
    if (2u * x + 1u < packs) {
      vec4 b = SYSTEM(first + 2u * packs + 1u, SYSTEM_DOWN);
      along[2].zw = b.xz + b.yw;
    }
  }
  bvec4 last = equal(uvec4(8u * x) + uvec4(3, 5, 7, 9), uvec4(size.x));
  SYSTEM(to, SYSTEM_RIGHT) = in_series(across, inside, SHIFT_LEFT(inside, vec4(next)), last, push.scale);
  SYSTEM(to, SYSTEM_DOWN) = in_series(along[1], along[0], along[2], bvec4(2u * y + 3u == size.y), push.scale);
  SYSTEM(to, SYSTEM_MASS) = mass;
}

void main() {
  // Down to the single pixel and up again. Every operation is written once, so that it is compiled once.
  uint level = 0u, first_packs = PACK4(push.size.x);
  if (!kSetup) {
    EVERY_PACK(i, first_packs, push.size.y) {
      rhs_of[i] = OPERATOR(i, SYSTEM_RHS);
      field_of[i] = LOAD(field, i);
    }
    SYNC;
  }
  for (bool up = false;;) {
    uvec2 size = push.size;
    uint base = 0u;
    for (uint i = 0u; i < level; ++i) {
      base += PACK4(size.x) * size.y;
      size = (size + 1u) / 2u;
    }
    uvec2 half_size = (size + 1u) / 2u;
    uint packs = PACK4(size.x), half_packs = PACK4(half_size.x), coarse = base + packs * size.y;
    if (up) {
      EVERY_PACK(i, packs, size.y) {
        uint y = i / packs, x = i - y * packs;
        vec4 pairs = field_of[coarse + (y / 2u) * half_packs + x / 2u];
        vec4 correction = (x & 1u) == 0u ? pairs.xxyy : pairs.zzww;
        field_of[base + i] += MASKED(correction, INSIDE(x, size.x));
      }
      SYNC;
    }
    if (!kSetup)
      for (uint color = 0u; color < 2u; ++color) smooth_color(base, size, up ? 1u - color : color);
    bool single = size.x == 1u && size.y == 1u;
    if (!up && !single) {
      EVERY_PACK(i, half_packs, half_size.y) {
        uint y = i / half_packs;
        if (kSetup)
          aggregate(base, size, i - y * half_packs, y, coarse + i);
        else
          restrict_pack(base, size, i - y * half_packs, y, coarse + i);
      }
      SYNC;
      ++level;
    } else {
      if (kSetup || level == 0u) break;
      up = true;
      --level;
    }
  }
  if (kSetup) return;
  EVERY_PACK(i, first_packs, push.size.y) STORE(field, i, field_of[i]);
}

// SPDX-License-Identifier: LGPL-2.1-or-later
// Visibility of a mesh at eight samples of a pixel: the nearest triangle at each. One invocation per pixel; kBlock x kBlock of
// them are a block, which reads the same groups of triangles.
PLANE_IN(0, records);
WORD_IN(1, bits);
PLANE_IN(2, bounds);
layout(push_constant) uniform Push {
  vec4 lens;       // place.comp
  uvec2 size;      // of the picture
  uint first;      // where it begins in the plane that is written, ...
  uint stride;     // ... and pixels a row of that
  uint tile;       // pixels along a tile of `bits`
  uint columns;    // tiles along a row
  uint words;      // words a tile
  uint group;      // triangles of a group, a multiple of kTogether
  uint side;       // of the lit sphere's table
} push;

const int kNone = -1;
const uint kBlock = 8u;      // pixels along a block of invocations
const uint kTogether = 32u;  // triangles tested at once, a bit each

// Sample positions: no two in the same row or column of eighths.
const vec4 kAcross[2] = vec4[2](vec4(0.5625, 0.4375, 0.8125, 0.3125), vec4(0.1875, 0.0625, 0.6875, 0.9375));
const vec4 kDown[2] = vec4[2](vec4(0.3125, 0.6875, 0.5625, 0.1875), vec4(0.8125, 0.4375, 0.9375, 0.0625));

struct Seen {
  vec4 depth;
  ivec4 who;
};

uvec2 pixel_of(uvec2 id) {  // of the invocations of a block along x, and a row of blocks along y
  uint place = id.x % (kBlock * kBlock);
  return uvec2(id.x / (kBlock * kBlock), id.y) * kBlock + uvec2(place % kBlock, place / kBlock);
}

Seen nearer(Seen seen, vec4 x, vec4 y, vec4 p, vec4 q, vec4 r, int who) {
  vec4 a = p.x * x + p.y * y + p.z, b = q.x * x + q.y * y + q.z, c = r.x * x + r.y * y + r.z;
  vec4 depth = (a * p.w + b * q.w + c * r.w) / max(a + b + c, vec4(1e-30));
  bvec4 wins = bvec4(ivec4(greaterThanEqual(min(a, min(b, c)), vec4(0.0))) * ivec4(greaterThan(depth, seen.depth)));
  return Seen(mix(seen.depth, depth, wins), mix(seen.who, ivec4(who), wins));
}

uint meets(int first, int k, vec2 corner) {
  vec4 box = FETCH(bounds, first + k);
  bvec4 in_reach = bvec4(lessThan(box.xy, corner + 1.0), greaterThan(box.zw, corner));
  return all(in_reach) ? 1u << k : 0u;
}

void find_visible(uvec2 at, out Seen seen[2]) {
  seen[0] = seen[1] = Seen(vec4(-1e30), ivec4(kNone));
  uint tile = at.y / push.tile * push.columns + at.x / push.tile;
  vec2 corner = vec2(at);
  for (uint w = 0u; w < push.words; ++w) {
    uint left = FETCH1(bits, int(tile * push.words + w));
    while (left != 0u) {
      uint first = (w * 32u + uint(findLSB(left))) * push.group;
      left &= left - 1u;
      // kTogether triangles at a time: first a cheap test of their boxes against the pixel, then only those that pass.
      for (uint part = first; part < first + push.group; part += kTogether) {
        uint mine = 0u;
        for (uint k = 0u; k < kTogether; k += 8u) {  // a turn of a loop costs more than a box
          int b = int(part + k);
          uint eight = meets(b, 0, corner) | meets(b, 1, corner) | meets(b, 2, corner) | meets(b, 3, corner) |
                       meets(b, 4, corner) | meets(b, 5, corner) | meets(b, 6, corner) | meets(b, 7, corner);
          mine |= eight << k;
        }
        while (mine != 0u) {
          int t = int(part) + findLSB(mine);
          mine &= mine - 1u;
          vec4 p = FETCH(records, 4 * t), q = FETCH(records, 4 * t + 1), r = FETCH(records, 4 * t + 2);
          seen[0] = nearer(seen[0], corner.x + kAcross[0], corner.y + kDown[0], p, q, r, t);
          seen[1] = nearer(seen[1], corner.x + kAcross[1], corner.y + kDown[1], p, q, r, t);
        }
      }
    }
  }
}

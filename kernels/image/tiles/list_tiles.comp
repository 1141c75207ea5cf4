// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "tiles.glsl"

// Lists the flagged tiles in order, with the number of workgroups for their items. One workgroup.
WORD_IN(0, flags);
WORD_OUT(1, list);
layout(push_constant) uniform Push {
  uint tiles;
  uint columns;    // tiles a row
  uint workgroup;  // invocations of the kernels that work on the list
  uint limit;      // of workgroups along x
} push;

shared uint counts[256];

void main() {
  uint lane = gl_LocalInvocationID.x, lanes = gl_WorkGroupSize.x, share = (push.tiles + lanes - 1u) / lanes;
  uint first = min(lane * share, push.tiles), last = min(first + share, push.tiles), count = 0u, to = 0u, total = 0u;
  for (uint i = first; i < last; ++i) count += FETCH1(flags, int(i));
  counts[lane] = count;
  barrier();
  for (uint i = 0u; i < lanes; ++i) {
    to += i < lane ? counts[i] : 0u;
    total += counts[i];
  }
  for (uint i = first; i < last; ++i)
    if (FETCH1(flags, int(i)) == 1u) {
      uint row = i / push.columns;
      STORE(list, LIST_TILES + to, row << 16u | (i - row * push.columns));
      ++to;
    }
  if (lane < LIST_SIZES) {
    uint groups = ((total << lane) + push.workgroup - 1u) / push.workgroup;
    uint rows = max((groups + push.limit - 1u) / push.limit, 1u);  // gpu::rows_of_groups
    STORE(list, LIST_ARGUMENTS + 3u * lane, (groups + rows - 1u) / rows);
    STORE(list, LIST_ARGUMENTS + 3u * lane + 1u, rows);
    STORE(list, LIST_ARGUMENTS + 3u * lane + 2u, 1u);
  }
  if (lane == 0u) STORE(list, LIST_COUNT, total);
}

// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/camera.glsl"
#include "camera/voxel.glsl"

// How much of each lamp reaches places around an object through the scene. One place an invocation. Places that the scene hides from the
// object's center are none: x is -1.
PLANE_IN(0, room);
WORD_IN(1, table);
WORD_IN(2, voxels);
PLANE_OUT(3, reached);
layout(push_constant) uniform Push {
  uint table_mask;
  float voxel;
  float truncation;
} push;
#include "camera/find_block.glsl"
#include "camera/shadow.glsl"
#include "room.glsl"

const float kReach = 1.0;  // meters: what is farther away is where the light comes from

void main() {
  int i = int(line_index());
  if (i >= kProbes * kProbes * kProbes) return;
  vec4 object = FETCH(room, kObject);
  vec3 cell = vec3(i % kProbes, i / kProbes % kProbes, i / (kProbes * kProbes));
  vec3 off = (2.0 * cell / float(kProbes - 1) - 1.0) * kProbeReach * object.w;
  float away = length(off);
  float lit[kMaxLamps] = float[](1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0);
  bool open = lit_share(object.xyz / push.voxel, off / away, away / push.voxel, 0.0) > 0.5;
  for (int k = 0; k < lamp_count() && open; ++k)
    lit[k] = lit_share((object.xyz + off) / push.voxel, beam(k, 3).xyz, kReach / push.voxel, beam(k, 1).w);
  STORE(reached, 2 * i, vec4(open ? lit[0] : -1.0, lit[1], lit[2], lit[3]));
  STORE(reached, 2 * i + 1, vec4(lit[4], lit[5], lit[6], lit[7]));
}

#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"
#include "guide.glsl"
#include "tiles.glsl"

// EdgePrior, pixels: from local cues of the guide, how much of every step is paint (a) and how much is light (b). An
// invocation has a block of 4 x 2 pixels, edges to the right and down. What edges share is evaluated once: the surroundings
// on level 2 for up to six edges, those on level 1 for the two edges side by side in the same cells. All loops are rolled, so
// that the function is compiled once. With kListed, blocks of the tiles on a list only (change.comp).
layout(constant_id = 1) const bool kListed = false;
PLANE_IN(0, level0);
PLANE_IN(1, level1);
PLANE_IN(2, cells);
PLANE_IN(3, statistics);
PLANE_IN(4, tuning);
WORD_IN(5, control);
WORD_IN(6, list);
PLANE_OUT(7, system);  // of stride 3
PLANE_OUT(8, flux);
layout(push_constant) uniform Push {
  ivec2 size;
  float reflectance_weight;
  float shading_weight;
} push;
#include "edge_net.glsl"
#include "net.glsl"

// How much more the largest channel steps than the mean does.
float value_step(vec4 step) { return 5.0 * clamp(abs(step.x + step.w) - abs(step.x), -0.4, 0.4); }

void main() {
  int quads = int(QUADS(uint(push.size.x)));
  ivec2 block = ivec2(grid_position(uint(quads))) * ivec2(4, 2), last = push.size - 1;
  if (kListed) {
    int i = int(gl_GlobalInvocationID.x), slot = i / TILE_BLOCKS, columns = (push.size.x + TILE - 1) / TILE;
    if (slot >= int(FETCH1(control, CONTROL_COUNT))) return;
    int tile = int(FETCH1(list, slot));
    block = ivec2(tile % columns, tile / columns) * TILE + ivec2(i % 4, i % TILE_BLOCKS / 4) * ivec2(4, 2);
    if (block.x > last.x) return;
  }
  if (block.y > last.y) return;
  ivec2 size1 = (push.size + 1) / 2, size2 = (size1 + 1) / 2;
  float mean = FETCH(statistics, 0).x;
  for (int direction = 0; direction < 2; ++direction) {
    ivec2 d = direction == 0 ? ivec2(1, 0) : ivec2(0, 1);
    int stride = direction == 0 ? 1 : push.size.x;
    vec4 weights = vec4(0.0), fluxes = vec4(0.0), other_weights = vec4(0.0), other_fluxes = vec4(0.0);  // of both rows
    for (int part = 0; part < 2; ++part) {
      // Pairs of edges 0 to 3: to the right columns 0 to 2, then 3, in which both rows share; down rows 0, then 1, two
      // pairs of columns each. A part shares its place on level 2.
      int from = part == 0 ? 0 : 3 - direction, to = part == 0 ? 3 - direction : 4;
      float f[EDGE_CUES];
      vec4 far[EDGE_VECTORS];
      {
        ivec2 at = min(block + (direction == 0 ? ivec2(from, 0) : ivec2(0, part)), last);
        ivec2 p = max(at - 3 * d, ivec2(0)) >> 2, q = min((at + 4 * d) >> 2, size2 - 1);
        int cell_p = CELL_STRIDE * (p.y * size2.x + p.x), cell_q = CELL_STRIDE * (q.y * size2.x + q.x);
        vec4 step = FETCH(cells, cell_p) - FETCH(cells, cell_q);
        vec4 activity = 0.5 * (FETCH(cells, cell_p + 1) + FETCH(cells, cell_q + 1));
        f[4] = cue(abs(step.x), 2.0);
        f[5] = cue(length(step.yz), 2.0);
        f[6] = cue(activity.x, 2.5);
        f[7] = cue(activity.y, 2.5);
        EDGE_BIASES(far);
        edge_stage0(f, far);
      }
      for (int pair = from; pair < to; ++pair) {
        ivec2 place = direction == 0 ? ivec2(pair, 0) : ivec2(2 * (pair & 1), pair >> 1);
        vec4 sums[EDGE_VECTORS] = far;
        {
          ivec2 at = min(block + place, last), p = max(at - d, ivec2(0)) >> 1, q = min((at + 2 * d) >> 1, size1 - 1);
          vec4 step = FETCH(level1, p.y * size1.x + p.x) - FETCH(level1, q.y * size1.x + q.x);
          f[2] = cue(abs(step.x), 2.5);
          f[3] = cue(length(step.yz), 2.5);
          f[11] = value_step(step);
          edge_stage1(f, sums);
        }
        for (int side = 0; side < 2; ++side) {
          ivec2 pixel = block + place + side * d.yx, at = min(pixel, last);
          int along = direction == 0 ? at.x : at.y, end = direction == 0 ? last.x : last.y;
          int here = at.y * push.size.x + at.x, next = here + (along < end ? stride : 0);
          vec4 p = FETCH(level0, here), q = FETCH(level0, next), step = p - q;
          vec4 step_before = FETCH(level0, here - (along > 0 ? stride : 0)) - p;
          vec4 step_after = q - FETCH(level0, next + (along + 1 < end ? stride : 0));
          f[0] = cue(abs(step.x), 3.0);
          f[1] = cue(length(step.yz), 3.0);
          f[8] = clamp((0.5 * (p.x + q.x) - mean) * (1.0 / 1.5), -2.0, 2.0);
          f[9] = p.w + q.w - 0.7;
          f[10] = value_step(step);
          f[12] = cue(abs(step_before.x) + abs(step_after.x), 3.0);
          f[13] = cue(length(step_before.yz) + length(step_after.yz), 3.0);
          f[14] = clamp(0.5 * (min(p.x, q.x) + 4.0), -1.0, 2.0);
          vec2 result = edge_net(f, sums);
          float on = pixel == at && along < end ? 1.0 : 0.0;
          float a = on * push.reflectance_weight * weight(result.x), b = on * push.shading_weight * weight(result.y);
          vec4 new_weights = vec4(weights.yzw, a + b), new_fluxes = vec4(fluxes.yzw, a * step.x);
          // The next edge belongs to the other row: always to the right, after four edges down.
          bool turn = direction == 0 || ((pair & 1) == 1 && side == 1);
          weights = turn ? other_weights : new_weights;
          fluxes = turn ? other_fluxes : new_fluxes;
          other_weights = turn ? new_weights : other_weights;
          other_fluxes = turn ? new_fluxes : other_fluxes;
        }
      }
    }
    uint at = uint(block.y * quads + block.x / 4);
    STORE(system, 3u * at + uint(direction), weights);
    STORE(flux, FLUX_STRIDE * at + uint(direction), fluxes);
    if (block.y < last.y) {
      at += uint(quads);
      STORE(system, 3u * at + uint(direction), other_weights);
      STORE(flux, FLUX_STRIDE * at + uint(direction), other_fluxes);
    }
  }
}

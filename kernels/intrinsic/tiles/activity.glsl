// SPDX-License-Identifier: LGPL-2.1-or-later
// What is known of a tile's activity from frame to frame, a vec4 a tile: how much its log shading (rms) changed a frame by the
// last frame that worked on it, kBusy where its input changed, too; for how many frames the one at work has to stand, this one
// and those before it that left the tile out (active.comp counts them); and for how many the last one that worked on it stood.
const float kBusy = 1e30;

// Whether the input changed in this tile or one beside it: no stencil that starts from pixels reaches further.
bool near_change(ivec2 tile, ivec2 tiles) {
  uint any = 0u;
  for (int y = max(tile.y - 1, 0); y <= min(tile.y + 1, tiles.y - 1); ++y)
    for (int x = max(tile.x - 1, 0); x <= min(tile.x + 1, tiles.x - 1); ++x) any |= FETCH1(changed, y * tiles.x + x);
  return any != 0u;
}

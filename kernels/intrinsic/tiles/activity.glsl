// SPDX-License-Identifier: LGPL-2.1-or-later
// Activity of a tile, one vec4: change of its log shading (rms) per frame in the last frame that worked on it, kMoving if its input
// changed, too; number of frames that the present one stands for, itself and those before it that skipped the tile (counted by
// active.comp); and that number of the last one that worked on it.
const float kMoving = 1e30;

// Whether the input changed in this tile or one beside it: no stencil of pixels reaches further.
bool near_change(ivec2 tile, ivec2 tiles) {
  uint any = 0u;
  for (int y = max(tile.y - 1, 0); y <= min(tile.y + 1, tiles.y - 1); ++y)
    for (int x = max(tile.x - 1, 0); x <= min(tile.x + 1, tiles.x - 1); ++x) any |= FETCH1(changed, y * tiles.x + x);
  return any != 0u;
}

// SPDX-License-Identifier: LGPL-2.1-or-later
// Work on a list of tiles of 16 x 16 pixels instead of a whole frame. Before including this file, a kernel defines
// TILE_CONSTANT, the first of two specialization constants, and TILE_BINDING, the binding of the list (TileProgram).
//
// The list, in words: the number of tiles; from LIST_ARGUMENTS on the workgroup counts, three words each, of kernels
// with 1, 2, 4 … 64 invocations per tile; from LIST_TILES on the tiles, column + 65536 row.
#define LIST_COUNT 0
#define LIST_ARGUMENTS 4
#define LIST_SIZES 7
#define LIST_TILES 32

#ifdef TILE_BINDING
layout(constant_id = TILE_CONSTANT) const uint kTileAcross = 0u;    // invocations along a tile; 0: no list, the whole frame
layout(constant_id = TILE_CONSTANT + 1) const uint kTileDown = 0u;
WORD_IN(TILE_BINDING, list);

// Position of this invocation on a grid of `columns` per row, of which only the listed tiles are dispatched.
// Invocations without work get a row below every grid.
uvec2 listed_position(uint columns) {
  const uvec2 nowhere = uvec2(0u, 0xffffffu);
  uint items = kTileAcross * kTileDown, i = line_index(), slot = i / items, place = i - slot * items;
  if (slot >= FETCH1(list, LIST_COUNT)) return nowhere;
  uint tile = FETCH1(list, LIST_TILES + int(slot));
  uvec2 at = uvec2((tile & 65535u) * kTileAcross + place % kTileAcross, (tile >> 16u) * kTileDown + place / kTileAcross);
  return at.x < columns ? at : nowhere;
}
#endif

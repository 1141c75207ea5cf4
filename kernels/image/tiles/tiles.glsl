// Work on a list of tiles of 16 x 16 pixels in place of a whole frame. A kernel that can do both defines, before it includes
// this, TILE_CONSTANT, the first of two specialization constants, and TILE_BINDING, where the list comes in (TileKernel).
//
// The list, in words: how many tiles; from LIST_ARGUMENTS on the workgroups, three words each, of kernels with 1, 2, 4 … 64
// invocations a tile; from LIST_TILES on the tiles, column and 65536 times row.
#define LIST_COUNT 0
#define LIST_ARGUMENTS 4
#define LIST_SIZES 7
#define LIST_TILES 32

#ifdef TILE_BINDING
layout(constant_id = TILE_CONSTANT) const uint kTileAcross = 0u;    // invocations along a tile; 0: no list, the whole frame
layout(constant_id = TILE_CONSTANT + 1) const uint kTileDown = 0u;
WORD_IN(TILE_BINDING, list);

// Position of this invocation on a grid `columns` wide, of which only the listed tiles' part is dispatched. Below every grid
// where there is nothing to do.
uvec2 listed_position(uint columns) {
  const uvec2 nowhere = uvec2(0u, 0xffffffu);
  uint items = kTileAcross * kTileDown, i = gl_GlobalInvocationID.x, slot = i / items, place = i - slot * items;
  if (slot >= FETCH1(list, LIST_COUNT)) return nowhere;
  uint tile = FETCH1(list, LIST_TILES + int(slot));
  uvec2 at = uvec2((tile & 65535u) * kTileAcross + place % kTileAcross, (tile >> 16u) * kTileDown + place / kTileAcross);
  return at.x < columns ? at : nowhere;
}
#endif

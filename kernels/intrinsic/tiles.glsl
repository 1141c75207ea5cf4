// Tiles of 16 x 16 pixels, of which only those whose input has changed get new edges.
#define TILE 16
#define TILE_BLOCKS 16  // invocations of edges.comp a tile: blocks of 4 x 4 pixels
#define TILE_CELLS 8    // level-1 cells along a tile

// The control buffer: how many tiles are listed; workgroups of edges.comp and of keep.comp, three words each.
#define CONTROL_COUNT 0
#define CONTROL_EDGES 1
#define CONTROL_KEEP 4

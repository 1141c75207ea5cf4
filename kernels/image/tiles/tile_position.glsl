#include "tiles.glsl"

// Position of this invocation on a grid that is dispatched as one line, or on the listed tiles' part of it.
uvec2 tile_position(uint columns) { return kTileAcross == 0u ? grid_position(columns) : listed_position(columns); }

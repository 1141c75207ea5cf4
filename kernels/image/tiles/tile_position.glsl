// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tiles.glsl"

// Position of this invocation on a grid dispatched as one line, or within the listed tiles.
uvec2 tile_position(uint columns) { return kTileAcross == 0u ? grid_position(columns) : listed_position(columns); }

// What is known of a tile's activity from frame to frame, a float a tile: the rms change of its log shading by the last frame
// that worked on it; kBusy where its input changed, too; kLeftOut where the last frame did not work on it.
const float kBusy = 1e30;
const float kLeftOut = -1.0;

// Whether the input changed in this tile or one beside it: no stencil that starts from pixels reaches further.
bool near_change(ivec2 tile, ivec2 tiles) {
  uint any = 0u;
  for (int y = max(tile.y - 1, 0); y <= min(tile.y + 1, tiles.y - 1); ++y)
    for (int x = max(tile.x - 1, 0); x <= min(tile.x + 1, tiles.x - 1); ++x) any |= FETCH1(changed, y * tiles.x + x);
  return any != 0u;
}

// What is kept of a frame for the next: a pixel's (d, c0, c1, r), d = m - m_P2 its local log contrast (P2: its 4 x 4 cell),
// r = m - s. Chroma and local contrast survive a change of light, but not moving content.
struct Change {
  float detail;  // factors on the differences, 1 / anchor_detail and 1 / anchor_chroma
  float chroma;
};
float mismatch(vec4 guide, float cell_mean, vec4 before, Change change) {
  float d = change.detail * (guide.x - cell_mean - before.x);
  vec2 c = change.chroma * (guide.yz - before.yz);
  return d * d + dot(c, c);
}

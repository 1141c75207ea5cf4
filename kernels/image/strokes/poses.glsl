// SPDX-License-Identifier: LGPL-2.1-or-later
// Where strokes have moved to (track.comp). A slot: turn and shift, by which u, a place relative to the center c of the stroke as
// drawn, goes to c + shift + turn u (pixels of the frame, complex numbers); the turn with which its template was taken, and its
// velocity (pixels a frame); its state, the share of samples that fit and that share on the frame itself, and the change of
// log intensity since the template; and the template's standard deviation, the best share so far, -, -.
#define POSE_PLACE 0
#define POSE_KEY 1
#define POSE_STATE 2
#define POSE_TEMPLATE 3
#define POSE_STRIDE 4
#define STATE_WAITING 0   // without texture to follow: as drawn
#define STATE_FOLLOWED 1
#define STATE_LOST 2      // not found, not drawn
#define STATE_OUTSIDE 3   // of the frame, not drawn

// Words: whether a stroke needs to be followed; whether one moved; and from here on of each slot, whether it needs it.
#define MOVED_ANY 0
#define MOVED_STROKES 1
#define MOVED_SLOTS 2

vec2 times(vec2 a, vec2 b) { return vec2(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x); }
vec2 over(vec2 a, vec2 b) { return times(a, vec2(b.x, -b.y)) / max(dot(b, b), 1e-12); }

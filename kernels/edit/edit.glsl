// What the editing kernels share.
#include "../image/finite.glsl"

const uint kRows = 4u;  // pixels an invocation, one above the other


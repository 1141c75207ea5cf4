// What the networks of thesis chapter 6 see and give. Colors are sRGB 0…1; the specular layer and the mirror image are linear
// and of high dynamic range, so that they are coded as ln(1 + 4 x) / 2 (training/lime/README.md).
#include "gpu/common.glsl"

const float kObject = 0.5;  // probability from which on a point is of the object

float decode(float code) { return 0.25 * (exp(2.0 * clamp(code, 0.0, 8.0)) - 1.0); }

// Linear light from which on a camera may have been at its end, and is.
const vec2 kClips = vec2(0.85, 0.98);

// Linear light as a guide of the mask: about as even to the eye as sRGB, and cheaper.
vec3 guide_of(vec3 rgb) { return sqrt(max(rgb, vec3(0.0))); }

// SPDX-License-Identifier: LGPL-2.1-or-later
// Bits of what a pixel of a frame is, compared with the view of the scene from its place.
#define TOUCH_FRONT 1  // something in front of the scene
#define TOUCH_MAYBE 2  // a little in front, or the scene is not known there
#define TOUCH_SKIN 4   // has the color of skin
// Sums over a tile of TOUCH_TILE x TOUCH_TILE pixels, in vec4, weighted: xyz: nearest places of the scene in the camera's axes, w: the
// weight; rgb: ln R there, w: the weight where it is known; x: distance times weight, y: pixels of the weight, z: pixels in front,
// w: pixels with a depth.
#define TOUCH_TILE 8
#define TOUCH_STRIDE 3
// Tiles that something in front connects with the border of the picture, and those around them: a bit a tile. Of further tiles, all are.
#define TOUCH_ARM_WORDS 1024
// What a frame touches, in vec4: xyz: place in the world, w: area that is near the scene there, m², 0: nothing; rgb: ln R there, w: 1 if
// it is known; x: mean distance, meters, y: pixels, z: share of pixels with a depth that are in front.
#define TOUCH_RESULT 3

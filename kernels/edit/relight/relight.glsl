// SPDX-License-Identifier: LGPL-2.1-or-later
// Shared by the relighting kernels.
const float kShadingFloor = 0.001953125;  // 2^-9: darker shading counts as this dark

// Rows of vec4 of a lamp in the table of lamps (lamp_table).
const int kLampRows = 4;
const int kPlace = 0;  // x, y, z; radius^2. Of directional lamps unused
const int kAxis = 1;   // direction of its light; kind
const int kLight = 2;  // power, RGB; cosine of the edge of its cone
const int kMark = 3;   // place in pixels; 1 / (cosine where its cone is full - that of the edge); color, 0xRRGGBB
// Added to the kind of lamps in a remembered scene, until place.comp has put them into its axes.
const int kKinds = 3;
const int kOfRoom = 3;    // given in the world
const int kOfCamera = 6;  // given by the pixel of its mark and its depth, z of its place

// Of lamps in a remembered scene.
const uint kShareStep = 2u;   // pixels from one that has shares to the next
const uint kShareWords = 2u;  // of shares a pixel
const float kAlike = 0.3;     // least cosine between two normals of one surface

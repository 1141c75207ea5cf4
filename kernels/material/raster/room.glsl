// SPDX-License-Identifier: LGPL-2.1-or-later
// An object in a remembered scene, and the light there: rows of vec4 of the table `room` (PLANE_IN), by RoomInsertion. World axes: x right, y down, z forward, meters.
const int kRotation = 0;  // of the camera's pose
const int kPlace = 1;
const int kToLit = 2;     // quaternion from the rasterizer's camera axes (x right, y up, z back) to those of the lit sphere's table
const int kObject = 3;    // center; radius
const int kWindow = 4;    // origin of the object's picture in the frame, pixels; pixels of the view a pixel of the frame
const int kView = 5;      // size of the view; beams; of which the first ones are lamps
const int kBeams = 6;     // LightBeam, kBeamRows each: mean direction, flux; then axes of its map:
const int kBeamRows = 4;  // x, radius of the light at a distance of 1; y; z, the unit direction towards the light

const int kMaxBeams = 16, kMaxLamps = 8;
// The object seen from the lights: maps of kMapSide² in rows of kMapColumns, kMapRows of them, of its side towards the light; then the
// same of the other side.
const int kMapSide = 64, kMapColumns = 4, kMapRows = 4;
const float kMapScale = 30.0;  // pixels a radius

// Whether the lamps reach places around the object: kProbes³, from -kProbeReach to kProbeReach radii, two vec4 each.
const int kProbes = 6;
const float kProbeReach = 1.1;

int beam_count() { return int(FETCH(room, kView).z); }
int lamp_count() { return int(FETCH(room, kView).w); }
vec4 beam(int k, int row) { return FETCH(room, kBeams + kBeamRows * k + row); }
// Of a beam on a surface, in any unit.
float light_of_beam(int k, vec3 normal) {
  vec4 light = beam(k, 0);
  return light.w * max(dot(light.xyz, normal), 0.0);
}

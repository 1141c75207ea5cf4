// SPDX-License-Identifier: LGPL-2.1-or-later
// The scale of reflectance is free: R c and S / c make the same picture. ln c = ln(white level) + offset. The offset keeps the
// brightness of what stays in view (scale_track.comp, scale_update.comp).
//
// White light has a fixed ln S as long as the exposure is the same. The exposure is the common change of m that comes without the change
// of color that brighter light has (image/light_color.glsl); white light follows it.
//
// Of a cell: mean log intensity m, chroma (two log ratios), mean log reflectance before scaling. One vec4.

// The state from frame to frame, four vec4:
#define SCALE_NOW 0     // ln c, 1 once it is known, offset, offset that the frame alone would get
#define SCALE_MOTION 1  // the points' common motion: of the frame's center (cells a frame), zoom and turn (1 a frame)
#define SCALE_STATE 2   // sum of the shifts of the references, mean share of bright points, 1 if the points go on, ln S of white light
                        // in the output plus ln(white level)
#define SCALE_LIGHT 3   // exposure; color of light by which the cells were corrected: k, m of white; last step of the exposure
#define SCALE_SIZE 4

// Of a point, a vec4: place (cells), frames since it began (-1: lost), -.

// The last frames of a point, a vec4 each: log reflectance in the output less ln(white level) and the shifts up to then; m; ln R/B as
// it is seen; exposure. Some two seconds of 30 frames a second. A frame is compared with the mean of the oldest few: the noise of a
// single one would come again and add up.
#define HISTORY_SPAN 64u
#define HISTORY_OLDEST 4u

// Measurement of a point, two vec4: the offset that gives it its reflectance of two seconds before, its weight, its texture, 1 if it
// is bright; and its motion, 0 if it is lost and else how sure its exposure is, 0...1, that exposure.
#define SAMPLE_OFFSET 0
#define SAMPLE_MOTION 1
#define SAMPLE_STRIDE 2

// ln R/B of a cell before it was corrected for the color of light: k, m of white.
float seen_color(vec4 cell, vec2 light) { return cell.z + cell.y * inversesqrt(3.0) + light.x * (cell.x - light.y); }

// Common motion at a place, `from` the frame's center (cells): a similarity.
vec2 common_motion(vec4 motion, vec2 from) { return motion.xy + motion.z * from + motion.w * vec2(-from.y, from.x); }

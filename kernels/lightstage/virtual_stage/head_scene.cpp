// SPDX-License-Identifier: LGPL-2.1-or-later
#include "head_scene.hpp"

#include <algorithm>
#include <cmath>

namespace inverse {
namespace {

constexpr float kSolid = shaders::lightstage_virtual_stage_surface::kSolid,
                kCarving = shaders::lightstage_virtual_stage_surface::kCarving;

struct Ellipsoid {
  std::array<float, 3> center, radii;
  float blend;
  HeadScene::Material material = HeadScene::skin;
  float tilt = 0;  ///< about x, radian: positive leans the top to the back
  float roll = 0;  ///< about z, radian: positive leans the top to the left
  float kind = kSolid;
};

void add(HeadScene& scene, const Ellipsoid& e) {
  const float ct = std::cos(e.tilt), st = std::sin(e.tilt);
  const float cr = std::cos(e.roll), sr = std::sin(e.roll);
  // Rows of the inverse rotation, each divided by its radius.
  const std::array<std::array<float, 3>, 3> rows = {
      {{cr, sr, 0}, {-sr * ct, cr * ct, -st}, {-sr * st, cr * st, ct}}};
  for (size_t i = 0; i < 3; ++i)
    scene.primitives.push_back(
        {rows[i][0] / e.radii[i], rows[i][1] / e.radii[i], rows[i][2] / e.radii[i], e.center[i]});
  const float radius = *std::min_element(e.radii.begin(), e.radii.end());
  scene.primitives.push_back({radius, e.blend, e.kind, static_cast<float>(e.material)});
}

/// Adds a mirrored pair on both sides of the face.
void add_pair(HeadScene& scene, Ellipsoid e) {
  add(scene, e);
  e.center[0] = -e.center[0];
  e.roll = -e.roll;
  add(scene, e);
}

HeadScene make_head() {
  using M = HeadScene::Material;
  HeadScene s;
  add(s, {{0, .25F, -.08F}, {.60F, .70F, .72F}, .05F});                  // skull
  add(s, {{0, -.20F, .10F}, {.46F, .60F, .52F}, .25F, M::skin, -.12F});  // face
  add(s, {{0, -.68F, .42F}, {.17F, .12F, .13F}, .20F});                  // chin
  add_pair(s, {{.28F, -.15F, .38F}, {.19F, .17F, .17F}, .18F});          // cheeks
  add(s, {{0, .19F, .53F}, {.36F, .08F, .11F}, .14F});                   // brow
  add(s, {{0, -.95F, -.12F}, {.31F, .60F, .33F}, .16F});                 // neck
  add_pair(s, {{.235F, .045F, .64F}, {.14F, .085F, .13F}, .10F, M::skin, 0, 0, kCarving});
  add(s, {{0, .02F, .62F}, {.065F, .22F, .11F}, .07F, M::skin, .30F});  // bridge of the nose
  add(s, {{0, -.135F, .745F}, {.085F, .075F, .095F}, .07F});            // its tip
  add_pair(s, {{.075F, -.155F, .66F}, {.055F, .05F, .075F}, .06F});     // and wings
  add_pair(s, {{.038F, -.21F, .705F}, {.022F, .03F, .035F}, .02F, M::skin, 0, 0, kCarving});
  add(s, {{0, -.30F, .57F}, {.035F, .08F, .06F}, .06F});  // below the nose
  add(s, {{0, -.355F, .575F}, {.155F, .03F, .07F}, .025F, M::lips});
  add(s, {{0, -.425F, .57F}, {.125F, .04F, .075F}, .025F, M::lips});
  add_pair(s, {{.235F, .045F, .475F}, {.115F, .115F, .115F}, .004F, M::eye});
  add_pair(s, {{.235F, .10F, .47F}, {.14F, .068F, .137F}, .02F, M::skin, .25F, -.08F});  // lids
  add_pair(s, {{.235F, -.035F, .47F}, {.13F, .045F, .12F}, .03F});
  add_pair(s, {{.60F, .03F, -.06F}, {.055F, .18F, .12F}, .04F, M::skin, .20F, -.12F});  // ears
  add_pair(s, {{.655F, .05F, -.02F}, {.04F, .11F, .065F}, .03F, M::skin, .20F, -.12F, kCarving});
  add(s, {{0, .42F, -.17F}, {.68F, .70F, .765F}, .02F, M::hair});
  add(s, {{0, -.05F, -.42F}, {.54F, .60F, .46F}, .10F, M::hair});  // down the neck
  add_pair(s, {{.22F, .235F, .60F}, {.13F, .022F, .05F}, .015F, M::hair, 0, .12F});  // brows
  add(s, {{0, -1.66F, -.20F}, {1.20F, .48F, .46F}, .08F, M::cloth});
  add(s, {{0, -1.23F, -.08F}, {.42F, .10F, .40F}, .05F, M::cloth});  // collar
  s.materials = {
      // albedo, roughness                 f0, texture, its scale
      {.58F, .36F, .27F, .42F},   {.028F, .10F, 22, 0},  // skin
      {.50F, .20F, .18F, .33F},   {.032F, .12F, 30, 0},  // lips
      {.11F, .062F, .035F, .38F}, {.046F, .45F, 14, 0},  // hair
      {.72F, .68F, .65F, .09F},   {.040F, 0, 1, 0},      // eyes
      {.06F, .12F, .24F, .80F},   {.040F, .22F, 40, 0},  // cloth
  };
  return s;
}

}  // namespace

const HeadScene& virtual_head() {
  static const HeadScene scene = make_head();
  return scene;
}

std::array<float, 3> HeadView::eye() const {
  return {distance * std::sin(turn), center, distance * std::cos(turn)};
}

HeadView view_of_camera(uint32_t camera) {
  constexpr float kApart = .35F;  // 20 degrees
  const uint32_t steps = (camera + 1) / 2;
  HeadView view;
  view.turn = (camera % 2 ? kApart : -kApart) * static_cast<float>(steps);
  return view;
}

}  // namespace inverse

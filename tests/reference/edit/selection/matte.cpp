// SPDX-License-Identifier: LGPL-2.1-or-later
#include "matte.hpp"

#include <algorithm>
#include <cmath>

#include "object.hpp"

namespace inverse::reference {
namespace {

enum Side { mixed, core, outside };

struct Border {
  bool border = false;
  Side side = mixed;
  Vec3 front{}, back{};
  bool has_front = false, has_back = false;
};

std::vector<Border> borders_of(const Plane& light, const std::vector<uint32_t>& region) {
  std::vector<Border> cells(region.size());
  const int width = light.width, height = light.height;
  // Shares of a square around a cell that are selected: all, none, or some of it.
  const auto around = [&](int x, int y, int reach) {
    int count = 0, selected = 0;
    for (int v = std::max(y - reach, 0); v <= std::min(y + reach, height - 1); ++v)
      for (int u = std::max(x - reach, 0); u <= std::min(x + reach, width - 1); ++u, ++count)
        selected += region[light.index(u, v)] != 0;
    return selected == count ? core : selected == 0 ? outside : mixed;
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      Border& cell = cells[light.index(x, y)];
      cell.side = around(x, y, 1);
      cell.border = around(x, y, 2) == mixed;
    }
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      Border& cell = cells[light.index(x, y)];
      if (!cell.border) continue;
      const auto mean = [&](Side side, Vec3& of) {
        double weight = 0;
        for (int v = std::max(y - 4, 0); v <= std::min(y + 4, height - 1); ++v)
          for (int u = std::max(x - 4, 0); u <= std::min(x + 4, width - 1); ++u) {
            if (cells[light.index(u, v)].side != side) continue;
            const double w = std::exp(-((u - x) * (u - x) + (v - y) * (v - y)) / 18.);
            weight += w;
            for (size_t c = 0; c < 3; ++c) of[c] += w * light.at(u, v)[c];
          }
        if (weight > 0)
          for (double& c : of) c /= weight;
        return weight > 0;
      };
      cell.has_front = mean(core, cell.front);
      cell.has_back = mean(outside, cell.back);
    }
  return cells;
}

}  // namespace

std::vector<uint32_t> covered_cells(const Plane& selection, int side) {
  Plane limited = selection;
  for (Vec4& pixel : limited.data) pixel[0] = std::min(pixel[0], 1.);
  const Plane means = cell_means(limited, side);
  std::vector<uint32_t> region;
  for (const Vec4& mean : means.data) region.push_back(mean[0] > .5);
  return region;
}

Plane matte(const Plane& frame, const Plane& reflectance, int side,
            const std::vector<double>& alpha, const std::vector<uint32_t>& region,
            const Plane* selection, const Plane* mask, const MatteSpec& spec) {
  const Plane light = cell_means(frame, side);
  const std::vector<Border> borders = borders_of(light, region);
  Plane result(frame.width, frame.height);
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) {
      const double u = std::clamp((x + .5) / side - .5, 0., light.width - 1.),
                   v = std::clamp((y + .5) / side - .5, 0., light.height - 1.);
      const int left = static_cast<int>(u), top = static_cast<int>(v);
      double border = 0, cover = 0, fronts = 0, backs = 0;
      Vec3 front{}, back{};
      for (int dy = 0; dy < 2; ++dy)
        for (int dx = 0; dx < 2; ++dx) {
          const double share = (dx ? u - left : 1 - u + left) * (dy ? v - top : 1 - v + top);
          const size_t n = light.index(std::min(left + dx, light.width - 1),
                                       std::min(top + dy, light.height - 1));
          const Border& cell = borders[n];
          if (!selection) cover += share * (cell.border ? alpha[n] : cell.side == core);
          if (!cell.border || !spec.soft) continue;
          border += share;
          fronts += share * cell.has_front;
          backs += share * cell.has_back;
          for (size_t c = 0; c < 3; ++c) {
            front[c] += share * cell.front[c];
            back[c] += share * cell.back[c];
          }
        }
      if (selection) cover = std::min(selection->at(x, y)[0], 1.);
      double matte = spec.soft || selection ? cover : cover > .5;
      Vec3 delta{};
      if (border > 0 && fronts > 0 && backs > 0) {
        const Vec4& seen = frame.at(x, y);
        double length2 = 0, along = 0, mean2 = 0;
        for (size_t c = 0; c < 3; ++c) {
          front[c] /= fronts, back[c] /= backs;
          length2 += std::pow(front[c] - back[c], 2);
          along += (seen[c] - back[c]) * (front[c] - back[c]);
          mean2 += std::pow((front[c] + back[c]) / 2, 2);
        }
        const double contrast = length2 / (length2 + .15 * .15 * mean2 + 1e-12);
        const double t = std::clamp((along / std::max(length2, 1e-12) - .1) / .8, 0., 1.);
        const double at_border = contrast * t + (1 - contrast) * cover;
        matte = cover + std::min(2 * border, 1.) * (at_border - cover);
        if (matte > 0 && matte < 1)
          for (size_t c = 0; c < 3; ++c) {
            const double paint = reflectance.at(x, y)[c], hidden = (spec.invert ? front : back)[c];
            delta[c] = contrast * (std::min(paint * hidden / std::max(seen[c], 1e-4), 4.) - paint);
          }
      }
      if (spec.invert) matte = 1 - matte;
      Vec4 before = mask ? mask->at(x, y) : Vec4{};
      const Vec3 known{before[1], before[2], before[3]};
      before[0] = std::min(before[0], 1.);
      switch (spec.combine) {
        case MatteSpec::replace:
          break;
        case MatteSpec::add:
          if (!(matte > before[0])) delta = known;
          matte = std::max(matte, before[0]);
          break;
        case MatteSpec::subtract:
          delta = 1 - matte < before[0] ? Vec3{} : known;
          matte = std::min(1 - matte, before[0]);
          break;
        case MatteSpec::intersect:
          if (!(matte < before[0])) delta = known;
          matte = std::min(matte, before[0]);
          break;
      }
      result.at(x, y) = {matte, delta[0], delta[1], delta[2]};
    }
  return result;
}

}  // namespace inverse::reference

// SPDX-License-Identifier: LGPL-2.1-or-later
#include "multigrid.hpp"

#include <algorithm>
#include <array>

namespace inverse::reference::multigrid {

Level::Level(int w, int h) : width(w), height(h) {
  for (auto* plane : {&right, &down, &mass, &f, &s, &cell_source, &cell_screening, &at_start})
    plane->assign(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 0.0);
}

double Level::diagonal(int x, int y) const {
  double d = mass[at(x, y)] + right[at(x, y)] + down[at(x, y)];
  if (x > 0) d += right[at(x - 1, y)];
  if (y > 0) d += down[at(x, y - 1)];
  return d;
}

double Level::residual(int x, int y) const {
  double r = f[at(x, y)] - diagonal(x, y) * s[at(x, y)];
  if (x > 0) r += right[at(x - 1, y)] * s[at(x - 1, y)];
  if (x + 1 < width) r += right[at(x, y)] * s[at(x + 1, y)];
  if (y > 0) r += down[at(x, y - 1)] * s[at(x, y - 1)];
  if (y + 1 < height) r += down[at(x, y)] * s[at(x, y + 1)];
  return r;
}

void solve_row(Level& l, int first, int y) {
  const int count = std::min(4, l.width - first);
  std::array<double, 4> gain{}, value{};
  for (int k = 0; k < count; ++k) {
    const int x = first + k;
    double f = l.f[l.at(x, y)] + l.cell_source[l.at(x, y)] +
               l.cell_screening[l.at(x, y)] * l.at_start[l.at(x, y)];
    if (y > 0) f += l.down[l.at(x, y - 1)] * l.s[l.at(x, y - 1)];
    if (y + 1 < l.height) f += l.down[l.at(x, y)] * l.s[l.at(x, y + 1)];
    if (k == 0 && x > 0) f += l.right[l.at(x - 1, y)] * l.s[l.at(x - 1, y)];
    if (k == 3 && x + 1 < l.width) f += l.right[l.at(x, y)] * l.s[l.at(x + 1, y)];
    const auto i = static_cast<std::size_t>(k);
    const double before = k > 0 ? l.right[l.at(x - 1, y)] : 0;
    const double pivot =
        l.diagonal(x, y) + l.cell_screening[l.at(x, y)] - (k > 0 ? before * gain[i - 1] : 0);
    gain[i] = (k + 1 < count ? l.right[l.at(x, y)] : 0) / pivot;
    value[i] = (f + (k > 0 ? before * value[i - 1] : 0)) / pivot;
  }
  for (int k = count - 1; k >= 0; --k) {
    const auto i = static_cast<std::size_t>(k);
    if (k + 1 < count) value[i] += gain[i] * value[i + 1];
    l.s[l.at(first + k, y)] = value[i];
  }
}

void smooth(Level& l, int color, int rows) {
  for (int by = 0; by * rows < l.height; ++by)
    for (int bx = (by + color) & 1; 4 * bx < l.width; bx += 2) {
      const int top = by * rows, bottom = std::min(l.height, top + rows);
      for (int y = top; y < bottom; ++y)  // screening acts about s at the start
        for (int x = 4 * bx; x < std::min(l.width, 4 * bx + 4); ++x)
          l.at_start[l.at(x, y)] = l.s[l.at(x, y)];
      for (int y = top; y < bottom; ++y) solve_row(l, 4 * bx, y);
      for (int y = bottom - 2; y >= top; --y) solve_row(l, 4 * bx, y);
    }
}

namespace {

/// The edge between two aggregates: the sum `crossing` of the edges that cross their border, in
/// series with half of what holds either together along the same direction, `before` and `after`.
/// At least the share `smallest` of the sum. A single pixel needs nothing to hold it together.
double in_series(double crossing, double before, double after, bool single, double smallest) {
  if (crossing <= 0) return 0;
  const double resistance = 1 / before + (single ? 0 : 1 / after);
  return crossing * std::max(smallest, 1 / (1 + 0.5 * crossing * resistance));
}

}  // namespace

Level coarsen(const Level& fine, double smallest) {
  Level c((fine.width + 1) / 2, (fine.height + 1) / 2);
  Level inside(c.width, c.height);
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x) {
      const std::size_t to = c.at(x / 2, y / 2), from = fine.at(x, y);
      c.mass[to] += fine.mass[from];
      (x % 2 == 1 ? c : inside).right[to] += fine.right[from];
      (y % 2 == 1 ? c : inside).down[to] += fine.down[from];
    }
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; ++x) {
      const std::size_t at = c.at(x, y);
      if (x + 1 < c.width)
        c.right[at] = in_series(c.right[at], inside.right[at], inside.right[at + 1],
                                2 * x + 3 == fine.width, smallest);
      const auto below = at + static_cast<std::size_t>(c.width);
      if (y + 1 < c.height)
        c.down[at] = in_series(c.down[at], inside.down[at], inside.down[below],
                               2 * y + 3 == fine.height, smallest);
    }
  return c;
}

std::vector<double> halve(const std::vector<double>& fine, int width, int height) {
  const int w = (width + 1) / 2, h = (height + 1) / 2;
  std::vector<double> coarse;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      double sum = 0;
      for (const int v : {2 * y, std::min(2 * y + 1, height - 1)})
        for (const int u : {2 * x, std::min(2 * x + 1, width - 1)})
          sum += fine[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(u)];
      coarse.push_back(sum / 4);
    }
  return coarse;
}

std::vector<Level> hierarchy(const Level& finest, const std::vector<double>& screening,
                             double scale) {
  std::vector<Level> levels{finest};
  while (levels.size() < 3 || levels.back().width * levels.back().height > 1) {
    levels.push_back(coarsen(levels.back(), scale));
    if (levels.size() == 3)
      for (std::size_t i = 0; i < screening.size(); ++i) levels.back().mass[i] += screening[i];
  }
  return levels;
}

namespace {

void restrict_to(const Level& fine, Level& coarse) {
  std::fill(coarse.f.begin(), coarse.f.end(), 0.0);
  std::fill(coarse.s.begin(), coarse.s.end(), 0.0);
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x) coarse.f[coarse.at(x / 2, y / 2)] += fine.residual(x, y);
}

void correct(Level& fine, const Level& coarse, int rows) {
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x) fine.s[fine.at(x, y)] += coarse.s[coarse.at(x / 2, y / 2)];
  smooth(fine, 1, rows);
  smooth(fine, 0, rows);
}

std::size_t packs_of(const Level& level) {
  return static_cast<std::size_t>((level.width + 3) / 4) * static_cast<std::size_t>(level.height);
}

void v_cycle(std::vector<Level>& levels, std::size_t k, std::size_t together) {
  Level& l = levels[k];
  const std::size_t packs = packs_of(l);
  std::size_t all = 0;
  for (std::size_t i = k; i < levels.size(); ++i) all += packs_of(levels[i]);
  const bool small = packs <= together && all <= kMaxTogether;
  const int rows = small ? 1 : 4;
  if (small) smooth(l, 0, rows);
  if (k + 1 == levels.size()) return;
  if (small) smooth(l, 1, rows);
  restrict_to(l, levels[k + 1]);
  v_cycle(levels, k + 1, together);
  correct(l, levels[k + 1], rows);
}

}  // namespace

namespace {

/// How much every pixel of a line counts in the mean of its cell of `size` (4 or 2) pixels.
std::vector<double> shares(int count, int size) {
  std::vector<double> share(static_cast<std::size_t>(count));
  for (int first = 0; first < count; first += size)
    for (int k = 0; k < size;
         ++k) {  // nested 2 x 2 means; indices past the border count as the last
      const int parent = std::min(first / 2 + k / 2, (count + 1) / 2 - 1);
      const int at =
          size == 4 ? std::min(2 * parent + k % 2, count - 1) : std::min(first + k, count - 1);
      share[static_cast<std::size_t>(at)] += 1.0 / size;
    }
  return share;
}

void share(const std::vector<double>& cells, int columns, int size, const Level& level,
           std::vector<double>& plane) {
  const auto horizontal = shares(level.width, size), vertical = shares(level.height, size);
  for (int y = 0; y < level.height; ++y)
    for (int x = 0; x < level.width; ++x)
      plane[level.at(x, y)] =
          cells[static_cast<std::size_t>(y / size) * static_cast<std::size_t>(columns) +
                static_cast<std::size_t>(x / size)] *
          horizontal[static_cast<std::size_t>(x)] * vertical[static_cast<std::size_t>(y)];
}

}  // namespace

void cycle(std::vector<Level>& levels, int cell_cycles, const CellTerms& terms,
           const std::vector<double>& screening, std::vector<double>& source,
           std::size_t together) {
  Level &l0 = levels[0], &l1 = levels[1], &l2 = levels[2];
  share(screening, l2.width, 4, l0, l0.cell_screening);
  share(screening, l2.width, 2, l1, l1.cell_screening);
  share(source, l2.width, 4, l0, l0.cell_source);
  share(source, l2.width, 2, l1, l1.cell_source);
  for (const int color : {0, 1}) smooth(l0, color, 4);
  restrict_to(l0, l1);
  std::vector<double> means = halve(l0.s, l0.width, l0.height);
  for (const int color : {0, 1}) smooth(l1, color, 4);
  restrict_to(l1, l2);
  for (std::size_t i = 0; i < means.size(); ++i) means[i] += l1.s[i];
  means = halve(means, l1.width, l1.height);
  const std::vector<double> far = l2.f;
  for (int k = 0; k < cell_cycles; ++k) {
    terms.before(far, means, l2);
    v_cycle(levels, 2, together);
  }
  source = terms.after(means, l2);
  share(source, l2.width, 4, l0, l0.cell_source);
  share(source, l2.width, 2, l1, l1.cell_source);
  correct(l1, l2, 4);
  correct(l0, l1, 4);
}

void Extrapolation::apply(int k, const std::vector<double>& start, std::vector<double>& s) {
  const double ratio = slowest_ / (2 - slowest_);
  if (k == 0) before_ = start;
  if (k > 0) w_ = 1 / (1 - ratio * ratio * w_ / (k == 1 ? 2 : 4));
  for (std::size_t i = 0; i < s.size(); ++i)
    s[i] = before_[i] + w_ * (2 / (2 - slowest_) * (s[i] - start[i]) + start[i] - before_[i]);
  before_ = start;
}

}  // namespace inverse::reference::multigrid

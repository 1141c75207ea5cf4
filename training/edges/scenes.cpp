// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scenes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "textures.hpp"

namespace inverse::training {
namespace {

// --- ray-traced rooms and yards ------------------------------------------------------------------

struct Solid {
  bool ball = false;
  Vec center{}, half{};
  double cosine = 1, sine = 0;  // rotation about y
  Texture texture;
};
struct Disc {
  Vec center;
  double radius;
};
struct Hit {
  double t = 1e9;
  Vec normal{};
  double u = 0, v = 0;
  const Texture* texture = nullptr;
};

struct World {
  std::vector<Solid> solids;
  std::vector<Disc> leaves;
  Vec leaf_normal{0, 1, 0};
  std::array<Texture, 4> walls;  // floor, back, left, right
  bool has_sides = true, has_back = true;
  double half_width = 2, depth = 5, height = 3;

  static bool solid_hit(const Solid& s, Vec o, Vec d, double limit, Hit* hit) {
    Vec p = o - s.center;
    if (s.ball) {
      const double b = dot(p, d), c = dot(p, p) - s.half[0] * s.half[0], q = b * b - c;
      if (q <= 0) return false;
      const double t = -b - std::sqrt(q);
      if (t < 1e-4 || t >= limit) return false;
      if (hit) {
        const Vec n = normalize(p + t * d);
        *hit = {t, n, std::atan2(n[2], n[0]) * s.half[0], n[1] * s.half[0] * 1.5, &s.texture};
      }
      return true;
    }
    const auto turn = [&](Vec a) {
      return Vec{s.cosine * a[0] + s.sine * a[2], a[1], -s.sine * a[0] + s.cosine * a[2]};
    };
    p = turn(p);
    const Vec e = turn(d);
    double near = -1e9, far = 1e9;
    int axis = 0;
    for (int k = 0; k < 3; ++k) {
      const std::size_t j = std::size_t(k);
      const double inverse = 1 / (std::abs(e[j]) < 1e-9 ? 1e-9 : e[j]);
      double a = (-s.half[j] - p[j]) * inverse, b = (s.half[j] - p[j]) * inverse;
      if (a > b) std::swap(a, b);
      if (a > near) near = a, axis = k;
      far = std::min(far, b);
    }
    if (near >= far || near < 1e-4 || near >= limit) return false;
    if (hit) {
      const Vec q = p + near * e;
      Vec n{};
      n[std::size_t(axis)] = e[std::size_t(axis)] > 0 ? -1 : 1;
      const Vec world{s.cosine * n[0] - s.sine * n[2], n[1], s.sine * n[0] + s.cosine * n[2]};
      *hit = {near, world, axis == 0 ? q[2] : q[0], axis == 1 ? q[2] : q[1], &s.texture};
    }
    return true;
  }

  bool blocked(Vec o, Vec d, double limit, bool leaves_too) const {
    for (const Solid& s : solids)
      if (solid_hit(s, o, d, limit, nullptr)) return true;
    if (has_sides && std::abs(d[0]) > 1e-6) {
      const double t = ((d[0] > 0 ? half_width : -half_width) - o[0]) / d[0];
      if (t > 1e-4 && t < limit && o[1] + t * d[1] < height) return true;
    }
    if (has_back && d[2] > 1e-6) {
      const double t = (depth - o[2]) / d[2];
      if (t > 1e-4 && t < limit && o[1] + t * d[1] < height) return true;
    }
    if (leaves_too)
      for (const Disc& l : leaves) {
        const double denominator = dot(leaf_normal, d);
        if (std::abs(denominator) < 1e-6) continue;
        const double t = dot(leaf_normal, l.center - o) / denominator;
        if (t < 1e-4 || t > limit) continue;
        const Vec q = o + t * d - l.center;
        if (dot(q, q) < l.radius * l.radius) return true;
      }
    return false;
  }

  Hit trace(Vec o, Vec d) const {
    Hit hit;
    const auto plane = [&](double t, Vec n, double u, double v, const Texture& texture) {
      if (t > 1e-4 && t < hit.t) hit = {t, n, u, v, &texture};
    };
    if (d[1] < -1e-9) {
      const double t = -o[1] / d[1];
      plane(t, {0, 1, 0}, o[0] + t * d[0], o[2] + t * d[2], walls[0]);
    }
    if (has_back && d[2] > 1e-9) {
      const double t = (depth - o[2]) / d[2];
      plane(t, {0, 0, -1}, o[0] + t * d[0], o[1] + t * d[1], walls[1]);
    }
    if (has_sides && std::abs(d[0]) > 1e-9) {
      const bool right = d[0] > 0;
      const double t = ((right ? half_width : -half_width) - o[0]) / d[0];
      plane(t, {right ? -1.0 : 1.0, 0, 0}, o[2] + t * d[2], o[1] + t * d[1], walls[right ? 3 : 2]);
    }
    for (const Solid& s : solids) solid_hit(s, o, d, hit.t, &hit);
    return hit;
  }
};

struct Buffers {
  int w, h;
  std::vector<Vec> reflectance, direct, ambient;  // ambient: occlusion in every channel
  std::vector<double> inside;
};

void render_room(Random& r, Buffers& out, double& ambient_level) {
  const Palette main = draw_palette(r);
  const Palette other = r.chance(0.6) ? main : draw_palette(r);
  World world;
  const double flat = r.uniform(0.2, 0.8);
  for (Texture& t : world.walls) t = draw_texture(r, r.chance(0.7) ? main : other, flat);
  world.has_sides = r.chance(0.6);
  world.half_width = r.uniform(1.4, 2.6);
  world.depth = r.uniform(3.5, 6);
  world.height = world.has_sides ? r.uniform(2, 4) : r.uniform(1.5, 4);
  const int solids = 2 + r.integer(7);
  for (int k = 0; k < solids; ++k) {
    Solid s;
    s.ball = r.chance(0.35);
    const double size = r.uniform(0.12, 0.5);
    s.half = s.ball ? Vec{size, size, size}
                    : Vec{size * r.uniform(0.5, 1.3), size * r.uniform(0.5, 2),
                          size * r.uniform(0.5, 1.3)};
    s.center = {r.uniform(-1.5, 1.5), s.half[1], r.uniform(1.8, world.depth - 0.4)};
    const double angle = r.uniform(0, 3);
    s.cosine = std::cos(angle), s.sine = std::sin(angle);
    s.texture = draw_texture(r, r.chance(0.6) ? main : other, flat);
    s.texture.scale *= 1.5;
    world.solids.push_back(s);
  }
  const int light = r.chance(0.45) ? 0 : 1 + r.integer(2);  // 0 sun, 1 area lamp, 2 small lamp
  const Vec sun = normalize({r.uniform(-1, 1), r.uniform(0.5, 1.6), r.uniform(-1.2, 0.1)});
  const Vec lamp{r.uniform(-1.2, 1.2), r.uniform(1.8, 2.8), r.uniform(0.3, 3)};
  const double spread = light == 0   ? r.uniform(0.002, 0.03)
                        : light == 1 ? r.uniform(0.2, 0.8)
                                     : r.uniform(0.02, 0.12);
  if (light == 0) world.has_sides = world.has_sides && r.chance(0.3);
  if (light == 0 && r.chance(0.4)) {  // dapple
    world.leaf_normal = sun;
    const int n = 20 + r.integer(80);
    for (int k = 0; k < n; ++k)
      world.leaves.push_back({Vec{r.uniform(-2, 2), 0, r.uniform(1, 6)} + r.uniform(3.5, 5) * sun,
                              r.uniform(0.05, 0.3)});
  }
  ambient_level = std::exp(r.uniform(std::log(0.06), std::log(0.6)));
  const Vec eye{r.uniform(-0.8, 0.8), r.uniform(0.6, 1.8), -0.2};
  const Vec forward =
      normalize(Vec{r.uniform(-0.4, 0.4), r.uniform(0.1, 0.7), r.uniform(2.5, 4)} - eye);
  const Vec right = normalize({forward[2], 0, -forward[0]});
  const Vec up{forward[1] * right[2], right[0] * forward[2] - right[2] * forward[0],
               -forward[1] * right[0]};
  const double zoom = r.uniform(0.35, 0.65);
  constexpr int kLightSamples = 12, kSkySamples = 8;
  for (int y = 0; y < out.h; ++y)
    for (int x = 0; x < out.w; ++x) {
      const std::size_t i = std::size_t(y) * out.w + x;
      const double px = (2 * (x + 0.5) / out.w - 1) * zoom,
                   py = (1 - 2 * (y + 0.5) / out.h) * zoom * out.h / out.w;
      const Vec d = normalize(forward + px * right + py * up);
      const Hit hit = world.trace(eye, d);
      if (!hit.texture) continue;
      out.inside[i] = 1;
      out.reflectance[i] = hit.texture->at(hit.u, hit.v);
      const Vec p = eye + hit.t * d + 1e-3 * hit.normal;
      double direct = 0;
      for (int k = 0; k < kLightSamples; ++k) {
        const double a = r.uniform(0, 6.2832),
                     q = spread * std::sqrt((k + r.uniform()) / kLightSamples);
        const Vec offset{q * std::cos(a), 0, q * std::sin(a)};
        const Vec to = light == 0 ? sun + offset : lamp + offset - p;
        const double distance = light == 0 ? 1e6 : std::sqrt(dot(to, to));
        const Vec l = normalize(to);
        const double cosine = dot(hit.normal, l);
        if (cosine <= 0 || world.blocked(p, l, distance, true)) continue;
        direct += cosine * (light == 0 ? 1 : 4 * std::max(0.05, l[1]) / (distance * distance));
      }
      direct /= kLightSamples;
      double sky = 0;
      for (int k = 0; k < kSkySamples; ++k) {
        const double a = 6.2832 * (k + r.uniform()) / kSkySamples, z = 2 * r.uniform() - 1,
                     q = std::sqrt(1 - z * z);
        const Vec l = normalize(hit.normal + Vec{q * std::cos(a), z, q * std::sin(a)});
        if (!world.blocked(p, l, light == 0 ? 1e6 : 1.5, false)) sky += 1;
      }
      sky /= kSkySamples;
      for (std::size_t c = 0; c < 3; ++c) out.direct[i][c] = direct, out.ambient[i][c] = sky;
    }
}

// --- painted objects on black --------------------------------------------------------------------

void render_object(Random& r, Buffers& out, double& ambient_level) {
  const int w = out.w, h = out.h;
  const Palette palette = draw_palette(r);
  const Texture paint = draw_texture(r, palette, 0.25);
  const Texture patches = draw_texture(r, palette, 0.5);
  struct Bump {
    double x, y, rx, ry, z;
  };
  std::vector<Bump> bumps;
  const int n = 1 + r.integer(6);
  for (int k = 0; k < n; ++k)
    bumps.push_back({r.uniform(0.3, 0.7) * w, r.uniform(0.3, 0.7) * h, r.uniform(0.12, 0.4) * w,
                     r.uniform(0.12, 0.45) * h, r.uniform(0.3, 1)});
  const bool flat_faces = r.chance(0.3);
  const double crease = r.uniform(0, 1.2), crease_scale = r.uniform(2, 9) / w;
  const int seed = r.integer(1 << 20);
  std::vector<double> z(std::size_t(w) * h, -1);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      double top = -1;
      for (const Bump& b : bumps) {
        const double dx = (x - b.x) / b.rx, dy = (y - b.y) / b.ry,
                     q = flat_faces ? std::max(std::abs(dx), std::abs(dy))
                                    : std::sqrt(dx * dx + dy * dy);
        if (q >= 1) continue;
        const double scale = b.z * std::min(b.rx, b.ry);
        top = std::max(top, flat_faces ? scale * (1 - 0.7 * q) : scale * std::sqrt(1 - q * q));
      }
      if (top >= 0)
        top += crease * 0.06 * w * value_noise(x * crease_scale, y * crease_scale, seed);
      z[std::size_t(y) * w + x] = top;
    }
  ambient_level = r.uniform(0.02, 0.25);
  const Vec l = normalize({r.uniform(-1.2, 1.2), r.uniform(-1.2, 0.4), r.uniform(0.3, 1.2)});
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const std::size_t i = std::size_t(y) * w + x;
      if (z[i] < 0) continue;
      const auto height = [&](int xx, int yy) {
        xx = std::clamp(xx, 0, w - 1), yy = std::clamp(yy, 0, h - 1);
        const double v = z[std::size_t(yy) * w + xx];
        return v < 0 ? z[i] - 2.0 : v;
      };
      const auto slope = [&](double a, double b) { return std::abs(a) < std::abs(b) ? a : b; };
      const double gx = slope(height(x + 1, y) - z[i], z[i] - height(x - 1, y));
      const double gy = slope(height(x, y + 1) - z[i], z[i] - height(x, y - 1));
      const Vec normal = normalize({-gx, -gy, 1});
      bool shadow = false;
      for (double t = 1.5; t < 0.6 * w && !shadow; t += 1.5) {
        const int sx = int(x + t * l[0]), sy = int(y + t * l[1]);
        if (sx < 0 || sy < 0 || sx >= w || sy >= h) break;
        shadow = z[std::size_t(sy) * w + sx] > z[i] + t * l[2] + 0.5;
      }
      const double direct = shadow ? 0 : std::max(0.0, dot(normal, l));
      out.inside[i] = 1;
      const double u = 3.0 * x / w, v = 3.0 * y / w;
      const double tall = patches.kind == 0 ? 0 : value_noise(1.5 * u, 1.5 * v, seed + 5);
      out.reflectance[i] = tall > 0.55 ? patches.at(u, v) : paint.at(u, v);
      for (std::size_t c = 0; c < 3; ++c)
        out.direct[i][c] = direct, out.ambient[i][c] = 0.5 + 0.5 * normal[2];
    }
}

/// Box blur applied three times: a stand-in for the far-reaching first bounce.
std::vector<Vec> wide_blur(std::vector<Vec> v, int w, int h, int radius) {
  std::vector<Vec> t(v.size());
  for (int pass = 0; pass < 3; ++pass) {
    for (int axis = 0; axis < 2; ++axis) {
      const int n = axis ? h : w, lines = axis ? w : h, step = axis ? w : 1;
      for (int line = 0; line < lines; ++line) {
        const std::size_t base = std::size_t(line) * (axis ? 1 : w);
        Vec sum{};
        for (int k = -radius; k < n; ++k) {
          const auto in = [&](int q) {
            return v[base + std::size_t(std::clamp(q, 0, n - 1)) * step];
          };
          if (k == -radius) {
            sum = {};
            for (int q = -radius; q <= radius; ++q) sum = sum + in(q);
            k = 0;
          } else {
            sum = sum + in(k + radius) - in(k - radius - 1);
          }
          t[base + std::size_t(k) * step] = (1.0 / (2 * radius + 1)) * sum;
        }
      }
      std::swap(v, t);
    }
  }
  return v;
}

// --- colored light -------------------------------------------------------------------------------

constexpr double kColoredShare = 0.7, kMinApart = 0.2, kMaxApart = 1.4;
constexpr double kColoredStudio = 0.3;  // of objects on black: mostly lit by lamps of one kind

/// Colors of direct light, of fill light, and of what bounces off surroundings that are not in
/// view; `slope` comes on top: the logarithm of channel c gains slope d_c times its mean.
struct Lights {
  bool colored = false;
  double slope = 0;
  Vec direct{1, 1, 1}, fill{1, 1, 1}, bounce{1, 1, 1};
};

/// A light whose ln R - ln B is `blue_yellow`; green is off that axis a little.
Vec light_color(Random& r, double blue_yellow) {
  return {std::exp(0.5 * blue_yellow), std::exp(0.04 * r.normal()), std::exp(-0.5 * blue_yellow)};
}

Lights draw_lights(Random& r, double colored_share) {
  Lights l;
  l.colored = r.chance(colored_share);
  if (!l.colored) return l;
  const double apart = r.uniform(kMinApart, kMaxApart) * (r.chance(0.5) ? 1 : -1);
  l.direct = light_color(r, 0), l.fill = light_color(r, -apart);
  if (r.chance(0.4)) l.bounce = light_color(r, r.uniform(0, 0.8));  // wood, brick, skin
  if (r.chance(0.6)) l.slope = std::clamp(0.45 * r.normal(), -1.0, 1.0);
  return l;
}

void add_slope(double slope, std::vector<Vec>& image, std::vector<Vec>& shade) {
  for (std::size_t i = 0; i < shade.size(); ++i) {
    double log = 0;
    for (double v : shade[i]) log += std::log(v + 1e-4) / 3;
    for (std::size_t c : {0, 2}) {
      const double gain = std::exp(slope * (c == 0 ? 0.5 : -0.5) * log);
      image[i][c] *= gain, shade[i][c] *= gain;
    }
  }
}

/// Divides by the color of the brightest light, as cameras do, with an error.
void balance_white(Random& r, std::vector<Vec>& image, std::vector<Vec>& shade,
                   const bench::Image& mask) {
  std::vector<double> levels;
  for (std::size_t i = 0; i < shade.size(); ++i)
    if (mask.data[i] > 0) levels.push_back(shade[i][0] + shade[i][1] + shade[i][2]);
  if (levels.empty()) return;
  const auto bright = levels.begin() + std::ptrdiff_t(double(levels.size()) * 0.95);
  std::nth_element(levels.begin(), bright, levels.end());
  Vec sum{};
  for (std::size_t i = 0; i < shade.size(); ++i)
    if (mask.data[i] > 0 && shade[i][0] + shade[i][1] + shade[i][2] >= *bright)
      sum = sum + shade[i];
  const Vec off = light_color(r, 0.12 * r.normal());
  for (std::size_t c = 0; c < 3; ++c) {
    const double gain = off[c] * (sum[0] + sum[1] + sum[2]) / std::max(3 * sum[c], 1e-9);
    for (std::size_t i = 0; i < shade.size(); ++i) image[i][c] *= gain, shade[i][c] *= gain;
  }
}

double to_srgb(double v) {
  return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}
double from_srgb(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }

}  // namespace

Scene make_scene(std::uint32_t seed, int width, int height) {
  constexpr int kSuper = 2;
  Random r{std::mt19937(seed * 7919U + 13U)};
  Buffers b{width * kSuper, height * kSuper, {}, {}, {}, {}};
  const std::size_t n = std::size_t(b.w) * b.h;
  b.reflectance.resize(n), b.direct.resize(n), b.ambient.resize(n), b.inside.resize(n);
  double ambient_level = 0.1;
  const bool object = r.chance(0.25);
  object ? render_object(r, b, ambient_level) : render_room(r, b, ambient_level);
  const Lights lights = draw_lights(r, object ? kColoredStudio : kColoredShare);
  std::vector<double> open(n);  // to ambient light
  for (std::size_t i = 0; i < n; ++i) open[i] = b.ambient[i][0];
  std::vector<Vec> radiance(n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      b.direct[i][c] *= lights.direct[c], b.ambient[i][c] *= lights.fill[c];
      radiance[i][c] = b.reflectance[i][c] * (b.direct[i][c] + ambient_level * b.ambient[i][c]);
    }
  const std::vector<Vec> bounce = wide_blur(radiance, b.w, b.h, b.w / 10);
  const double bounce_level = object ? r.uniform(0, 0.2) : r.uniform(0.1, 0.7);

  Scene s{bench::Image(width, height, 3), bench::Image(width, height, 3),
          bench::Image(width, height, 3), bench::Image(width, height, 1)};
  std::vector<Vec> image(std::size_t(width) * height), albedo(image.size()), shade(image.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t o = std::size_t(y) * width + x;
      double inside = 1;
      for (int k = 0; k < kSuper * kSuper; ++k) {
        const std::size_t i =
            std::size_t(y * kSuper + k / kSuper) * b.w + std::size_t(x * kSuper + k % kSuper);
        inside = std::min(inside, b.inside[i]);
        for (std::size_t c = 0; c < 3; ++c) {
          const double e = b.direct[i][c] + b.ambient[i][c] * ambient_level +
                           open[i] * lights.bounce[c] * bounce_level * bounce[i][c];
          image[o][c] += 0.25 * b.reflectance[i][c] * e;
          albedo[o][c] += 0.25 * b.reflectance[i][c];
          shade[o][c] += 0.25 * e;
        }
      }
      s.mask.data[o] = inside > 0 ? 1.0F : 0.0F;
    }
  if (r.chance(0.6)) {  // a wider pixel filter, as renderers and lenses have
    const double side = r.uniform(0.08, 0.25);
    for (auto* plane : {&image, &albedo, &shade}) {
      std::vector<Vec> t = *plane;
      for (int pass = 0; pass < 2; ++pass) {
        const int dx = pass ? 0 : 1, dy = pass ? 1 : 0;
        for (int y = 0; y < height; ++y)
          for (int x = 0; x < width; ++x) {
            const auto at = [&](int xx, int yy) {
              return (*plane)[std::size_t(std::clamp(yy, 0, height - 1)) * width +
                              std::size_t(std::clamp(xx, 0, width - 1))];
            };
            t[std::size_t(y) * width + x] =
                (1 - 2 * side) * at(x, y) + side * (at(x - dx, y - dy) + at(x + dx, y + dy));
          }
        *plane = t;
      }
    }
  }
  if (lights.colored) {
    add_slope(lights.slope, image, shade);
    balance_white(r, image, shade, s.mask);
  }
  std::vector<double> peaks;
  for (const Vec& v : image) peaks.push_back(std::max({v[0], v[1], v[2]}));
  std::nth_element(peaks.begin(), peaks.begin() + std::ptrdiff_t(double(peaks.size()) * 0.99),
                   peaks.end());
  const double exposure =
      r.uniform(0.55, 1.1) / std::max(1e-6, peaks[std::size_t(double(peaks.size()) * 0.99)]);
  const double noise = r.chance(0.5) ? 0 : r.uniform(0.001, 0.012);
  for (std::size_t o = 0; o < image.size(); ++o) {
    for (std::size_t c = 0; c < 3; ++c) {
      double v = exposure * image[o][c];
      v += noise * std::sqrt(std::max(v, 0.0) + 0.002) *
           (r.uniform() + r.uniform() + r.uniform() + r.uniform() - 2) * 1.7;
      v = from_srgb(std::round(255 * to_srgb(std::clamp(v, 0.0, 1.0))) / 255);
      s.input.data[o * 3 + c] = float(v);
      s.reflectance.data[o * 3 + c] = float(albedo[o][c]);
      s.shading.data[o * 3 + c] = float(exposure * shade[o][c]);
    }
  }
  return s;
}

}  // namespace inverse::training

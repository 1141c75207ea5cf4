// SPDX-License-Identifier: LGPL-2.1-or-later
// Cosine lobes of pixels under two gradients against the equations, and what they are worth on
// subjects that are known.
#include "common/error.hpp"
#include "reflectance_field_fixture.hpp"
#include "tests/differences.hpp"

namespace inverse::testing {
namespace {

using reference::dot, reference::Vec3;

double lambert(const Vec3& n, const Vec3& w) { return std::max(0.0, dot(n, w)); }

class CosineLobeTest : public ReflectanceFieldTest {
 protected:
  void SetUp() override {
    GpuTest::SetUp();
    use_stage(geodesic_directions(331));
  }
  struct Found {
    Pixels full, lobes;
  };
  Found find(CosineLobe& method, const Pair& pair, float noise = 1e-6F) {
    const Plane a = plane(pair.extent(), pair.a), b = plane(pair.extent(), pair.b);
    run([&](gpu::Commands& commands) { method.record_lobes(commands, {a, b}, {noise}); });
    return {download(method.full()), download(method.lobes())};
  }
  /// The subject under lights, as the sum over them and by the table of lobes.
  struct Relit {
    Pixels summed, looked_up;
  };
  Relit relit(CosineLobe& method, Extent extent, const std::vector<WeightedLight>& lights) {
    const Plane sum = plane(extent), table = plane(extent);
    run([&](gpu::Commands& commands) {
      method.record_sum(commands, lights, sum);
      method.record_lights(commands, lights);
      method.record_relit(commands, table);
    });
    return {download(sum), download(table)};
  }
  /// Pixels whose gradients are noise, of any length and sign that a camera can give.
  Pair noise(size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> value(0, 1);
    Pair pair;
    for (size_t i = 0; i < count; ++i) {
      const Vec3 u = any_direction(random);
      const double size = value(random);
      Vec3 a, b;
      for (size_t c = 0; c < 3; ++c) {
        const double f = value(random) + 1e-3;
        a[c] = f * (1 + size * u[c]) / 2;
        b[c] = f * (1 - size * u[c]) / 2;
      }
      pair.add(a, b);
    }
    return pair;
  }
};

}  // namespace

TEST_F(CosineLobeTest, ALambertianSphereShowsItsNormals) {
  Pair pair;
  std::vector<Vec3> normals;
  double plain = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 60; ++x) {
      const double px = (x + .5) / 30 - 1, py = 1 - (y + .5) / 30, r2 = px * px + py * py;
      if (r2 >= 1) continue;
      const Vec3 n{px, py, std::sqrt(1 - r2)};
      const Vec3 albedo{.002 + .001 * px, .001, .0005 + .0004 * py};
      const auto [a, b] = gradients([&](const Vec3& w) {
        const double l = lambert(n, w);
        return Vec3{albedo[0] * l, albedo[1] * l, albedo[2] * l};
      });
      pair.add(a, b);
      normals.push_back(n);
      update_max(plain, degrees(reference::mean_direction(a, b, 0), n));
    }
  CosineLobe method = lobe_method(pair.extent());
  const Found got = find(method, pair);
  double worst = 0, mean = 0, exponent = 0;
  for (size_t i = 0; i < normals.size(); ++i) {
    const auto lobe = found(got.full, got.lobes, i);
    const double off = degrees(lobe.direction, normals[i]);
    update_max(worst, off);
    mean += off / static_cast<double>(normals.size());
    update_max(exponent, std::fabs(lobe.exponent - 1));
  }
  RecordProperty("degrees_uncorrected", std::to_string(plain));
  RecordProperty("degrees_worst", std::to_string(worst));
  RecordProperty("degrees_mean", std::to_string(mean));
  printf("direction: mean %.3f, worst %.3f degrees (%.1f without the correction); exponent %.3f\n",
         mean, worst, plain, exponent);
  EXPECT_LT(worst, 1);
  EXPECT_GT(plain, 5) << "the floor that is missing matters";
  EXPECT_LT(exponent, .1) << "Lambert is 1";
}

TEST_F(CosineLobeTest, LobesOfOtherExponentsAreFoundToo) {
  std::mt19937 random(3);
  for (const uint32_t count : {331u, 362u, 92u}) {
    use_stage(geodesic_directions(count));
    for (const double p : {.25, .5, 1.0, 2.0, 5.0, 12.0}) {
      Pair pair;
      std::vector<Vec3> axes;
      for (int i = 0; i < 200; ++i) {
        Vec3 u = any_direction(random);
        u[1] = std::fabs(u[1]);  // towards where there are lights
        const auto [a, b] = gradients([&](const Vec3& w) {
          const double l = std::pow(lambert(u, w), p) * .01;
          return Vec3{l, l, l};
        });
        pair.add(a, b);
        axes.push_back(u);
      }
      CosineLobe method = lobe_method(pair.extent());
      const Found got = find(method, pair);
      for (size_t i = 0; i < axes.size(); ++i) {
        const auto lobe = found(got.full, got.lobes, i);
        EXPECT_LT(degrees(lobe.direction, axes[i]), (p < .5 ? 2 : 1.5) * (count == 92 ? 2.2 : 1))
            << count << " " << p;
        // Near 1/2, |v| says little of p.
        EXPECT_NEAR(std::log2(lobe.exponent + 1), std::log2(p + 1),
                    p < .5 || count == 92 ? .35 : .1)
            << count << " " << p;
      }
    }
  }
}

TEST_F(CosineLobeTest, TheTableOfMomentsIsTheSolution) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> value(0, 1);
  for (const uint32_t count : {331u, 362u, 92u}) {
    use_stage(geodesic_directions(count));
    double worst = 0;
    for (int i = 0; i < 2000; ++i) {
      Vec3 v = any_direction(random);
      // Narrower lobes fall between single lights, those to the floor beside all of them.
      // Of broad ones, lights come into view one by one.
      const double size = .6 + .25 * value(random);
      if (v[1] < -.5) v[1] = -v[1];
      for (double& x : v) x *= size;
      const Vec3 seen = reference::seen_mean(v, stage);
      update_max(worst, max_difference(moments->even(seen, seen), v));
    }
    EXPECT_LT(worst, count == 92 ? .05 : .01) << count;
  }
}

TEST_F(CosineLobeTest, PixelsFollowTheEquations) {
  const Pair pair = noise(3000, 7);
  CosineLobe method = lobe_method(pair.extent());
  const float floor = .05F;
  const Found got = find(method, pair, floor);
  for (size_t i = 0; i < pair.extent().pixels(); ++i) {
    Vec3 a, b, full;
    for (size_t c = 0; c < 3; ++c) {
      a[c] = pair.a[4 * i + c];
      b[c] = pair.b[4 * i + c];
      full[c] = a[c] + b[c];
    }
    const Vec3 m = reference::mean_direction(a, b, floor);
    // The table as it is, between its points.
    constexpr int kGrid = LobeMoments::kGrid;
    Vec3 v = m;
    std::array<int, 3> cell;
    Vec3 f;
    for (size_t k = 0; k < 3; ++k) {
      const double at = (m[k] + 1) / 2 * (kGrid - 1);
      cell[k] = std::min(static_cast<int>(at), kGrid - 2);
      f[k] = at - cell[k];
    }
    for (int corner = 0; corner < 8; ++corner) {
      const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
      const auto& entry = moments->table()[static_cast<size_t>(
          ((cell[2] + z) * kGrid + cell[1] + y) * kGrid + cell[0] + x)];
      const double weight = (x ? f[0] : 1 - f[0]) * (y ? f[1] : 1 - f[1]) * (z ? f[2] : 1 - f[2]);
      for (size_t k = 0; k < 3; ++k) v[k] += weight * entry[k];
    }
    const auto expected = reference::lobe_of(full, v, stage);
    const auto lobe = found(got.full, got.lobes, i);
    ASSERT_NEAR(lobe.share, expected.share, 2e-4) << i;
    // Where the lobe is narrow its exponent is the inverse of what is left of 1.
    ASSERT_NEAR(std::log2(lobe.exponent + 1), std::log2(expected.exponent + 1), 2e-3) << i;
    if (expected.share > .05) {
      ASSERT_LT(degrees(lobe.direction, expected.direction), .05) << i;
    }
    for (size_t c = 0; c < 3; ++c) ASSERT_NEAR(lobe.full[c], full[c], 1e-6);
    ASSERT_EQ(got.full[4 * i + 3], .5F) << "alpha of A";
  }
}

TEST_F(CosineLobeTest, SumsAndTablesGiveWhatTheEquationsSay) {
  const Pair pair = noise(1500, 11);
  CosineLobe method = lobe_method(pair.extent());
  const Found got = find(method, pair);
  std::mt19937 random(13);
  std::uniform_real_distribution<float> value(0, 4);
  for (const size_t count : {1u, 7u, 331u}) {
    std::vector<WeightedLight> lights;
    std::vector<reference::Lamp> lamps;
    for (size_t i = 0; i < count; ++i) {
      const Direction w = count == 331 ? directions[i] : any_direction(random);
      const Rgb weight{value(random), value(random), value(random)};
      lights.push_back({w, weight});
      lamps.push_back({w, {weight[0], weight[1], weight[2]}});
    }
    const auto [summed, looked] = relit(method, pair.extent(), lights);
    double difference = 0, off = 0, total = 0;
    for (size_t i = 0; i < pair.extent().pixels(); ++i) {
      const Vec3 expected = reference::relit(found(got.full, got.lobes, i), lamps, stage);
      for (size_t c = 0; c < 3; ++c) {
        // 1/S is from the table in both; narrow lobes make it swing from light to light.
        ASSERT_NEAR(summed[4 * i + c], expected[c], .15 * expected[c] + 1e-4) << count << " " << i;
        off += std::fabs(summed[4 * i + c] - expected[c]);
        difference += std::fabs(looked[4 * i + c] - expected[c]);
        total += expected[c];
      }
      ASSERT_EQ(looked[4 * i + 3], .5F);
    }
    printf("%zu lights: the table is off by %.4f of the mean, the sum by %.4f\n", count,
           difference / total, off / total);
    EXPECT_LT(off / total, .01);
    EXPECT_LT(difference / total, count == 331 ? .005 : .03) << count;
  }
}

TEST_F(CosineLobeTest, AllLightsTogetherGiveTheSubjectUnderAllLights) {
  const Pair pair = noise(2000, 17);
  CosineLobe method = lobe_method(pair.extent());
  const Found got = find(method, pair);
  std::vector<WeightedLight> lights;
  for (const Direction& w : directions) lights.push_back({w, {1, 1, 1}});
  const auto [summed, looked] = relit(method, pair.extent(), lights);
  for (size_t i = 0; i < pair.extent().pixels(); ++i) {
    const auto lobe = found(got.full, got.lobes, i);
    if (lobe.direction[1] < -.6) continue;  // it faces the floor, where lights are too few
    for (size_t c = 0; c < 3; ++c) {
      ASSERT_NEAR(summed[4 * i + c], lobe.full[c], .15 * lobe.full[c] + 1e-5) << i;
      ASSERT_NEAR(looked[4 * i + c], lobe.full[c], 1e-3 * lobe.full[c] + 1e-5) << i;
    }
  }
}

TEST_F(CosineLobeTest, LightAddsUp) {
  const Pair pair = noise(800, 19);
  CosineLobe method = lobe_method(pair.extent());
  find(method, pair);
  std::mt19937 random(23);
  std::uniform_real_distribution<float> value(0, 4);
  std::vector<WeightedLight> one, other, both;
  for (const Direction& w : directions) {
    const Rgb a{value(random), value(random), value(random)}, b{value(random), 0, value(random)};
    one.push_back({w, a});
    other.push_back({w, b});
    both.push_back({w, {a[0] + b[0], a[1] + b[1], a[2] + b[2]}});
  }
  std::vector<Pixels> got;
  for (const auto& lights : {one, other, both})
    got.push_back(relit(method, pair.extent(), lights).looked_up);
  for (size_t i = 0; i < got[0].size(); ++i) {
    if (i % 4 == 3) continue;
    ASSERT_NEAR(got[0][i] + got[1][i], got[2][i], 2e-5 * got[2][i] + 1e-7);
  }
}

TEST_F(CosineLobeTest, NonFiniteValuesDoNotSpread) {
  const std::array<float, 9> values{0, kNan, kInf, -kInf, -1, 1e-30F, 1, 65504, 1e38F};
  Pair pair;
  for (const float x : values)
    for (const float y : values)
      for (const float z : values) {
        pair.a.insert(pair.a.end(), {x, y, z, kNan});
        pair.b.insert(pair.b.end(), {z, x, y, 1});
      }
  for (const uint32_t count : {1u, 6u, 331u}) {
    use_stage(geodesic_directions(count));
    CosineLobe method = lobe_method(pair.extent());
    const Found got = find(method, pair, kNan);
    const Plane target = plane(pair.extent());
    std::vector<WeightedLight> lights;
    for (const Direction& w : directions) lights.push_back({w, {1, 0, 2}});
    const auto [summed, looked_up] = relit(method, pair.extent(), lights);
    run([&](gpu::Commands& commands) { method.record_directions(commands, {}, target); });
    for (const Pixels& pixels : {got.full, got.lobes, summed, looked_up, download(target)})
      ASSERT_TRUE(all_finite(pixels)) << count;
  }
}

TEST_F(CosineLobeTest, BlackPixelsStayBlackAndHaveNoDirection) {
  Pair pair;
  pair.add({0, 0, 0}, {0, 0, 0});
  pair.add({1e-5, 0, 0}, {0, 1e-5, 0});  // noise
  CosineLobe method = lobe_method(pair.extent());
  const Found got = find(method, pair, .002F);
  for (size_t i = 0; i < 2; ++i) EXPECT_LT(found(got.full, got.lobes, i).share, .45) << i;
  const Plane target = plane(pair.extent());
  run([&](gpu::Commands& commands) { method.record_directions(commands, {}, target); });
  for (const float v : {0, 1, 2}) EXPECT_EQ(download(target)[static_cast<size_t>(v)], 0);
}

TEST_F(CosineLobeTest, PicturesMayLieSideBySide) {
  const Extent extent{33, 7}, wide{66, 7};
  const Pixels both = random_pixels(wide, 29, 0, 1);
  Pixels a, b;
  for (uint32_t y = 0; y < 7; ++y)
    for (uint32_t x = 0; x < 66; ++x)
      (x < 33 ? a : b)
          .insert((x < 33 ? a : b).end(), &both[4 * (y * 66 + x)], &both[4 * (y * 66 + x)] + 4);
  CosineLobe method = lobe_method(extent);
  const Plane plane_a = plane(extent, a), plane_b = plane(extent, b), beside = plane(wide, both);
  run([&](gpu::Commands& commands) { method.record_lobes(commands, {plane_a, plane_b}, {}); });
  const Pixels apart = download(method.lobes());
  run([&](gpu::Commands& commands) { method.record_lobes(commands, {beside, beside, 33}, {}); });
  EXPECT_EQ(download(method.lobes()), apart);
}

TEST_F(CosineLobeTest, ResponsesAreThoseOfSingleLights) {
  const Pair pair = noise(64, 31);
  CosineLobe method = lobe_method(pair.extent());
  find(method, pair);
  std::vector<uint32_t> samples{0, 5, 63, 17};
  const auto words = upload(gpu::Element::word, samples.data(), samples.size());
  const auto responses = gpu::Buffer::create(device, gpu::Element::vec4, 4 * directions.size());
  const Plane target = plane(pair.extent());
  const WeightedLight light{directions[40], {1, 1, 1}};
  run([&](gpu::Commands& commands) {
    method.record_responses(commands, words, responses);
    method.record_sum(commands, std::span(&light, 1), target);
  });
  const Pixels got = download(responses), whole = download(target);
  for (size_t k = 0; k < 4; ++k)
    for (size_t c = 0; c < 3; ++c)
      ASSERT_NEAR(got[4 * (k * directions.size() + 40) + c], whole[4 * samples[k] + c], 1e-6);
}

}  // namespace inverse::testing

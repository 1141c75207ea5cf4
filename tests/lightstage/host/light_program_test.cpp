// SPDX-License-Identifier: LGPL-2.1-or-later
// Light programs: their state at each trigger, and errors of invalid files.
#include "kernels/lightstage/program/light_program.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

#include "common/error.hpp"
#include "kernels/lightstage/program/light_list.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse {
namespace {

using Part = LightProgram::Position::Part;

std::string parse_error(const std::string& json) {
  return testing::error_of([&] { LightProgram::parse(json, "program"); }, ErrorKind::file);
}

/// A program of two lights with these fields after its own.
std::string with(const std::string& lights, const std::string& steps,
                 const std::string& more = "") {
  return R"({"format": "gst-inverse light program", "version": 1, "rate": 60, )" + more +
         R"("lights": [)" + lights + R"(], "steps": [)" + steps + "]}";
}
const std::string kTwo = R"({"direction": [0, 0, 1]}, {"direction": [0.6, 0.8, 0]})";
const std::string kBlack = R"({"kind": "black"})";

TEST(LightProgram, GeodesicStages) {
  for (const uint32_t count : {1U, 12U, 42U, 96U, 331U, 362U, 1301U}) {
    const auto directions = geodesic_directions(count);
    ASSERT_EQ(directions.size(), count);
    double nearest = 2;
    for (size_t i = 0; i < count; ++i) {
      const auto& d = directions[i];
      EXPECT_NEAR(d[0] * d[0] + d[1] * d[1] + d[2] * d[2], 1, 1e-12);
      for (size_t j = 0; j < i; ++j)
        nearest = std::min(nearest, std::hypot(d[0] - directions[j][0], d[1] - directions[j][1],
                                               d[2] - directions[j][2]));
    }
    // Even: none nearer to another than .6 of what a hexagonal grid on the sphere has.
    const double even = std::sqrt(8 * std::numbers::pi / (std::sqrt(3.0) * std::max(count, 12U)));
    if (count > 1) {
      EXPECT_GT(nearest, 0.6 * even) << count;
    }
  }
  const auto stage = geodesic_directions(331);
  EXPECT_NEAR(stage.front()[1], 1, 1e-12);
  EXPECT_GT(stage.back()[1], -0.95);  // the floor
}

TEST(LightProgram, ChannelsOfALightAreInOneUniverse) {
  const auto lights = stage_lights(geodesic_directions(331));
  for (const StageLight& light : lights)
    EXPECT_EQ((light.channels.front() - 1) / 512, (light.channels.back() - 1) / 512);
  EXPECT_EQ(lights[170].channels.front(), 513U);  // 170 lights fill 510 slots
}

TEST(LightProgram, StaticCapture) {
  const LightProgram p = static_capture(stage_lights(geodesic_directions(331)));
  size_t tracking = 0, olat = 0;
  for (const LightStep& step : p.steps) {
    if (step.kind == StepKind::tracking) {
      EXPECT_EQ(olat, std::min(331UL, 11 * ++tracking));
    }
    if (step.kind == StepKind::olat) {
      EXPECT_EQ(step.light, olat++);
    }
  }
  EXPECT_EQ(olat, 331U);
  EXPECT_EQ(tracking, 31U);
  EXPECT_EQ(p.steps[p.steps.size() - 2].kind, StepKind::gradient_a);
  EXPECT_EQ(p.steps.back().kind, StepKind::gradient_b);
  EXPECT_EQ(p.triggers(), 3 + 331 + 31 + 2);
}

TEST(LightProgram, GradientsAddUpToFullOn) {
  const LightProgram p = performance(stage_lights(geodesic_directions(96)));
  EXPECT_FALSE(p.triggers());
  const auto a = p.colors(p.at(3)), b = p.colors(p.at(4)), full = p.colors(p.at(1));
  for (size_t i = 0; i < a.size(); ++i)
    for (size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(a[i][c], (1 + p.lights[i].direction[c]) / 2, 1e-6);
      EXPECT_NEAR(a[i][c] + b[i][c], full[i][c], 1e-6);
    }
}

TEST(LightProgram, PositionAtEachTrigger) {
  LightProgram p = performance(stage_lights(geodesic_directions(4)));
  p.repeat = 2;
  for (const auto marker :
       {LightProgram::Marker::none, LightProgram::Marker::start, LightProgram::Marker::pass}) {
    p.marker = marker;
    uint64_t trigger = 0;
    for (uint64_t pass = 0; pass < 2; ++pass) {
      if (marker == LightProgram::Marker::pass || (marker == LightProgram::Marker::start && !pass))
        for (uint32_t m = 0; m < 3; ++m, ++trigger) {
          EXPECT_EQ(p.at(trigger).part, Part::marker);
          EXPECT_EQ(p.at(trigger).index, m);
          EXPECT_EQ(p.kind(p.at(trigger)), m == 1 ? StepKind::tracking : StepKind::black);
        }
      for (uint32_t step = 0; step < 2; ++step, ++trigger) {
        EXPECT_EQ(p.at(trigger).part, Part::step);
        EXPECT_EQ(p.at(trigger).index, step);
        EXPECT_EQ(p.at(trigger).pass, pass);
      }
    }
    EXPECT_EQ(p.at(trigger).part, Part::ended);
    EXPECT_EQ(p.triggers(), trigger);
    for (const LightColor& color : p.colors(p.at(trigger))) EXPECT_EQ(color, LightColor{});
  }
}

TEST(LightProgram, JsonRoundTrips) {
  LightProgram p = static_capture(stage_lights(geodesic_directions(20)));
  p.rate_numerator = 60000;
  p.rate_denominator = 1001;
  p.exposure = 0.008;
  p.guard = 0.001;
  p.marker = LightProgram::Marker::pass;
  p.repeat = 3;
  p.steps.push_back(
      {StepKind::custom, 0, std::vector<LightColor>(20, {0.1F, 0.2F, 1}), 0.004, 0.0});
  const LightProgram back = LightProgram::parse(p.json());
  EXPECT_EQ(back.json(), p.json());
  EXPECT_EQ(back.id(), p.id());
  EXPECT_EQ(back.steps.back().colors[7], (LightColor{0.1F, 0.2F, 1}));
  p.lights[3].direction = p.lights[4].direction;
  EXPECT_NE(back.id(), p.id());
}

TEST(LightProgram, InvalidProgramsAreErrorsWithTheirCause) {
  EXPECT_EQ(parse_error(with(kTwo, kBlack)), "");
  const struct {
    std::string json, text;
  } cases[] = {
      {"", "not valid JSON"},
      {"[]", "not an object"},
      {"{}", "\"format\""},
      {std::string(100000, '['), "more than 100 deep"},
      {R"({"format": "gst-inverse light program", "version": 2})", "version"},
      {with("", kBlack), "no lights"},
      {with(kTwo, ""), "no steps"},
      {with(R"({"direction": [0, 0, 0]})", kBlack), "unit vector"},
      {with(R"({"direction": [0, 0, 1.1]})", kBlack), "unit vector"},
      {with(R"({"direction": [0, 0, null]})", kBlack), "three numbers"},
      {with(R"({"direction": [0, 0, 1e999]})", kBlack), "not valid JSON"},
      {with(R"({"direction": [0, 1]})", kBlack), "three numbers"},
      {with(R"({"channels": [1]})", kBlack), "\"direction\""},
      {with(R"({"direction": [0, 0, 1], "channels": [1, 2]})", kBlack), "2 channels"},
      {with(R"({"direction": [0, 0, 1], "channels": [0]})", kBlack), "channel 0"},
      {with(R"({"direction": [0, 0, 1], "channels": [1, 1, 2]})", kBlack), "another light"},
      {with(R"({"direction": [0, 0, 1], "channels": [1]}, {"direction": [0, 1, 0]})", kBlack),
       "0 channels"},
      {with(R"({"index": 1, "direction": [0, 0, 1]})", kBlack), "index"},
      {with(kTwo, R"({"kind": "flash"})"), "flash"},
      {with(kTwo, R"({"kind": "olat", "light": 2})"), "no light 2"},
      {with(kTwo, R"({"kind": "olat"})"), "\"light\""},
      {with(kTwo, R"({"kind": "custom", "colors": [[1, 1, 1]]})"), "1 colors for 2"},
      {with(kTwo, R"({"kind": "custom", "colors": [[1, 1, 2], [0, 0, 0]]})"), "outside of 0…1"},
      {with(kTwo, R"({"kind": "black", "exposure": 1})"), "a step only"},
      {with(kTwo, kBlack, R"("guard": -1, )"), "negative"},
      {with(kTwo, kBlack, R"("repeat": -1, )"), "\"repeat\""},
      {with(kTwo, kBlack, R"("marker": "sometimes", )"), "sometimes"},
      {R"({"format": "gst-inverse light program", "version": 1, "rate": "6/0x", "lights": [], "steps": []})",
       "\"rate\""},
      {R"({"format": "gst-inverse light program", "version": 1, "rate": 0, "lights": [], "steps": []})",
       "\"rate\""},
  };
  for (const auto& [json, text] : cases) testing::expect_contains(parse_error(json), text);
  LightProgram p = performance(stage_lights(geodesic_directions(4)));
  p.lights[2].direction[1] = std::numeric_limits<double>::quiet_NaN();
  testing::expect_error(ErrorKind::file, "light 2", [&] { p.check(); });
}

TEST(LightProgram, ByName) {
  EXPECT_EQ(light_program("performance:12", 30).lights.size(), 12U);
  EXPECT_EQ(light_program("static").lights.size(), 331U);
  for (const char* name : {"performance:", "performance:0", "static:4097", "static:12x"})
    testing::expect_error(ErrorKind::file,
                          '"' + std::string(name) + "\": the number of lights is from 1 to 4096",
                          [&] { light_program(name); });
  for (const auto& [name, text] :
       {std::pair{"/no/such.json", "the light program /no/such.json cannot be read"},
        {"/", "the light program / is no file"}})
    testing::expect_error(ErrorKind::file, text, [name = name] { light_program(name); });
}

TEST(LightProgram, IsTheSameWhenReadAgain) {
  for (const uint32_t count : {1U, 12U, 42U, 331U})
    for (LightProgram program : {static_capture(stage_lights(geodesic_directions(count))),
                                 performance(stage_lights(geodesic_directions(count)))}) {
      // As they come from other programs: a few digits.
      for (auto& light : program.lights)
        for (double& c : light.direction) c = std::round(c * 1e6) / 1e6;
      program.check();
      const LightProgram again = LightProgram::parse(program.json());
      EXPECT_EQ(again.id(), program.id());
      EXPECT_EQ(LightProgram::parse(again.json()).id(), program.id());
    }
}

TEST(LightProgram, UnknownFieldsAreNamed) {
  testing::expect_contains(parse_error(with(kTwo, kBlack, R"("repeats": 4, )")), "\"repeats\"");
  testing::expect_contains(parse_error(with(kTwo, R"({"kind": "black", "gard": 1})")),
                           "step 0 has an unknown field \"gard\"");
  testing::expect_contains(parse_error(with(R"({"direction": [0, 0, 1], "channel": [1]})", kBlack)),
                           "light 0");
  EXPECT_EQ(parse_error(with(kTwo, kBlack, R"("comment": "of the old rig", )")), "");
}

TEST(LightProgram, JsonThatTakesMuchMemoryIsRefused) {
  const std::string deep = std::string(101, '[') + std::string(101, ']');
  testing::expect_contains(parse_error(with(kTwo, kBlack, "\"comment\": " + deep + ", ")),
                           "program nests its JSON more than 100 deep");
  testing::expect_contains(parse_error(std::string(1 << 20, '[')), "more than 100 deep");
  std::string many = "[1";
  for (int i = 0; i < 9000000; ++i) many += ",1";
  testing::expect_contains(parse_error(with(kTwo, kBlack, "\"comment\": " + many + "], ")),
                           "more than 8388608 values");
  testing::expect_contains(parse_error(with(kTwo, kBlack, "\"rate\": 30, ")),
                           "has the field \"rate\" twice");
}

TEST(LightProgram, OfTheLargestSizeIsRead) {
  LightProgram program = static_capture(stage_lights(geodesic_directions(331)));
  const std::vector<LightStep> pass = program.steps;
  while (program.steps.size() < LightProgram::kMaxSteps)
    program.steps.push_back(pass[program.steps.size() % pass.size()]);
  EXPECT_EQ(LightProgram::parse(program.json()).id(), program.id());
}

TEST(LightList, JsonThatTakesMuchMemoryIsRefused) {
  testing::expect_error(ErrorKind::file, "lights nests its JSON more than 100 deep", [] {
    LightList::parse("{\"directions\": [[0, 0, 1]], \"comment\": " + std::string(101, '[') +
                         std::string(101, ']') + "}",
                     "lights");
  });
}

// Its opening would wait for a writer.
TEST(LightProgram, PipesAreRefused) {
  const testing::TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "lights.json").c_str(), 0600), 0);
  for (const auto load : {+[](const std::string& path) { LightProgram::load(path); },
                          +[](const std::string& path) { LightList::load(path); }})
    testing::expect_error(ErrorKind::file, "lights.json is no file",
                          [&] { load(folder / "lights.json"); });
}

TEST(LightProgram, LightsMayBeThoseOfAFolder) {
  const testing::TemporaryFolder folder;
  folder.write("lights.json", R"({"directions": [[0, 0, 1], [0.6, 0.8, 0]]})");
  const LightProgram program = light_program("performance:" + folder.path());
  ASSERT_EQ(program.lights.size(), 2U);
  EXPECT_NEAR(program.lights[1].direction[1], .8, 1e-12);
  EXPECT_EQ(program.steps.size(), 2U);
  EXPECT_EQ(light_program("static:" + folder.path()).steps.size(), 2U + 1 + 2);
  std::filesystem::remove(folder / "lights.json");
  testing::expect_error(ErrorKind::file, "lights.json",
                        [&] { light_program("static:" + folder.path()); });
  const std::string missing = folder / "lights";
  testing::expect_error(ErrorKind::file, "no folder is called",
                        [&] { light_program("static:" + missing); });
}

}  // namespace
}  // namespace inverse

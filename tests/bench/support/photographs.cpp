// SPDX-License-Identifier: LGPL-2.1-or-later
#include "photographs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "json.hpp"
#include "scene.hpp"
#include "tests/bench/metrics/png_file.hpp"

namespace inverse::bench {
namespace {

using Darker = Judgment::Darker;

Darker darker_of(const std::string& word) {
  if (word == "1") return Darker::first;
  if (word == "2") return Darker::second;
  if (word == "E") return Darker::neither;
  throw std::runtime_error("\"darker\" is 1, 2 or E, not " + word);
}

/// Mean over 3 x 3 pixels of what `value` returns for one.
template <typename Value>
double patch_mean(int x, int y, const Value& value) {
  double sum = 0;
  for (int v = y - 1; v <= y + 1; ++v)
    for (int u = x - 1; u <= x + 1; ++u) sum += value(u, v);
  return sum / 9;
}

/// CIELAB a* and b* of a linear sRGB pixel, white D65.
std::array<double, 2> lab_of(const Image& image, int x, int y) {
  constexpr double kToXyz[3][3] = {{0.412453, 0.357580, 0.180423},
                                   {0.212671, 0.715160, 0.072169},
                                   {0.019334, 0.119193, 0.950227}};
  constexpr double kWhite[] = {0.950456, 1, 1.088754};
  double f[3];
  for (int k = 0; k < 3; ++k) {
    double t = 0;
    for (int c = 0; c < 3; ++c) t += kToXyz[k][c] * double(image.at(x, y, c)) / kWhite[k];
    f[k] = t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116;
  }
  return {500 * (f[0] - f[1]), 200 * (f[1] - f[2])};
}

bool wanted(const Setting& setting) {
  return setting.stills && (setting.photographs ||
                            (!setting.layers_only && setting.effort == Setting::Effort::brief));
}

std::string text_of(Darker darker) {
  return darker == Darker::first ? "1" : darker == Darker::second ? "2" : "E";
}

std::string joined(const std::vector<std::string>& parts) {
  std::string all;
  for (const std::string& part : parts) all += (all.empty() ? "\n" : ",\n") + part;
  return "[" + all + "]";
}

std::string picture_json(const Photograph& photograph) {
  std::string darker;
  std::vector<double> chroma;
  for (const Judgment& pair : photograph.pairs) {
    darker += text_of(pair.darker);
    chroma.push_back(pair_chroma(photograph.input, pair));
  }
  return json::Object()
      .add("picture", json::text(photograph.name))
      .add("darker", json::text(darker))
      .add("chroma", json::list(chroma))
      .str();
}

std::vector<double> ratios(const Photograph& photograph, const Method& method,
                           const Setting& setting) {
  const Image& input = photograph.input;
  const auto solver = setting.make({input.width, input.height});
  TruthFrame frame;
  frame.input = frame.reflectance = input;  // unknown; only for statistics that are not kept
  solver->show(frame);
  Cost cost;
  Image found = solver->run(input, false, cost).reflectance;
  if (method.family == "method") found = as_element_output(found);
  std::vector<double> all;
  for (const Judgment& pair : photograph.pairs) all.push_back(reflectance_ratio(found, pair));
  return all;
}

}  // namespace

std::vector<Photograph> read_photographs(const std::string& folder) {
  std::ifstream file(folder + "/pairs.json");
  if (!file) throw std::runtime_error("no pairs.json in " + folder);
  std::vector<Photograph> all;
  const nlohmann::json pictures = nlohmann::json::parse(file);
  for (const auto& [name, pairs] : pictures.items()) {
    Photograph photograph{name, read_png(folder + "/" + name, true), {}};
    if (photograph.input.channels != 3) throw std::runtime_error(name + " is gray");
    for (const auto& pair : pairs) {
      const Judgment judgment{pair.at("x1"), pair.at("y1"), pair.at("x2"), pair.at("y2"),
                              darker_of(pair.at("darker"))};
      for (const auto& [x, y] : {std::pair{judgment.x0, judgment.y0}, {judgment.x1, judgment.y1}})
        if (x < 1 || y < 1 || x > photograph.input.width - 2 || y > photograph.input.height - 2)
          throw std::runtime_error(name + ": a point is at the border or outside");
      photograph.pairs.push_back(judgment);
    }
    all.push_back(std::move(photograph));
  }
  return all;
}

Image as_element_output(const Image& reflectance) {
  Image out = reflectance;
  for (float& v : out.data) v = std::round(std::clamp(v, 0.0F, 1.0F) * 65535) / 65535;
  return out;
}

double reflectance_ratio(const Image& reflectance, const Judgment& pair) {
  const auto patch = [&](int x, int y) {
    constexpr double kMin = 1e-5;
    return std::max(kMin, patch_mean(x, y, [&](int u, int v) {
                      double sum = 0;
                      for (int c = 0; c < reflectance.channels; ++c)
                        sum += double(reflectance.at(u, v, c));
                      return sum / reflectance.channels;
                    }));
  };
  return patch(pair.x0, pair.y0) / patch(pair.x1, pair.y1);
}

double pair_chroma(const Image& input, const Judgment& pair) {
  const auto chroma = [&](int x, int y) {
    const auto mean = [&](std::size_t k) {
      return patch_mean(x, y, [&](int u, int v) { return lab_of(input, u, v)[k]; });
    };
    return std::hypot(mean(0), mean(1));
  };
  return std::max(chroma(pair.x0, pair.y0), chroma(pair.x1, pair.y1));
}

std::string measure_photographs(const std::string& folder, const std::vector<Method>& methods,
                                const std::set<std::string>& only) {
  std::vector<std::string> pictures, rows, failures;
  const std::vector<Photograph> photographs = read_photographs(folder);
  for (const Photograph& photograph : photographs) {
    std::fprintf(stderr, "@progress %.3f %s\n",
                 double(pictures.size()) / double(photographs.size()), photograph.name.c_str());
    pictures.push_back(picture_json(photograph));
    for (const Method& method : methods) {
      if (!only.empty() && !only.count(method.name)) continue;
      for (const Setting& setting : method.settings) {
        if (!wanted(setting)) continue;
        json::Object row;
        row.add("method", json::text(method.name))
            .add("curve", json::text(setting.curve))
            .add("setting", json::text(setting.name))
            .add("preset", json::text(setting.preset))
            .add("base", setting.base ? "true" : "false")
            .add("picture", json::text(photograph.name));
        try {
          row.add("ratios", json::list(ratios(photograph, method, setting)));
          rows.push_back(row.str());
        } catch (const std::exception& error) {
          failures.push_back(row.add("why", json::text(error.what())).str());
        }
      }
    }
  }
  return "{\"pictures\": " + joined(pictures) + ",\n\"rows\": " + joined(rows) +
         ",\n\"failures\": " + joined(failures) + "}\n";
}

}  // namespace inverse::bench

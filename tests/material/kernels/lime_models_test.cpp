// SPDX-License-Identifier: LGPL-2.1-or-later
// The five networks of limematerial as files.
#include "lime_models.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "common/error.hpp"
#include "tests/expect_error.hpp"

namespace inverse::testing {

TEST(LimeModels, AreLoadedFromAFolder) {
  const HandMadeLime files;
  const LimeModels m = LimeModels::load(files.folder() + "/lime");
  EXPECT_EQ(m.side, HandMadeLime::kSide);
  EXPECT_EQ(m.albedo.weights, HandMadeLime::models().albedo.weights);
}

TEST(LimeModels, NetworksThatDoNotFitAreRefusedByName) {
  const auto expect_refused = [](const HandMadeLime& files, const std::string& text) {
    return expect_error(ErrorKind::file, text, [&] { LimeModels::load(files.folder() + "/lime"); });
  };
  HandMadeLime missing, shape, cut, scores;
  std::filesystem::remove(missing.path("mirror"));
  expect_refused(missing, "mirror.net: it cannot be read: No such file");
  shape.write("albedo", network::to_file(HandMadeLime::models().exponent));
  expect_refused(shape, "albedo.net: it takes 2 x 32 x 32 in place of 4 x 32 x 32");
  auto bytes = network::to_file(HandMadeLime::models().exponent);
  bytes.resize(bytes.size() - 5);
  cut.write("exponent", bytes);
  expect_contains(expect_refused(cut, "exponent.net"), "cut short");
  network::Graph exponent = HandMadeLime::models().exponent;
  exponent.nodes.back().op = network::Op::activation;
  scores.write("exponent", network::to_file(exponent));
  expect_refused(scores, "exponent.net: it gives no probabilities");
}

}  // namespace inverse::testing

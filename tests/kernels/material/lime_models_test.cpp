// SPDX-License-Identifier: LGPL-2.1-or-later
// The five networks of limematerial as files.
#include "lime_models.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "common/error.hpp"

namespace inverse::testing {

TEST(LimeModels, AreLoadedFromAFolder) {
  const HandMadeLime files;
  const LimeModels m = LimeModels::load(files.folder() + "/lime");
  EXPECT_EQ(m.side, HandMadeLime::kSide);
  EXPECT_EQ(m.albedo.weights, HandMadeLime::models().albedo.weights);
}

TEST(LimeModels, WhatDoesNotFitIsRefusedByName) {
  const auto complaint = [](const HandMadeLime& files) -> std::string {
    try {
      LimeModels::load(files.folder() + "/lime");
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::file);
      return error.what();
    }
    return "";
  };
  HandMadeLime missing, shape, cut, scores;
  std::filesystem::remove(missing.path("mirror"));
  EXPECT_NE(complaint(missing).find("mirror.net: it cannot be read: No such file"),
            std::string::npos)
      << complaint(missing);
  shape.write("albedo", network::to_file(HandMadeLime::models().exponent));
  EXPECT_NE(complaint(shape).find("albedo.net: it takes 2 x 32 x 32 in place of 4 x 32 x 32"),
            std::string::npos)
      << complaint(shape);
  auto bytes = network::to_file(HandMadeLime::models().exponent);
  bytes.resize(bytes.size() - 5);
  cut.write("exponent", bytes);
  EXPECT_NE(complaint(cut).find("exponent.net"), std::string::npos);
  EXPECT_NE(complaint(cut).find("cut short"), std::string::npos) << complaint(cut);
  network::Graph exponent = HandMadeLime::models().exponent;
  exponent.nodes.back().op = network::Op::activation;
  scores.write("exponent", network::to_file(exponent));
  EXPECT_NE(complaint(scores).find("exponent.net: it gives no probabilities"), std::string::npos)
      << complaint(scores);
}

}  // namespace inverse::testing

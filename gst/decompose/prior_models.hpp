// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>

#include "gst/base/log/log.hpp"
#include "kernels/intrinsic/prior/network/prior_model.hpp"

namespace inverse {

/// The network that the property `prior` names. Not thread-safe.
class PriorModels {
 public:
  static constexpr const char *kFitted = "fitted", *kLearned = "learned";
  /// Reads files again from now on, and posts warnings there.
  void start(const Log& log);
  /// Null for the fitted prior, and after one warning for what cannot be used. `source` is a file's
  /// path, kFitted, or kLearned: the network that comes with gst-inverse.
  PriorModelPtr take(const std::string& source);

 private:
  PriorModelPtr load();

  Log log_{};
  std::string source_;   // the last one
  PriorModelPtr model_;  // of it; null: fitted or refused
};

}  // namespace inverse

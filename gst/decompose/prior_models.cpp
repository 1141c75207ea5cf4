// SPDX-License-Identifier: LGPL-2.1-or-later
#include "prior_models.hpp"

#include <filesystem>
#include <system_error>
#include <utility>

#include "common/error.hpp"
#include "gst/base/models.hpp"

namespace inverse {

void PriorModels::start(const Log& log) {
  log_ = log;
  source_.clear();
  model_.reset();
}

PriorModelPtr PriorModels::take(const std::string& source) {
  if (std::exchange(source_, source) != source) model_ = source == kFitted ? nullptr : load();
  return model_;
}

PriorModelPtr PriorModels::load() {
  const bool learned = source_ == kLearned;
  const std::string path = learned ? models_set() + "/intrinsic/prior.net" : source_;
  try {
    std::error_code status;
    if (learned && !std::filesystem::exists(path, status))
      throw Error(ErrorKind::file, "there is no " + path +
                                       "; install gst-inverse-models, or set the environment "
                                       "variable INVERSE_MODELS to the folder of networks");
    if (path.ends_with(".onnx")) {
      const std::string net = path.substr(0, path.size() - 5) + ".net";
      throw Error(ErrorKind::file, path +
                                       ": elements do not read ONNX; run \"inverse-onnx-import " +
                                       path + " " + net + "\" and set prior=" + net);
    }
    PriorModelPtr model = PriorModel::load(path);
    GST_CAT_INFO_OBJECT(log_.category, log_.object, "prior: read %s, %zu nodes, %zu parameters",
                        path.c_str(), model->graph.nodes.size(), model->graph.weights.size());
    return model;
  } catch (const Error& error) {
    post_warning(log_, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_READ,
                 "prior=%s is not used, but the fitted prior: %s", source_.c_str(), error.what());
    return nullptr;
  }
}

}  // namespace inverse

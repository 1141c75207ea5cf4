#include "models.hpp"

#include <cstdlib>

namespace inverse {

std::string models_folder(const std::string& set, const char* part) {
  const char* environment = std::getenv("INVERSE_MODELS");
  const std::string all = !set.empty()                  ? set
                          : environment && *environment ? environment
                                                        : MODELS_FOLDER;
  return all + "/" + part;
}

}  // namespace inverse

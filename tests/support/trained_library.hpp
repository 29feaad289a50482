/// Libraries of shapes, trained in memory for all methods.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "engine/training/standard_basis.hpp"
#include "engine/training/train.hpp"
#include "storage/library/library.hpp"
#include "support/rendered_scene.hpp"

namespace trivet::test {

/// Pre: names are in ascending order.
inline Library trained_library(const std::vector<std::pair<std::string, const Shape*>>& shapes,
                               const TrainOptions& options = {}) {
  Library library;
  const auto source = [](const std::string& name) {
    return ModelSource{name, name + ".ply", 1, {}};
  };
  library.basis = engine::standard_basis(options);
  for (const auto& [name, shape] : shapes) {
    auto trained = train_model(cloud_of(*shape), source(name), options, library.basis);
    EXPECT_TRUE(trained) << trained.error().message;
    library.models.push_back(std::move(trained->model));
  }
  return library;
}

}  // namespace trivet::test

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
  const auto source = [](const std::string& name) {
    return ModelSource{name, name + ".ply", 1, {}};
  };
  TriSpinBasis basis = engine::standard_basis(options);
  std::vector<Model> models;
  for (const auto& [name, shape] : shapes) {
    auto trained = train_model(cloud_of(*shape), source(name), options, basis);
    EXPECT_TRUE(trained) << trained.error().message;
    models.push_back(std::move(trained->model));
  }
  Library library(std::move(models));
  library.basis = std::move(basis);
  return library;
}

}  // namespace trivet::test

#include "engine/loaded_library/recognizer.hpp"

#include <gtest/gtest.h>

#include <set>

#include "engine/common/parallel.hpp"
#include "engine/training/train.hpp"
#include "support/rendered_scene.hpp"

namespace trivet {
namespace {

Library one_model(Cloud cloud) {
  Library library;
  auto trained = train_model(cloud, {"bracket", "bracket.ply", 1, {}}, {});
  library.models.push_back(std::move(trained->model));
  return library;
}

TEST(Recognizer, BuildsASurfaceOnceForAllThreads) {
  const Recognizer recognizer(one_model(test::cloud_of(test::bracket())));
  std::vector<const void*> surfaces(64);
  engine::for_each_index(surfaces.size(),
                         [&](std::size_t i) { surfaces[i] = recognizer.surface(0)->get(); });
  EXPECT_EQ(std::set(surfaces.begin(), surfaces.end()).size(), 1U);
}

// The discs of a model without faces lie where its faces would, seen from every direction.
TEST(Recognizer, StandsDiscsOnSamplesWhereThereAreNoFaces) {
  Library library = one_model(test::cloud_of(test::bracket()));
  const float spacing = library.models[0].sample_spacing;
  Library faceless = library;
  faceless.models[0].triangles = Triangles();
  const Recognizer faces(std::move(library)), discs(std::move(faceless));
  const Model& model = faces.library().models[0];
  std::size_t met = 0, close = 0;
  for (std::size_t i = 0; i < model.samples.size(); i += 7) {
    const Eigen::Vector3f from = model.samples[i] + model.diameter * model.sample_normals[i];
    const Eigen::Vector3f ray = -model.sample_normals[i];
    const kernels::Hit a = (*faces.surface(0))->intersect(from, ray, 0, 2 * model.diameter);
    const kernels::Hit b = (*discs.surface(0))->intersect(from, ray, 0, 2 * model.diameter);
    if (!a) continue;
    ++met;
    close += b && std::abs(a.distance - b.distance) < spacing ? 1 : 0;
  }
  EXPECT_GT(met, 100U);
  EXPECT_GT(close, met * 95 / 100);
}

}  // namespace
}  // namespace trivet

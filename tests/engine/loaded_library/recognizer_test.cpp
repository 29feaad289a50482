#include "engine/loaded_library/recognizer.hpp"

#include <gtest/gtest.h>

#include <set>

#include "engine/common/parallel.hpp"
#include "engine/training/train.hpp"
#include "support/allocations.hpp"
#include "support/rendered_scene.hpp"

namespace trivet {
namespace {

Model bracket() {
  return train_model(test::cloud_of(test::bracket()), {"bracket", "bracket.ply", 1, {}}, {})->model;
}

TEST(Recognizer, BuildsASurfaceOnceForAllThreads) {
  const Recognizer recognizer(Library({bracket()}));
  std::vector<const void*> surfaces(64);
  engine::for_each_index(surfaces.size(),
                         [&](std::size_t i) { surfaces[i] = recognizer.surface(0)->get(); });
  EXPECT_EQ(std::set(surfaces.begin(), surfaces.end()).size(), 1U);
}

TEST(Recognizer, HasSurfacesBeforeTheyAreAskedFor) {
  const Recognizer ready(Library({bracket()})), bounded(Library({bracket()}), default_score(), {1});
  ready.make_ready();
  bounded.make_ready();
  const auto building = [](const Recognizer& recognizer) {
    return test::allocations_in([&] { (void)recognizer.surface(0); });
  };
  EXPECT_EQ(building(ready), 0U);
  EXPECT_GT(building(bounded), 0U);
}

// The discs of a model without faces lie where its faces would, seen from every direction.
TEST(Recognizer, StandsDiscsOnSamplesWhereThereAreNoFaces) {
  const Model model = bracket();
  Model faceless = model;
  faceless.triangles = Triangles();
  const Recognizer faces(Library({model})), discs(Library({faceless}));
  std::size_t met = 0, close = 0;
  for (std::size_t i = 0; i < model.samples.size(); i += 7) {
    const Eigen::Vector3f from = model.samples[i] + model.diameter * model.sample_normals[i];
    const Eigen::Vector3f ray = -model.sample_normals[i];
    const kernels::Hit a = (*faces.surface(0))->intersect(from, ray, 0, 2 * model.diameter);
    const kernels::Hit b = (*discs.surface(0))->intersect(from, ray, 0, 2 * model.diameter);
    if (!a) continue;
    ++met;
    close += b && std::abs(a.distance - b.distance) < model.sample_spacing ? 1 : 0;
  }
  EXPECT_GT(met, 100U);
  EXPECT_GT(close, met * 95 / 100);
}

}  // namespace
}  // namespace trivet

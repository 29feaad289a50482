#include "engine/training/train.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/common/thread_limit.hpp"
#include "kernels/common/pose_math.hpp"
#include "storage/files/file.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/polygon_mesh.hpp"
#include "support/random.hpp"
#include "support/random_model.hpp"
#include "support/rendered_scene.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

ModelSource source_named(const char* name) { return {name, std::string(name) + ".ply", 1, {}}; }

TEST(TrainModel, DescribesTheCompleteVisibleSurface) {
  const auto trained = train_model(test::cloud_of(test::bracket()), source_named("bracket"), {});
  ASSERT_TRUE(trained) << trained.error().message;
  const Model& model = trained->model;
  EXPECT_NEAR(model.diameter, 0.207F, 0.01F);
  EXPECT_TRUE(model.symmetry.trivial());
  EXPECT_GT(model.samples.size(), 1000U);
  EXPECT_GT(trained->stats.num_hidden_samples, 0U)
      << "the parts overlap: their inner faces cannot be seen";
  EXPECT_EQ(model.ppf.offsets.size(), model.ppf.quantization.num_cells() + 1U);
  EXPECT_EQ(model.ppf.entries.size(), model.ppf.offsets.back());
  for (std::size_t i = 0; i < model.ppf_points.size(); ++i) {
    ASSERT_NEAR(model.ppf_normals[i].norm(), 1, 1e-4F);
  }
}

TEST(TrainModel, FindsNearSymmetries) {
  test::Shape bolt = test::prism(60, test::circle(0.025), -0.1, 0.08);
  bolt.join(test::prism(60, test::circle(0.03), 0.08, 0.1));
  const auto trained = train_model(test::cloud_of(bolt), source_named("bolt"), {});
  ASSERT_TRUE(trained) << trained.error().message;
  ASSERT_EQ(trained->model.near_symmetries.size(), 1U);
  EXPECT_LT(trained->model.near_symmetries[0].linear()(2, 2), -0.99F) << "end for end";
}

TEST(TrainModel, FindsTheSymmetriesOfPolygonsAsOfTriangles) {
  const test::TempDir folder;
  const auto trained_from = [&](bool triangulated) {
    const test::PolygonMesh gear = test::extruded(test::gear_outline(12), 0.4, triangulated);
    const Result<Cloud> cloud = read_cloud(folder.write("gear.obj", gear.obj()));
    EXPECT_TRUE(cloud) << cloud.error().message;
    return train_model(*cloud, {"gear", "gear.obj", 1, {}}, {});
  };
  const auto polygons = trained_from(false), triangles = trained_from(true);
  ASSERT_TRUE(polygons && triangles);
  EXPECT_EQ(triangles->model.symmetry.poses.size(), 23U) << "twelve turns, either end up";
  EXPECT_EQ(polygons->model.symmetry.poses.size(), triangles->model.symmetry.poses.size());
  const auto num_points = [](const Result<TrainedModel>& trained) {
    return static_cast<double>(trained->model.ppf_points.size());
  };
  EXPECT_NEAR(num_points(polygons) / num_points(triangles), 1, 0.05);
}

TEST(TrainModel, StartsPairsAtPointsThatTheSpacingKeepsApart) {
  const Cloud surface = test::cloud_of(test::bracket());
  const auto all = train_model(surface, source_named("bracket"), {.reference_spacing = 0});
  const auto spread = train_model(surface, source_named("bracket"), {.reference_spacing = 1.5F});
  ASSERT_TRUE(all && spread);
  EXPECT_EQ(all->model.ppf.num_references, all->model.ppf_points.size());
  const Model& model = spread->model;
  EXPECT_EQ(model.ppf_points.size(), all->model.ppf_points.size());
  EXPECT_LT(model.ppf.num_references, model.ppf_points.size() / 2);
  const float distance = 1.5F * model.ppf.quantization.distance_step;
  const auto near_and_like = [&](std::size_t i, std::size_t k) {
    return (model.ppf_points[i] - model.ppf_points[k]).norm() <= distance &&
           model.ppf_normals[i].dot(model.ppf_normals[k]) > 0.71F;
  };
  for (std::size_t i = 0; i < model.ppf_points.size(); ++i) {
    std::size_t near = 0;
    for (std::size_t k = 0; k < model.ppf.num_references; ++k)
      near += k != i && near_and_like(i, k);
    if (i < model.ppf.num_references) {
      ASSERT_EQ(near, 0U) << i;
    } else {
      ASSERT_GT(near, 0U) << i;
    }
  }
}

TEST(TrainModel, GivesOutwardNormalsWhateverTheWinding) {
  const test::Shape shape = test::ellipsoid({0.1F, 0.06F, 0.04F}, 40);
  for (const test::Shape& wound : {shape, shape.inside_out()}) {
    const auto trained = train_model(test::cloud_of(wound), source_named("ellipsoid"), {});
    ASSERT_TRUE(trained);
    for (std::size_t i = 0; i < trained->model.ppf_points.size(); ++i) {
      ASSERT_GT(trained->model.ppf_normals[i].dot(trained->model.ppf_points[i]), 0) << i;
    }
  }
}

TEST(TrainModel, AcceptsACloudWithoutFaces) {
  const test::Shape shape = test::ellipsoid({0.1F, 0.06F, 0.04F}, 60);
  Cloud cloud;
  cloud.points = shape.vertices;
  const auto trained = train_model(cloud, source_named("cloud"), {});
  ASSERT_TRUE(trained) << trained.error().message;
  std::size_t outward = 0;
  const Model& model = trained->model;
  EXPECT_GT(6 * model.triangles.size(), model.vertices.size()) << "a place is in six corners";
  for (std::size_t i = 0; i < model.ppf_points.size(); ++i)
    outward += model.ppf_normals[i].dot(model.ppf_points[i]) > 0;
  EXPECT_GT(outward, model.ppf_points.size() * 99 / 100);
}

TEST(TrainModel, KeepsOneOfEachSymmetricPair) {
  const test::Shape gear = test::prism(108, test::teeth(12, 0.1), -0.3, 0.3);
  const auto found = train_model(test::cloud_of(gear), source_named("gear"), {});
  ModelSource plain = source_named("gear");
  plain.symmetry = Symmetry{};
  plain.symmetry->declared = true;
  const auto whole = train_model(test::cloud_of(gear), plain, {});
  ASSERT_TRUE(found && whole);
  EXPECT_EQ(found->model.symmetry.poses.size(), 23U) << "12-fold, and end for end";
  EXPECT_FALSE(found->model.symmetry.declared);
  EXPECT_TRUE(whole->model.symmetry.trivial()) << "what the user declares is not second-guessed";
  EXPECT_LT(found->model.ppf.entries.size() * 4, whole->model.ppf.entries.size());
}

TEST(TrainModel, GivesTheSameBytesForAnyNumberOfThreads) {
  const Cloud surface = test::cloud_of(test::bracket());
  Result<TrainedModel> one = Error{ErrorCode::internal, ""}, two = one;
  {
    const ThreadLimit limit(1);
    one = train_model(surface, source_named("bracket"), {});
  }
  {
    const ThreadLimit limit(2);
    two = train_model(surface, source_named("bracket"), {});
  }
  ASSERT_TRUE(one && two);
  EXPECT_EQ(test::difference(one->model, two->model), "");
}

TEST(TrainModel, RefusesWhatHasNoSurface) {
  for (const auto& [points, what] :
       {std::pair{std::vector<Eigen::Vector3f>{{0, 0, 0}}, "one point"},
        std::pair{std::vector<Eigen::Vector3f>(100, {1, 2, 3}), "one place"},
        std::pair{std::vector<Eigen::Vector3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, "three points"}}) {
    Cloud cloud;
    for (const Eigen::Vector3f& p : points) cloud.points.push_back(p);
    const auto trained = train_model(cloud, source_named("flat"), {});
    ASSERT_FALSE(trained) << what;
    EXPECT_EQ(trained.error().code, ErrorCode::bad_data) << what;
    EXPECT_NE(trained.error().message.find("flat"), std::string::npos) << trained.error().message;
  }
}

TEST(TrainOptionsCheck, NamesTheOptionThatIsOutOfRange) {
  EXPECT_TRUE(validate(TrainOptions{}));
  const auto wrong = validate(TrainOptions{.relative_step = 0.5F});
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, ErrorCode::usage);
  EXPECT_NE(wrong.error().message.find("relative-step: expected 0.01 to 0.2 [diameter]"),
            std::string::npos);
  EXPECT_FALSE(validate(TrainOptions{.relative_step = std::nanf("")}));
  EXPECT_FALSE(validate(TrainOptions{.reference_spacing = -1}));
}

TEST(SamplingStep, IsSharedByDiametersWithinAnEighthOfAnOctave) {
  EXPECT_FLOAT_EQ(sampling_step(1, 0.05F), 0.05F);
  EXPECT_FLOAT_EQ(sampling_step(1.08F, 0.05F), 0.05F);
  EXPECT_NE(sampling_step(1.1F, 0.05F), 0.05F);
  EXPECT_FLOAT_EQ(sampling_step(2048, 0.05F), 0.05F * 2048);
}

}  // namespace
}  // namespace trivet

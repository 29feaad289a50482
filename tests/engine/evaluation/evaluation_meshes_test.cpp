#include "engine/evaluation/evaluation_meshes.hpp"

#include <gtest/gtest.h>

#include "support/temp_dir.hpp"

namespace trivet {
namespace {

class EvaluationMeshes : public testing::Test {
 protected:
  ManifestModel model(const char* name, const char* file) const {
    return {name, folder_ / file, 1, {}};
  }
  const test::TempDir folder_;
  Manifest manifest_;
};

TEST_F(EvaluationMeshes, AreTheManifestsModelsInItsOrderAndUnit) {
  folder_.write("b.obj", "v 0 0 0\nv 3 0 0\nv 0 4 0\nf 1 2 3\n");
  folder_.write("a.xyz", "0 0 0\n1 0 0\n");
  manifest_.models = {model("b", "b.obj"), model("a", "a.xyz")};
  manifest_.models[0].scale = 0.001;
  manifest_.models[0].symmetry = Symmetry{{}, Symmetry::Axis{}, true};
  const auto meshes = read_evaluation_meshes(manifest_);
  ASSERT_TRUE(meshes) << meshes.error().message;
  ASSERT_EQ(meshes->size(), 2U);
  const EvaluationMesh& b = meshes->front();
  EXPECT_EQ(b.name, "b");
  EXPECT_EQ(b.vertices.size(), 3U);
  EXPECT_EQ(b.triangles.size(), 1U);
  EXPECT_NEAR(b.diameter, 0.005, 1e-8);
  EXPECT_TRUE(b.symmetry.axis);
  EXPECT_EQ(find_mesh(*meshes, "a"), &meshes->back());
  EXPECT_TRUE(meshes->back().triangles.empty());
  EXPECT_TRUE(meshes->back().symmetry.trivial());
  EXPECT_EQ(find_mesh(*meshes, "c"), nullptr);
}

TEST_F(EvaluationMeshes, ComeFromTheFileForEvaluationWhereThereIsOne) {
  folder_.write("fine.xyz", "0 0 0\n1 0 0\n0 1 0\n");
  folder_.write("coarse.xyz", "0 0 0\n2 0 0\n");
  manifest_.models = {model("a", "fine.xyz")};
  manifest_.models[0].eval_file = folder_ / "coarse.xyz";
  const auto meshes = read_evaluation_meshes(manifest_);
  ASSERT_TRUE(meshes) << meshes.error().message;
  EXPECT_EQ(meshes->front().diameter, 2);
}

TEST_F(EvaluationMeshes, MustBeThereAndHaveExtent) {
  manifest_.models = {model("a", "nowhere.ply")};
  const auto missing = read_evaluation_meshes(manifest_);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::missing_input);

  folder_.write("point.xyz", "1 2 3\n1 2 3\n");
  manifest_.models = {model("a", "point.xyz")};
  const auto flat = read_evaluation_meshes(manifest_);
  ASSERT_FALSE(flat);
  EXPECT_EQ(flat.error().code, ErrorCode::bad_data);
  EXPECT_NE(flat.error().message.find("point.xyz"), std::string::npos);
}

}  // namespace
}  // namespace trivet

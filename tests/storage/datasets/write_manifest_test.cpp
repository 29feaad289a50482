#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "storage/datasets/manifest.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

TEST(WriteManifest, ReadsBackTheSame) {
  const test::TempDir folder;
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisf(2, Eigen::Vector3f(1, 2, 3).normalized()).toRotationMatrix();
  pose.translation() << 0.1F, -20, 3e-5F;

  Manifest written;
  written.unit = LengthUnit::millimeter;
  Symmetry symmetry{
      {pose}, Symmetry::Axis{Eigen::Vector3f::UnitX(), Eigen::Vector3f(1, 2, 3)}, true};
  written.models = {{"zebra", folder / "models/zebra.ply", 0.5, symmetry},
                    {"ant", "/somewhere/ant.ply", 1, {}}};
  written.models_scored = {"ant"};
  written.scenes.resize(2);
  written.scenes[0] = {folder / "a.png",
                       "a.png",
                       Camera{500, 501, 319.5, 239.5, 0.1},
                       {},
                       false,
                       {{"ant", pose, 0.25, true, 0.75, 0.5}, {"zebra", pose, {}, false}}};
  written.scenes[1].file = folder / "b.ply";
  written.scenes[1].viewpoint = Eigen::Vector3d(1, 2, 3);

  ASSERT_TRUE(write_manifest(folder / "manifest.json", written));
  const Result<Manifest> read = read_manifest(folder / "manifest.json");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->unit, written.unit);
  EXPECT_EQ(read->models_scored, written.models_scored);
  ASSERT_EQ(read->models.size(), 2U);
  EXPECT_EQ(read->models[0].name, "zebra");
  EXPECT_EQ(read->models[0].file, written.models[0].file);
  EXPECT_EQ(read->models[0].scale, 0.5);
  ASSERT_TRUE(read->models[0].symmetry && read->models[0].symmetry->axis);
  // The reader orthonormalizes rotations, which changes the last bits.
  EXPECT_TRUE(read->models[0].symmetry->poses[0].isApprox(pose, 1e-6F));
  EXPECT_EQ(read->models[0].symmetry->axis->point, symmetry.axis->point);
  EXPECT_EQ(std::filesystem::weakly_canonical(read->models[1].file), "/somewhere/ant.ply");
  EXPECT_FALSE(read->models[1].symmetry);

  ASSERT_EQ(read->scenes.size(), 2U);
  EXPECT_EQ(read->scenes[0].name, "a.png");
  EXPECT_EQ(read->scenes[0].camera, written.scenes[0].camera);
  ASSERT_EQ(read->scenes[0].truth.size(), 2U);
  EXPECT_TRUE(read->scenes[0].truth[0].T_scene_model.isApprox(pose, 1e-6F));
  EXPECT_EQ(read->scenes[0].truth[0].occlusion, 0.25);
  EXPECT_EQ(read->scenes[0].truth[0].visible_fraction, 0.75);
  EXPECT_EQ(read->scenes[0].truth[0].clutter, 0.5);
  EXPECT_TRUE(read->scenes[0].truth[0].ignore);
  EXPECT_FALSE(read->scenes[0].truth[1].occlusion);
  EXPECT_EQ(read->scenes[1].viewpoint, written.scenes[1].viewpoint);
}

}  // namespace
}  // namespace trivet

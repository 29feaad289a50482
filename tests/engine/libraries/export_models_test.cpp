#include "engine/libraries/export_models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "engine/training/train.hpp"
#include "engine/training/training_run.hpp"
#include "storage/datasets/manifest.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/random.hpp"
#include "support/rendered_scene.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;

/// Coarse training, for speed.
const TrainOptions kFast{.relative_step = 0.1F, .num_samples = 512, .tri_spin_images = false};

class ExportModels : public testing::TestWithParam<LengthUnit> {
 protected:
  ExportModels() {
    const std::vector<std::pair<std::string, Cloud>> models{
        {"a_block", test::cloud_of(test::box({-0.05F, -0.03F, -0.02F}, {0.05F, 0.03F, 0.02F}))},
        {"rod", test::cloud_of(test::prism(48, test::circle(0.02), 0, 0.11))},
        {"z.lever", test::cloud_of(test::lever())}};
    TrainRequest request{{}, GetParam(), kFast, folder_ / "library.h5"};
    for (const auto& [name, cloud] : models) {
      const fs::path file = folder_ / (name + ".source.ply");
      EXPECT_TRUE(write_ply(file, cloud));
      request.sources.push_back({name, file, unit_scale(LengthUnit::meter, GetParam()), {}});
    }
    library_ = trained(request);
  }

  static Library trained(const TrainRequest& request) {
    const auto report = train_library(request);
    EXPECT_TRUE(report) << report.error().message;
    return *open_library(request.file);
  }
  /// The library that `trivet train` makes of the files.
  Library trained_from(const std::vector<fs::path>& files, const fs::path& target) const {
    TrainRequest request{{}, GetParam(), kFast, target};
    for (const fs::path& file : files) {
      if (file.extension() != ".json") {
        request.sources.push_back({cloud_name(file), file, 1, {}});
        continue;
      }
      const auto manifest = read_manifest(file);
      EXPECT_TRUE(manifest) << manifest.error().message;
      EXPECT_EQ(manifest->unit, GetParam());
      for (const ManifestModel& model : manifest->models)
        request.sources.push_back({model.name, model.file, model.scale, model.symmetry});
    }
    return trained(request);
  }

  test::TempDir folder_;
  Library library_;
};

/// The surfaces below a folder by their relative paths. Symmetries beside them are written as
/// decimals and orthonormalized again when they are read.
std::map<std::string, std::string> surfaces(const fs::path& folder) {
  std::map<std::string, std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (is_cloud_file(entry.path()))
      out[entry.path().lexically_relative(folder).string()] = test::read_bytes(entry.path());
  return out;
}

TEST_P(ExportModels, AreTheSameWhenTrainedAndExportedAgain) {
  for (const SurfaceFormat format : {SurfaceFormat::ply, SurfaceFormat::gltf, SurfaceFormat::bop}) {
    const auto number = std::to_string(static_cast<int>(format));
    const auto files = export_models(library_, {}, format, folder_ / number);
    ASSERT_TRUE(files) << files.error().message;
    const Library again = trained_from(*files, folder_ / (number + ".h5"));
    ASSERT_EQ(again.models.size(), library_.models.size());
    const bool exact = format != SurfaceFormat::bop || GetParam() == LengthUnit::millimeter;
    for (std::uint32_t m = 0; m < again.models.size(); ++m) {
      const Model one = *library_.model(m), other = *again.model(m);
      EXPECT_EQ(other.name, one.name);
      EXPECT_TRUE(std::ranges::equal(other.triangles.a, one.triangles.a));
      EXPECT_TRUE(std::ranges::equal(other.triangles.c, one.triangles.c));
      for (std::size_t v = 0; v < one.vertices.size(); ++v)
        ASSERT_LE((other.vertices[v] - one.vertices[v]).norm(), exact ? 0 : 1e-6F * one.diameter);
      EXPECT_EQ(other.symmetry.poses.size(), one.symmetry.poses.size()) << one.name;
      EXPECT_EQ(other.symmetry.axis.has_value(), one.symmetry.axis.has_value()) << one.name;
    }
    if (!exact) continue;
    const auto second = export_models(again, {}, format, folder_ / (number + "again"));
    ASSERT_TRUE(second) << second.error().message;
    EXPECT_EQ(surfaces(folder_ / (number + "again")), surfaces(folder_ / number)) << number;
  }
}

TEST_P(ExportModels, AreThoseThatAreNamed) {
  const std::vector<std::string> names{"z.lever"};
  const auto files = export_models(library_, names, SurfaceFormat::gltf, folder_ / "one");
  ASSERT_TRUE(files) << files.error().message;
  EXPECT_EQ(*files, std::vector<fs::path>{folder_ / "one" / "z.lever.glb"});
  const std::vector<std::string> unknown{"nut"};
  const auto refused = export_models(library_, unknown, SurfaceFormat::ply, folder_ / "none");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
  EXPECT_FALSE(fs::exists(folder_ / "none"));
}

INSTANTIATE_TEST_SUITE_P(Units, ExportModels,
                         testing::Values(LengthUnit::meter, LengthUnit::millimeter),
                         [](const auto& unit) { return std::string(unit_name(unit.param)); });

}  // namespace
}  // namespace trivet

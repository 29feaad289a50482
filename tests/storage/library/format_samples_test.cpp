// Libraries in every released version of the format, which must stay readable for ever.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "storage/library/library.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> samples() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(TRIVET_TEST_DATA)) {
    if (entry.path().extension() == ".h5") files.push_back(entry.path());
  }
  return files;
}

TEST(FormatSamples, AreReadCompletely) {
  ASSERT_FALSE(samples().empty());
  for (const fs::path& file : samples()) {
    const auto library = verify_library(file);
    ASSERT_TRUE(library) << library.error().message;
    EXPECT_EQ(file.filename().string(),
              fmt::format("library-{}.{}.h5", kLibraryVersionMajor, library->version_minor));
    ASSERT_EQ(library->models.size(), 1U);
    const Model model = *library->model(0);
    EXPECT_EQ(model.name, "marker_0");
    EXPECT_NEAR(model.diameter, 0.131F, 0.02F);
    EXPECT_GE(model.samples.size(), 100U);
    EXPECT_TRUE(library->has_pairs());
    EXPECT_GT(model.ppf.entries.size(), 1000U);
    EXPECT_GT(model.features[0].size(), 100U);
  }
}

TEST(FormatSamples, HaveOneOfTheVersionThatIsWritten) {
  EXPECT_TRUE(fs::exists(fmt::format("{}/library-{}.{}.h5", TRIVET_TEST_DATA, kLibraryVersionMajor,
                                     kLibraryVersionMinor)))
      << "run scripts/format-sample";
}

}  // namespace
}  // namespace trivet

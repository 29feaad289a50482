#include "engine/select_detections.hpp"

#include <gtest/gtest.h>

namespace trivet {
namespace {

using engine::Candidate;

/// Two models, and an image of 10 x 10 measured pixels.
class SelectDetections : public testing::Test {
 protected:
  SelectDetections() {
    for (const char* name : {"large", "small"}) {
      Model model;
      model.name = name;
      model.diameter = 1;
      library_.models.push_back(std::move(model));
    }
    kernels::RangeImage image;
    image.geometry.fx = image.geometry.fy = 1;
    image.geometry.width = image.geometry.height = 10;
    image.depth.assign(100, 1);
    scene_.images.push_back(std::move(image));
  }
  /// A candidate that explains the pixels from `first` on.
  static Candidate candidate(std::uint32_t model, float score, std::uint32_t first,
                             std::uint32_t num_pixels) {
    Candidate out;
    out.model = model;
    out.score = score;
    out.examination.area = static_cast<float>(num_pixels) * 1e-6F;
    for (std::uint32_t i = 0; i < num_pixels; ++i) out.explained.pixels.push_back(first + i);
    return out;
  }
  std::vector<std::string> names(const std::vector<Candidate>& candidates,
                                 const RecogniseOptions& options) const {
    std::vector<std::string> out;
    for (const std::uint32_t c :
         engine::select_detections(library_, scene_, candidates, options).chosen) {
      out.push_back(library_.models[candidates[c].model].name);
    }
    return out;
  }
  Library library_;
  engine::PreparedScene scene_;
};

using Names = std::vector<std::string>;

TEST_F(SelectDetections, PrefersTheLargerSurfaceWhereTwoClaimOnePlace) {
  const std::vector<Candidate> both{candidate(0, 0.55F, 0, 80), candidate(1, 0.6F, 0, 8)};
  EXPECT_EQ(names(both, {}), Names{"large"});
}

// The same two, but the larger one is doubtful: as a candidate of a higher rank it would hide the
// other one.
TEST_F(SelectDetections, LetsNoDoubtfulCandidateHideAnother) {
  const std::vector<Candidate> both{candidate(0, 0.45F, 0, 80), candidate(1, 0.5F, 0, 8)};
  EXPECT_EQ(names(both, {}), Names{"small"});
  EXPECT_EQ(names(both, {.doubtful_score = 0.1F}), (Names{"small", "large"}));
  EXPECT_EQ(names(both, {.doubtful_score = 0.46F}), Names{"small"});
}

TEST_F(SelectDetections, LeavesOutWhatABetterDoubtfulOneExplains) {
  const std::vector<Candidate> three{candidate(0, 0.3F, 0, 10), candidate(0, 0.2F, 0, 10),
                                     candidate(0, 0.2F, 50, 10)};
  EXPECT_EQ(names(three, {.doubtful_score = 0.1F}), (Names{"large", "large"}));
}

}  // namespace
}  // namespace trivet

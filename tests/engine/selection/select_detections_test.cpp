#include "engine/selection/select_detections.hpp"

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
                                 const engine::SelectOptions& options) const {
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

TEST_F(SelectDetections, LetsNoCandidateThatIsRefusedHideOneThatIsReported) {
  const std::vector<Candidate> both{candidate(0, 0.75F, 0, 80), candidate(1, 0.85F, 0, 8)};
  // The small one covers little of the large one, which is refused later, by its score.
  EXPECT_EQ(names(both, {}), (Names{"small", "large"}));
  EXPECT_EQ(names(both, {.min_score = 0.7F}), (Names{"small", "large"})) << "whatever is asked for";
  const std::vector<Candidate> stricter{candidate(0, 0.85F, 0, 80), candidate(1, 0.95F, 0, 8)};
  EXPECT_EQ(names(stricter, {}), Names{"large"});
  EXPECT_EQ(names(stricter, {.min_score = 0.9F}), (Names{"small", "large"}));
}

// The same two, but the larger one is doubtful: as a candidate of a higher rank it would hide the
// other one.
TEST_F(SelectDetections, LetsNoDoubtfulCandidateHideAnother) {
  const std::vector<Candidate> both{candidate(0, 0.45F, 0, 80), candidate(1, 0.5F, 0, 8)};
  EXPECT_EQ(names(both, {}), Names{"small"});
  EXPECT_EQ(names(both, {.doubtful_score = 0.1F}), (Names{"small", "large"}));
  EXPECT_EQ(names(both, {.doubtful_score = 0.46F}), Names{"small"});
}

// What one place holds is then told by the poses alone, each model for itself, by plain score.
TEST_F(SelectDetections, TellsCopiesByTheirPosesWhereExplainedPixelsAreLeftOut) {
  std::vector<Candidate> three{candidate(0, 0.55F, 0, 80), candidate(1, 0.6F, 0, 8),
                               candidate(0, 0.52F, 90, 5)};
  const engine::SelectOptions options{.by_pixels = false};
  EXPECT_EQ(names(three, options), (Names{"small", "large"}));
  three[2].T_scene_model.translation().x() = 0.3F;  // of a diameter of 1
  EXPECT_EQ(names(three, options), (Names{"small", "large", "large"}));
}

TEST_F(SelectDetections, LeavesOutWhatABetterDoubtfulOneExplains) {
  const std::vector<Candidate> three{candidate(0, 0.3F, 0, 10), candidate(0, 0.2F, 0, 10),
                                     candidate(0, 0.2F, 50, 10)};
  EXPECT_EQ(names(three, {.doubtful_score = 0.1F}), (Names{"large", "large"}));
}

// A candidate of two that both claim its pixels: the one with more of them is named.
TEST_F(SelectDetections, TellsWhyACandidateIsNotTaken) {
  const std::vector<Candidate> all{candidate(0, 0.9F, 0, 40), candidate(1, 0.8F, 40, 40),
                                   candidate(1, 0.7F, 34, 10), candidate(0, 0.3F, 80, 10),
                                   candidate(1, 0.2F, 0, 10)};
  const engine::Selection selection = engine::select_detections(library_, scene_, all, {});
  EXPECT_EQ(selection.chosen, (std::vector<std::uint32_t>{0, 1}));
  ASSERT_EQ(selection.refused.size(), 3U);
  const engine::RejectedCandidate& between = selection.refused[0];
  EXPECT_EQ(between.candidate, 2U);
  EXPECT_EQ(between.reason, Rejection::explained);
  EXPECT_EQ(between.explained_by, 0U);
  EXPECT_FLOAT_EQ(between.explained_share, 0.6F);
  const engine::RejectedCandidate& alone = selection.refused[1];
  EXPECT_EQ(alone.candidate, 3U);
  EXPECT_EQ(alone.reason, Rejection::too_low);
  EXPECT_EQ(alone.explained_by, std::nullopt);
  const engine::RejectedCandidate& beneath = selection.refused[2];
  EXPECT_EQ(beneath.reason, Rejection::too_low) << "that alone would have refused it";
  EXPECT_EQ(beneath.explained_by, 0U);
  EXPECT_FLOAT_EQ(beneath.explained_share, 1);
}

TEST_F(SelectDetections, CountsAPixelForTheFirstThatExplainsIt) {
  // The second one covers 10 of the first one's 40 pixels, and then 30 more.
  const std::vector<Candidate> all{candidate(0, 0.9F, 0, 40), candidate(0, 0.8F, 30, 40),
                                   candidate(0, 0.7F, 20, 20)};
  const engine::Selection selection = engine::select_detections(library_, scene_, all, {});
  ASSERT_EQ(selection.refused.size(), 1U);
  EXPECT_EQ(selection.refused[0].explained_by, 0U);
  EXPECT_FLOAT_EQ(selection.refused[0].explained_share, 1);
}

// The first one was taken and then refused: of what it hid, the second one hides the third, what
// stands hides the fourth, and the fifth is too low.
TEST_F(SelectDetections, TakesWhatOnlyARefusedOneHid) {
  const std::vector<Candidate> all{candidate(0, 0.97F, 0, 60), candidate(1, 0.92F, 0, 30),
                                   candidate(1, 0.9F, 0, 20),  candidate(1, 0.93F, 50, 20),
                                   candidate(1, 0.7F, 30, 10), candidate(0, 0.96F, 60, 40)};
  const engine::SelectOptions options;
  engine::Selection selection = engine::select_detections(library_, scene_, all, options);
  ASSERT_EQ(selection.chosen, (std::vector<std::uint32_t>{0, 5}));
  const auto claims = engine::claims_of(library_, all, options);
  const auto sizes = engine::sizes_of(scene_);
  const auto take = [&](std::vector<std::uint32_t> standing) {
    return engine::take_unexplained(sizes, claims, standing, options, selection.refused);
  };
  EXPECT_TRUE(take({0, 5}).empty());
  EXPECT_EQ(selection.refused.size(), 4U);
  EXPECT_EQ(take({5}), std::vector<std::uint32_t>{1});
  const auto refusal_of = [&](std::uint32_t c) {
    return std::ranges::find(selection.refused, c, &engine::RejectedCandidate::candidate);
  };
  ASSERT_EQ(selection.refused.size(), 3U);
  EXPECT_EQ(refusal_of(2)->explained_by, 1U);
  EXPECT_EQ(refusal_of(3)->explained_by, 5U);
  EXPECT_EQ(refusal_of(4)->explained_by, 0U) << "would be refused anyway";
  EXPECT_TRUE(take({1, 5}).empty()) << "all are held against what stands";
}

TEST_F(SelectDetections, TellsWhatIsOneTooMany) {
  const std::vector<Candidate> three{candidate(0, 0.9F, 0, 10), candidate(0, 0.8F, 20, 10),
                                     candidate(1, 0.7F, 20, 10)};
  const engine::Selection selection =
      engine::select_detections(library_, scene_, three, {.max_instances = 1});
  EXPECT_EQ(selection.chosen, std::vector<std::uint32_t>{0});
  ASSERT_EQ(selection.refused.size(), 2U);
  EXPECT_EQ(selection.refused[0].reason, Rejection::too_many);
  EXPECT_EQ(selection.refused[1].reason, Rejection::explained);
  EXPECT_EQ(selection.refused[1].explained_by, 1U) << "what is not asked for explains, too";
  std::vector<engine::RejectedCandidate> refused = selection.refused;
  EXPECT_TRUE(engine::take_unexplained(engine::sizes_of(scene_),
                                       engine::claims_of(library_, three, {}), selection.chosen, {},
                                       refused)
                  .empty());
  EXPECT_EQ(refused.size(), 2U);
}

class BestRefused : public SelectDetections {
 protected:
  /// A candidate whose model lies `x` diameters aside.
  static Candidate aside(std::uint32_t model, float score, float x) {
    Candidate out = candidate(model, score, 0, 10);
    out.T_scene_model.translation().x() = x;
    return out;
  }
  std::vector<std::uint32_t> best(const std::vector<Candidate>& candidates,
                                  const std::vector<Candidate>& detections,
                                  std::uint32_t limit) const {
    std::vector<engine::RejectedCandidate> refused;
    for (std::uint32_t c = 0; c < candidates.size(); ++c) refused.push_back({c});
    std::vector<std::uint32_t> out;
    for (const engine::RejectedCandidate& refusal :
         engine::best_refused(library_, candidates, refused, detections, limit)) {
      out.push_back(refusal.candidate);
    }
    return out;
  }
};

using Indices = std::vector<std::uint32_t>;

TEST_F(BestRefused, LeavesTheBestOfEachModel) {
  const std::vector<Candidate> candidates{aside(0, 0.1F, 0), aside(0, 0.3F, 1), aside(0, 0.2F, 2),
                                          aside(1, 0.25F, 0)};
  EXPECT_EQ(best(candidates, {}, 2), (Indices{1, 3, 2}));
  EXPECT_EQ(best(candidates, {}, 9), (Indices{1, 3, 2, 0}));
}

TEST_F(BestRefused, PrefersWhatMayBeAFurtherInstance) {
  const std::vector<Candidate> candidates{aside(0, 0.9F, 0), aside(0, 0.4F, 1), aside(0, 0.3F, 2),
                                          aside(1, 0.2F, 3)};
  const std::vector<engine::RejectedCandidate> refused{
      {1, Rejection::too_low, 0, 0.8F}, {2, Rejection::too_low}, {3, Rejection::too_low, 0, 0.8F}};
  const auto best = [&](std::uint32_t limit) {
    Indices out;
    for (const engine::RejectedCandidate& refusal :
         engine::best_refused(library_, candidates, refused, {&candidates[0], 1}, limit)) {
      out.push_back(refusal.candidate);
    }
    return out;
  };
  EXPECT_EQ(best(1), (Indices{2, 3})) << "the better one lies beneath one of its own model";
  EXPECT_EQ(best(2), (Indices{1, 2, 3})) << "by falling score";
}

TEST_F(BestRefused, TellsNoPlacementTwice) {
  const std::vector<Candidate> candidates{aside(0, 0.4F, 0), aside(0, 0.3F, 0.09F),
                                          aside(0, 0.2F, 0.11F), aside(1, 0.1F, 0)};
  EXPECT_EQ(best(candidates, {}, 9), (Indices{0, 2, 3}));
  EXPECT_EQ(best(candidates, {aside(0, 0.9F, 0)}, 9), (Indices{2, 3})) << "a detection of it";
  Candidate ambiguous = aside(0, 0.9F, 5);
  ambiguous.alternatives.push_back(candidates[1].T_scene_model);
  EXPECT_EQ(best(candidates, {ambiguous}, 9), (Indices{3})) << "an alternative of one";
}

}  // namespace
}  // namespace trivet

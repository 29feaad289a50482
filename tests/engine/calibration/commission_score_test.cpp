#include "engine/calibration/commission_score.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "engine/loaded_library/default_score.hpp"
#include "support/random.hpp"

namespace trivet {
namespace {

using kernels::kNumScoreParts;

constexpr float kLeast = 0.8F;

/// Outcomes of a cell whose poses are right as often as `cell` predicts; half are near the best.
Outcomes draw(const kernels::ScoreModel& cell, std::size_t num_scans, std::size_t per_scan,
              std::uint64_t seed) {
  test::Random random(seed);
  Outcomes outcomes;
  for (std::uint32_t s = 0; s < num_scans; ++s) {
    outcomes.scans.push_back("scan_" + std::to_string(s) + ".ply");
    for (std::size_t i = 0; i < per_scan; ++i) {
      const float best = i % 2 == 0 ? random.uniform(0.7F, 1) : random.uniform(0, 1);
      kernels::ScoreParts parts;
      for (std::size_t k = 0; k < kNumScoreParts; ++k) {
        const auto& knots = cell.knots[k];
        const float low = kernels::kScoreParts[k].favorable ? knots.front() : knots.back();
        const float high = kernels::kScoreParts[k].favorable ? knots.back() : knots.front();
        parts[k] = std::lerp(std::lerp(low, high, random.uniform(0, 1)), high, best);
      }
      parts[kernels::kCorrelationPart] = 0.3F;
      outcomes.parts.push_back(parts);
      outcomes.right.push_back(random.uniform(0, 1) < kernels::pose_probability(cell, parts) ? 1
                                                                                             : 0);
      outcomes.scan.push_back(s);
    }
  }
  return outcomes;
}

/// A cell in which the default score is far too confident.
kernels::ScoreModel unlike_cell() {
  kernels::ScoreAdaptation adaptation;
  adaptation.shift = -2;
  adaptation.weights[0] = 1.4F;
  return kernels::adapted_score(default_score(), adaptation);
}

std::string refusal(const Outcomes& outcomes) {
  const Result<Commissioning> found = commission_score(default_score(), outcomes, kLeast);
  EXPECT_FALSE(found);
  if (found) return "";
  EXPECT_EQ(found.error().code, ErrorCode::bad_data);
  return found.error().message;
}

TEST(CommissionScore, HelpsACellThatTheDefaultDoesNotKnowFromFiveScans) {
  const Outcomes outcomes = draw(unlike_cell(), 5, 60, 1);
  const Result<Commissioning> found = commission_score(default_score(), outcomes, kLeast);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(found->helps());
  EXPECT_LT(found->after.log_loss, found->before.log_loss);
  const Outcomes fresh = draw(unlike_cell(), 40, 60, 2);
  const auto wrong_of = [&](const kernels::ScoreModel& score) {
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < fresh.right.size(); ++i) {
      wrong += fresh.right[i] == 0 && kernels::pose_probability(score, fresh.parts[i]) >= kLeast;
    }
    return wrong;
  };
  EXPECT_LT(wrong_of(kernels::adapted_score(default_score(), found->adaptation)),
            wrong_of(default_score()));
}

TEST(CommissionScore, LetsNoWrongOutcomeRiseOverTheLeastScore) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    Outcomes outcomes = draw(default_score(), 5, 40, seed);
    test::Random random(seed);
    // Some poses get random marks.
    for (std::uint8_t& right : outcomes.right)
      if (random.uniform(0, 1) < 0.3F) right = static_cast<std::uint8_t>(random.below(2));
    const Result<Commissioning> found = commission_score(default_score(), outcomes, kLeast);
    if (!found) continue;
    const kernels::ScoreModel adapted = kernels::adapted_score(default_score(), found->adaptation);
    for (std::size_t i = 0; i < outcomes.right.size(); ++i) {
      if (outcomes.right[i] != 0) continue;
      if (kernels::pose_probability(default_score(), outcomes.parts[i]) < kLeast) {
        EXPECT_LT(kernels::pose_probability(adapted, outcomes.parts[i]), kLeast) << seed;
      }
    }
    EXPECT_LE(found->after.wrong, found->before.wrong);
    EXPECT_LE(found->after.log_loss, found->before.log_loss);
    if (!found->helps()) {
      EXPECT_EQ(found->adaptation, kernels::ScoreAdaptation{});
    }
  }
}

// The default score is optimal for the scans that it was fitted to.
TEST(CommissionScore, ChangesLittleWhereTheDefaultIsRight) {
  const Outcomes fresh = draw(default_score(), 50, 60, 99);
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Outcomes outcomes = draw(default_score(), 5, 40, seed);
    const Result<Commissioning> found = commission_score(default_score(), outcomes, kLeast);
    ASSERT_TRUE(found) << found.error().message;
    const kernels::ScoreModel adapted = kernels::adapted_score(default_score(), found->adaptation);
    double moved = 0;
    for (const kernels::ScoreParts& parts : fresh.parts) {
      moved += static_cast<double>(std::abs(kernels::pose_probability(adapted, parts) -
                                            kernels::pose_probability(default_score(), parts)));
    }
    EXPECT_LT(moved / static_cast<double>(fresh.parts.size()), 0.06) << seed;
  }
}

TEST(CommissionScore, RefusesTooFewScansOrMarksOfEitherKind) {
  EXPECT_NE(refusal({}).find("found 0 with 0 and 0"), std::string::npos);
  EXPECT_NE(refusal(draw(unlike_cell(), 1, 100, 1)).find("at least 2 scans"), std::string::npos);
  Outcomes all_right = draw(default_score(), 5, 20, 2);
  for (std::uint8_t& right : all_right.right) right = 1;
  EXPECT_NE(refusal(all_right).find("with 100 and 0"), std::string::npos);
  for (std::uint8_t& right : all_right.right) right = 0;
  EXPECT_NE(refusal(all_right).find("with 0 and 100"), std::string::npos);
}

TEST(CommissionScore, RefusesMarksThatAreSwapped) {
  Outcomes outcomes = draw(default_score(), 5, 60, 3);
  for (std::uint8_t& right : outcomes.right) right = static_cast<std::uint8_t>(1 - right);
  EXPECT_NE(refusal(outcomes).find("swapped"), std::string::npos);
}

}  // namespace
}  // namespace trivet

#include "apps/words/candidate_words.hpp"

#include <gtest/gtest.h>

namespace trivet::apps {
namespace {

Candidate block(std::size_t rays) {
  return {.model = "block_b",
          .share = 0.38F,
          .rays = rays,
          .differs = CandidateDifference{{1, 2, 3}, 12, 8, {0, 0, -1}}};
}

TEST(CandidateWords, StateWhereItDiffersAndWhereFromThatWouldBeSeen) {
  EXPECT_EQ(candidate_words(block(0), {100, 0, 0}, "mm"),
            "block_b 0.38: differs by up to 8 mm around (101, 2, 3); not seen from here, seen from "
            "(0.00, 0.00, -1.00)");
}

TEST(CandidateWords, StateHowManyRaysMeasureIt) {
  EXPECT_EQ(candidate_words(block(7), {0, 0, 0}, "mm"),
            "block_b 0.38: differs by up to 8 mm around (1, 2, 3); 7 rays there, seen best from "
            "(0.00, 0.00, -1.00)");
}

TEST(CandidateWords, AreTheNameAndTheShareOfTheFirst) {
  EXPECT_EQ(candidate_words({.model = "block_a", .share = 0.62F}, {0, 0, 0}, "mm"), "block_a 0.62");
}

}  // namespace
}  // namespace trivet::apps

#include "storage/common/precondition.hpp"

#include <gtest/gtest.h>

#include "storage/common/result.hpp"
#include "storage/data/neighborhoods.hpp"
#include "storage/data/points.hpp"

namespace trivet {
namespace {

TEST(Precondition, ThrowsInEveryBuildAndNamesTheExpectation) {
  const int width = 3;
  EXPECT_NO_THROW(TRIVET_REQUIRE(width == 3, "whole rows"));
  try {
    TRIVET_REQUIRE(width == 4, "whole rows");
    FAIL() << "nothing was thrown";
  } catch (const BrokenPrecondition& broken) {
    const std::string message = broken.what();
    EXPECT_NE(message.find("expected whole rows (width == 4, precondition_test.cpp:"), message.npos)
        << message;
  }
}

TEST(Precondition, OfAResultIsThatItHoldsWhatIsAskedFor) {
  const Result<int> failed = Error{ErrorCode::bad_data, "no number"};
  EXPECT_THROW(static_cast<void>(failed.value()), BrokenPrecondition);
  EXPECT_THROW(static_cast<void>(*failed), BrokenPrecondition);
  EXPECT_THROW(static_cast<void>(Result<int>(7).error()), BrokenPrecondition);
  EXPECT_THROW(static_cast<void>(Result<void>().error()), BrokenPrecondition);
}

TEST(Precondition, OfASliceIsThatItLiesWithin) {
  Points points(5);
  EXPECT_EQ(points.view().slice(2, 3).size(), 3U);
  EXPECT_EQ(points.view().slice(5, 0).size(), 0U);
  EXPECT_THROW(static_cast<void>(points.view().slice(2, 4)), BrokenPrecondition);
  EXPECT_THROW(static_cast<void>(points.span().slice(6, 0)), BrokenPrecondition);
  EXPECT_THROW(static_cast<void>(points.view().slice(1, ~std::size_t{0})), BrokenPrecondition);

  const Neighborhoods rows{{0, 1, 1}, {4}};
  EXPECT_EQ(rows.view().rows(1, 1).size(), 1U);
  EXPECT_THROW(static_cast<void>(rows.view().rows(1, 2)), BrokenPrecondition);
  EXPECT_THROW(static_cast<void>(NeighborhoodsView().rows(0, 1)), BrokenPrecondition);
}

}  // namespace
}  // namespace trivet

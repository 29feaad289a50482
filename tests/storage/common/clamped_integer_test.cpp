#include "storage/common/clamped_integer.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace trivet {
namespace {

TEST(ClampedInteger, CutsTowardsZeroWithinItsBounds) {
  EXPECT_EQ(clamped_integer(3.99F, 0, 10), 3);
  EXPECT_EQ(clamped_integer(-3.99, -10, 10), -3);
  EXPECT_EQ(clamped_integer(-11.0, -10, 10), -10);
  EXPECT_EQ(clamped_integer(10.5, -10, 10), 10);
}

TEST(ClampedInteger, IsDefinedForEveryNumber) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(clamped_integer(kNaN, 1, 10), 1);
  EXPECT_EQ(clamped_integer(kInfinity, 1, 10), 10);
  EXPECT_EQ(clamped_integer(-kInfinity, 1, 10), 1);
  // The bounds of the type, which a float cannot represent.
  constexpr auto kMost = std::numeric_limits<std::uint32_t>::max();
  EXPECT_EQ(clamped_integer(4294967296.0F, 0U, kMost), kMost);
  EXPECT_EQ(clamped_integer(4294967040.0F, 0U, kMost), 4294967040U);
  EXPECT_EQ(clamped_integer(1e30, std::int64_t{0}, std::numeric_limits<std::int64_t>::max()),
            std::numeric_limits<std::int64_t>::max());
}

}  // namespace
}  // namespace trivet

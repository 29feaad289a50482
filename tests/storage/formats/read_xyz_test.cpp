#include <gtest/gtest.h>

#include "storage/read_cloud.hpp"
#include "support/geometry_files.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using test::is_refused;
using Vector = Eigen::Vector3f;

class ReadXyz : public testing::Test {
 protected:
  Result<Cloud> read(const std::string& bytes, const ReadOptions& options = {}) {
    return read_cloud(folder_.write("cloud.XYZ", bytes), options);
  }
  test::TempDir folder_;
};

TEST_F(ReadXyz, TakesEverySeparatorCommentsAndAHeaderLine) {
  for (const std::string text : {"1 2 3\n4 5 6\n", "1,2,3\r\n4, 5, 6", "1;2;3\n\n4\t5\t6 # last\n",
                                 "# by hand\nX Y Z\n1 2 3\n4 5 6\n", "2\n1 2 3\n4 5 6\n",
                                 "  1 2 3 0.7\n 4 5 6 0.1\n", "//X,Y,Z\n+1,2.,3e0\n4,5,6\n"}) {
    const auto cloud = read(text);
    ASSERT_TRUE(cloud) << text << cloud.error().message;
    ASSERT_EQ(cloud->points.size(), 2U) << text;
    EXPECT_EQ(cloud->points[0], Vector(1, 2, 3));
    EXPECT_EQ(cloud->points[1], Vector(4, 5, 6));
    EXPECT_TRUE(cloud->normals.empty());
  }
}

TEST_F(ReadXyz, TakesSixColumnsAsNormalsUnlessTheyAreColors) {
  const auto normals = read("0 0 0 0 0.6 0.8 99\n1 0 0 0 0 0 99\n"),
             colors = read("0 0 0 255 0 0\n1 0 0 0 1 0\n");
  ASSERT_TRUE(normals && colors);
  ASSERT_EQ(normals->normals.size(), 2U);
  EXPECT_EQ(normals->normals[0], Vector(0, 0.6F, 0.8F));
  EXPECT_TRUE(colors->normals.empty());
}

TEST_F(ReadXyz, NamesTheLineThatIsWrong) {
  EXPECT_TRUE(is_refused(read("1 2 3\n4 5\n"), "line 2: expected three numbers x y z, found 2"));
  EXPECT_TRUE(is_refused(read("X Y Z\n1 2 3\nA B C\n"), "line 3"));
  EXPECT_TRUE(is_refused(read("1 2 3 0 0 1\n4 5 6\n"), "line 2: expected six numbers"));
  EXPECT_TRUE(is_refused(read("1 2 3\n4 5 6\n", {.max_points = 1}), "limit of 1"));
  EXPECT_TRUE(is_refused(read("# nothing\n"), "at least one point"));
}

}  // namespace
}  // namespace trivet

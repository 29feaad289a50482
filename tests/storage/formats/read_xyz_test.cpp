#include <gtest/gtest.h>

#include "storage/formats/read_cloud.hpp"
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

TEST_F(ReadXyz, ReadsEverySeparatorCommentsAndAHeaderLine) {
  for (const std::string text :
       {"1 2 3\n4 5 6\n", "1,2,3\r\n4, 5, 6", "1;2;3\n\n4;5;6 # last\n",
        "1 2\t3\n\n4\t5 6\t# last\n", "# by hand\nX Y Z\n1 2 3\n4 5 6\n", "2\n1 2 3\n4 5 6\n",
        "  1 2 3 0.7\n 4 5 6 0.1\n", "//X,Y,Z\n+1,2.,3e0\n4,5,6\n"}) {
    const auto cloud = read(text);
    ASSERT_TRUE(cloud) << text << cloud.error().message;
    ASSERT_EQ(cloud->points.size(), 2U) << text;
    EXPECT_EQ(cloud->points[0], Vector(1, 2, 3));
    EXPECT_EQ(cloud->points[1], Vector(4, 5, 6));
    EXPECT_TRUE(cloud->normals.empty());
  }
}

TEST_F(ReadXyz, ReadsSixColumnsAsNormalsUnlessTheyAreColors) {
  const auto normals = read("0 0 0 0 0.6 0.8 99\n1 0 0 0 0 0 99\n"),
             colors = read("0 0 0 255 0 0\n1 0 0 0 1 0\n");
  ASSERT_TRUE(normals && colors);
  ASSERT_EQ(normals->normals.size(), 2U);
  EXPECT_EQ(normals->normals[0], Vector(0, 0.6F, 0.8F));
  EXPECT_TRUE(colors->normals.empty());
}

TEST_F(ReadXyz, NamesTheLineThatIsWrong) {
  EXPECT_TRUE(is_refused(read("1 2 3\n4 5\n"), "line 2: expected 3 columns as in line 1, found 2"));
  EXPECT_TRUE(is_refused(read("X Y Z\n1 2 3\nA B C\n"), "line 3"));
  EXPECT_TRUE(
      is_refused(read("1 2 3 0 0 1\n4 5 6\n"), "line 2: expected 6 columns as in line 1, found 3"));
  EXPECT_TRUE(is_refused(read("1 2 3\n4 5 6\n", {.max_points = 1}), "limit of 1"));
  EXPECT_TRUE(is_refused(read("# nothing\n"), "at least one point"));
}

TEST_F(ReadXyz, TreatsAByteOrderMarkAsOneAtTheBeginningOnly) {
  EXPECT_EQ(read("\xEF\xBB\xBF"
                 "1 2 3\n4 5 6\n")
                ->points.size(),
            2U);
  EXPECT_FALSE(read("#\n\xEF\xBB\xBF \nx 0 0\n"));
  EXPECT_FALSE(read("1 2 3\n\xEF\xBB\xBF \n"));
}

TEST_F(ReadXyz, DistinguishesDecimalCommasFromThoseBetweenColumns) {
  for (const std::string text :
       {"1,5 2,25 -3,125\n4 5,5 6\n", "1,5;2,25;-3,125\n4;5,5;6\n",
        "1,5\t2,25\t-3,125\n4\t5,5\t6\n", "1.5,2.25,-3.125\n4,5.5,6\n",
        "1.5;2.25;-3.125\n4;5.5;6\n", "15e-1, 2.25 ,-3.125\n4,5.5,6\n",
        "\"1,5\";\"2,25\";\"-3,125\"\n\"4\";\"5,5\";\"6\"\n", "1,5; 2,25; -3,125;\n4; 5,5; 6;\n"}) {
    const auto cloud = read(text);
    ASSERT_TRUE(cloud) << text << cloud.error().message;
    EXPECT_EQ(cloud->points[0], Vector(1.5F, 2.25F, -3.125F)) << text;
    EXPECT_EQ(cloud->points[1], Vector(4, 5.5F, 6)) << text;
  }
}

TEST_F(ReadXyz, RefusesRowsThatReadInMoreThanOneWay) {
  EXPECT_TRUE(is_refused(read("1,5 2,5 3,5\n1.5 2.5 3.5\n"), "line 2: expected the decimal mark"));
  EXPECT_TRUE(is_refused(read("1,000.5;2;3\n"), "line 1: expected a number as x in column 1"));
  EXPECT_TRUE(
      is_refused(read("1 2 3\n4,5,6\n"), "line 2: expected 3 columns as in line 1, found 1"));
  EXPECT_TRUE(is_refused(read("1,2,3\n1,5,2,25,3\n"), "line 2: expected 3 columns"));
  EXPECT_TRUE(is_refused(read("1 2 3\n4 5 6 7\n"), "line 2: expected 3 columns"));
  EXPECT_TRUE(is_refused(read("1,2,3,4\n,2,3,4\n"),
                         "line 2: expected a number as x in column 1, "
                         "found an empty column"));
  EXPECT_TRUE(is_refused(read("l.0 2 3\n4 5 6\n"), "line 1: expected a number as x"));
  EXPECT_TRUE(is_refused(read("1 2 x\n4 5 6\n"), "line 1: expected a number as z"));
  const auto empty = read("1,2,3,a\n4,5,6,\n7,8,9,b,\n");
  ASSERT_TRUE(empty) << empty.error().message;
  EXPECT_EQ(empty->points.size(), 3U) << "other columns may be empty";
}

TEST_F(ReadXyz, TreatsColorsOfZeroAndOneAsNoNormals) {
  const auto colors = read("0 0 0 1 0 0\n1 0 0 0 1 0\n0 1 0 0 0 1\n1 1 0 0 0 0\n");
  const auto box = read("0 0 0 1 0 0\n1 0 0 0 -1 0\n0 1 0 0 0 1\n");
  const auto named = read("x y z nx ny nz\n0 0 0 1 0 0\n1 0 0 0 1 0\n");
  ASSERT_TRUE(colors && box && named);
  EXPECT_TRUE(colors->normals.empty());
  EXPECT_EQ(box->normals.size(), 3U);
  EXPECT_EQ(named->normals.size(), 2U);

  // Two walls of a corner with their normals, and a tabletop in two colors.
  std::string walls, table;
  for (const char* row : {"0 0", "0 1", "1 0", "1 1", "2 0", "2 1"}) {
    walls += std::string(row) + " 0 0 0 1\n" + row[0] + " 0 " + row[2] + " 0 1 0\n";
    table += std::string(row) + " 5" + (row[0] == '1' ? " 0 1 0\n" : " 0 0 1\n");
  }
  const auto corner = read(walls), mottled = read(table);
  ASSERT_TRUE(corner && mottled);
  EXPECT_EQ(corner->normals.size(), 12U) << "each wall lies flat across its normal";
  EXPECT_TRUE(mottled->normals.empty());
}

TEST_F(ReadXyz, ReadsColumnsByTheirNames) {
  for (const std::string text : {"id,X,Y,Z,nx,ny,nz\n7,1,2,3,0,0,1\n8,4,5,6,0,0,1\n",
                                 "\"name\";\"Z [m]\";\"Y [m]\";\"X [m]\";\"NZ\";\"NY\";\"NX\"\na "
                                 "b;3;2;1;1;0;0\nc;6;5;4;1;0;0\n",
                                 "# i x y z r nx ny nz\n9 1 2 3 255 0 0 1\n9 4 5 6 0 0 0 1\n",
                                 "//Z,Y,X,Normal_X,Normal_Y,Normal_Z\n3,2,1,0,0,1\n6,5,4,0,0,1\n",
                                 "z,y,x,NormalX,NormalY,NormalZ\n3,2,1,0,0,1,\n6,5,4,0,0,1,\n"}) {
    const auto cloud = read(text);
    ASSERT_TRUE(cloud) << text << cloud.error().message;
    ASSERT_EQ(cloud->points.size(), 2U) << text;
    EXPECT_EQ(cloud->points[0], Vector(1, 2, 3)) << text;
    EXPECT_EQ(cloud->points[1], Vector(4, 5, 6)) << text;
    ASSERT_EQ(cloud->normals.size(), 2U) << text;
    EXPECT_EQ(cloud->normals[1], Vector(0, 0, 1)) << text;
  }
  const auto colors = read("x,y,z,r,g,b\n1,2,3,0.6,0.8,0\n");
  ASSERT_TRUE(colors) << colors.error().message;
  EXPECT_TRUE(colors->normals.empty()) << "the names say that they are colors";
  EXPECT_TRUE(is_refused(read("id,east,north,height\n1,2,3,4\n"),
                         "line 1: expected the names of 4 columns with x, y and z among them"));
  EXPECT_TRUE(is_refused(read("z,y,x\n1,2,3,4\n"), "line 1: expected the names of 4 columns"));
}

TEST_F(ReadXyz, HoldsAFileToItsNumberOfPoints) {
  const auto cloud = read("2\n1 2 3 -900 10 20 30\n4 5 6 -800 10 20 30\n1\n7 8 9 0 1 1 1\n");
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->points.size(), 3U) << "two scans of a .pts file";
  EXPECT_TRUE(cloud->normals.empty());
  EXPECT_TRUE(is_refused(read("3\n1 2 3\n4 5 6\n"),
                         "line 1: expected 3 points as this line says, found 2"));
  EXPECT_TRUE(is_refused(read("1\n1 2 3\n4 5 6\n"), "line 1: expected 1 points"));
  EXPECT_TRUE(is_refused(read("640\n480\n0 0 0\n"), "line 1: expected 640 points"));
  EXPECT_TRUE(is_refused(read("1 2 3\n4\n"), "line 2: expected 3 columns"));
}

}  // namespace
}  // namespace trivet

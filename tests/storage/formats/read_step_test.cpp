// STEP files where they can be read, and the error message where they cannot.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"
#include "support/temp_dir.hpp"

#ifdef TRIVET_BUILD_STEP
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <Interface_Static.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Writer.hxx>
#include <gp_Ax2.hxx>
#include <numbers>
#endif

namespace trivet {
namespace {

#ifdef TRIVET_BUILD_STEP

constexpr double kLength = 40, kWidth = 30, kHeight = 20, kRadius = 5;  // [mm]

/// A box with a hole from top to bottom.
std::filesystem::path write_part(const test::TempDir& folder, const char* unit) {
  const gp_Ax2 axis(gp_Pnt(kLength / 2, kWidth / 2, 0), gp_Dir(0, 0, 1));
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(kLength, kWidth, kHeight).Shape();
  const TopoDS_Shape hole = BRepPrimAPI_MakeCylinder(axis, kRadius, kHeight).Shape();
  STEPControl_Controller::Init();
  Interface_Static::SetCVal("write.step.unit",
                            unit);  // writers read the unit when they are created
  STEPControl_Writer writer;
  EXPECT_EQ(writer.Transfer(BRepAlgoAPI_Cut(box, hole).Shape(), STEPControl_AsIs),
            IFSelect_RetDone);
  const std::filesystem::path file = folder / "part.step";
  EXPECT_EQ(writer.Write(file.c_str()), IFSelect_RetDone);
  return file;
}

double volume(const Cloud& cloud) {
  double sum = 0;
  for (std::size_t t = 0; t < cloud.triangles.size(); ++t) {
    const Eigen::Vector3d a = cloud.points[cloud.triangles.a[t]].cast<double>();
    const Eigen::Vector3d b = cloud.points[cloud.triangles.b[t]].cast<double>();
    const Eigen::Vector3d c = cloud.points[cloud.triangles.c[t]].cast<double>();
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

TEST(ReadStep, GivesAClosedSurfaceOfTheRightVolumeInTheUnitAskedFor) {
  const double exact = kLength * kWidth * kHeight - std::numbers::pi * kRadius * kRadius * kHeight;
  const test::TempDir folder;
  for (const char* written : {"MM", "M", "INCH"}) {
    const auto file = write_part(folder, written);
    for (const auto& [unit, scale] : {std::pair(std::optional<LengthUnit>(), 1.0),
                                      std::pair(std::optional(LengthUnit::millimeter), 1.0),
                                      std::pair(std::optional(LengthUnit::meter), 1e-3)}) {
      const auto cloud = read_cloud(file, {.unit = unit});
      ASSERT_TRUE(cloud) << cloud.error().message;
      ASSERT_TRUE(test::is_valid(*cloud));
      // The polygon in the hole lies inside its circle by at most a thousandth of the diagonal.
      EXPECT_NEAR(volume(*cloud) / (scale * scale * scale), exact, 1e-3 * exact) << written;
    }
  }
}

TEST(ReadStep, RefusesWhatIsDamagedAndWhatClientsSend) {
  const test::TempDir folder;
  const std::string bytes = test::read_bytes(write_part(folder, "MM"));
  EXPECT_TRUE(read_cloud(folder.write("part.stp", bytes)));
  EXPECT_TRUE(read_cloud(folder.write("part.step.gz", test::gzip_file(bytes))));
  for (const std::size_t size : {std::size_t{13}, bytes.size() / 4, bytes.size() / 2})
    EXPECT_TRUE(test::is_refused(read_cloud(folder.write("cut.step", bytes.substr(0, size))), ""))
        << size;
  EXPECT_TRUE(test::is_refused(read_cloud(folder.write("text.step", "a text")), "STEP"));
  const auto sent = read_cloud(std::as_bytes(std::span(bytes)), "trivet_body.step");
  EXPECT_TRUE(test::is_refused(sent, "from files only"));
}

#else

TEST(ReadStep, SaysHowToReadItWhereItWasNotBuilt) {
  const test::TempDir folder;
  for (const char* name : {"part.step", "part.STP", "part"}) {
    const auto cloud = read_cloud(folder.write(name, "ISO-10303-21;\nHEADER;\n"));
    EXPECT_TRUE(test::is_refused(cloud, "-DTRIVET_BUILD_STEP=ON")) << name;
  }
  EXPECT_FALSE(is_cloud_file("part.step"));
}

#endif

}  // namespace
}  // namespace trivet

#include "storage/formats/readers.hpp"

#ifdef TRIVET_BUILD_STEP
#include <fmt/format.h>

#include <BRepBndLib.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <Poly_Triangulation.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <cmath>
#include <mutex>
#include <sstream>
#include <string>

#include "storage/files/text.hpp"

namespace trivet::formats {
namespace {

constexpr double kChordShare = 1e-3;  ///< deviation of triangles, relative to the part's diagonal
constexpr double kAngle = 0.2;  ///< angle between neighboring triangles of a curved face [rad]

/// The file's shapes as one, in millimeters.
Result<TopoDS_Shape> read_shape(const Input& input) {
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
  STEPControl_Reader reader;
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  std::istringstream stream{std::string(input.text())};
  if (reader.ReadStream(input.file.c_str(), stream) != IFSelect_RetDone)
    return input.refuse("cannot be read as STEP; the file is truncated or damaged");
  reader.TransferRoots();
  const TopoDS_Shape shape = reader.OneShape();
  if (shape.IsNull()) return input.refuse("expected a shape in the STEP file, found none");
  return shape;
}

/// Tessellate the faces with a deviation relative to the shape's size.
Result<void> tessellate(const Input& input, const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box);
  if (box.IsVoid()) return input.refuse("expected faces in the STEP file, found none");
  const double diagonal = std::sqrt(box.SquareExtent());
  if (!(diagonal > 0 && std::isfinite(diagonal)))
    return input.refuse("expected a shape of some extent in the STEP file, found none");
  const BRepMesh_IncrementalMesh mesh(shape, kChordShare * diagonal, false, kAngle);
  if (!mesh.IsDone())
    return input.refuse("the faces of the STEP file cannot be cut into triangles");
  return {};
}

/// Triangles of a face, counter-clockwise seen from outside the solid.
Result<void> add_face(const Input& input, const TopoDS_Face& face, double scale, Cloud& cloud) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) triangles = BRep_Tool::Triangulation(face, location);
  if (triangles.IsNull()) {
    return input.refuse(
        "a face of the STEP file cannot be cut into triangles; heal the model and export it again");
  }
  const auto first = static_cast<std::uint32_t>(cloud.points.size());
  const std::uint64_t num_points =
      cloud.points.size() + static_cast<std::uint64_t>(triangles->NbNodes());
  if (num_points > input.max_points()) return input.refuse_count(num_points);
  for (Standard_Integer n = 1; n <= triangles->NbNodes(); ++n) {
    const gp_Pnt p = triangles->Node(n).Transformed(location.Transformation());
    cloud.points.push_back(
        {to_float(scale * p.X()), to_float(scale * p.Y()), to_float(scale * p.Z())});
  }
  const bool reversed = face.Orientation() == TopAbs_REVERSED;
  for (Standard_Integer t = 1; t <= triangles->NbTriangles(); ++t) {
    Standard_Integer a = 0, b = 0, c = 0;
    triangles->Triangle(t).Get(a, b, c);
    if (reversed) std::swap(b, c);
    const auto index = [&](Standard_Integer node) {
      return first + static_cast<std::uint32_t>(node) - 1;
    };
    cloud.triangles.push_back(index(a), index(b), index(c));
  }
  return {};
}

Result<Cloud> read_faces(const Input& input) {
  TRIVET_TRY_ASSIGN(const auto shape, read_shape(input));
  TRIVET_TRY(tessellate(input, shape));
  const double scale =
      unit_scale(LengthUnit::millimeter, input.options.unit.value_or(LengthUnit::millimeter));
  Cloud cloud;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
    TRIVET_TRY(add_face(input, TopoDS::Face(face.Current()), scale, cloud));
  }
  return cloud;
}

}  // namespace

Result<Cloud> read_step(const Input& input) {
  // OpenCASCADE is not safe for untrusted input.
  if (!input.folder)
    return input.refuse("STEP is read from files only; export it as glTF (.glb), PLY or STL");
  static std::mutex one_at_a_time;  // OpenCASCADE's readers share settings
  const std::lock_guard lock(one_at_a_time);
  try {
    return read_faces(input);
  } catch (const Standard_Failure& failure) {
    return input.refuse(fmt::format("cannot be read as STEP: {}", failure.GetMessageString()));
  }
}

}  // namespace trivet::formats

#else

namespace trivet::formats {

Result<Cloud> read_step(const Input& input) {
  return input.refuse(
      "STEP is read by builds with -DTRIVET_BUILD_STEP=ON only (docs/manifest.md); or export it as "
      "glTF (.glb), PLY or STL");
}

}  // namespace trivet::formats

#endif

/// The readers, one per format. Each checks every count against the size of the data before it
/// allocates memory, and every index against its bound; errors are bad_data and name the position.
#pragma once

#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/files/input.hpp"

namespace trivet::formats {

/// Decompress, choose a reader by name or content, read, then run the common checks and cleanup.
Result<Cloud> read(const Input& input);

/// Greg Turk's PLY 1.0, with Stanford's tristrips and range_grid, and PCL's camera element. Faces
/// of one or two corners, which some writers use for lines, give no triangles.
Result<Cloud> read_ply(const Input& input);

/// The Point Cloud Library's PCD 0.7: ascii, binary, binary_compressed.
Result<Cloud> read_pcd(const Input& input);

/// Wavefront OBJ: v, f, and vn if it has the index of its vertex. Points, lines and curves are
/// skipped, free-form surfaces refused.
Result<Cloud> read_obj(const Input& input);

/// STL, text or binary; corners at equal coordinates become one point.
Result<Cloud> read_stl(const Input& input);

/// Geomview OFF, text or binary, with or without normals, colors and texture coordinates. Faces of
/// one or two corners, which the format allows, give no triangles.
Result<Cloud> read_off(const Input& input);

/// Text of one point per line: x y z, or x y z nx ny nz, or columns named by a header.
Result<Cloud> read_xyz(const Input& input);

/// glTF 2.0, as JSON or binary (GLB): the triangles of the scene's meshes with the transforms of
/// their nodes, or the points of a scene without triangles. Lines are skipped. Lengths are in
/// meters.
Result<Cloud> read_gltf(const Input& input);

/// STEP (ISO 10303-21) by OpenCASCADE, tessellated with a deviation of at most a thousandth of the
/// part's diagonal. Lengths are in millimeters, whatever the file's unit. Only from files, and only
/// in builds with TRIVET_BUILD_STEP.
Result<Cloud> read_step(const Input& input);

/// A NumPy array: points (N, 3), with normals (N, 6), organized (height, width, 3 or 6), or depths
/// (height, width), which need the camera in the options. Pixels at the origin or without a depth
/// above zero have no measurement.
Result<Cloud> read_npy(const Input& input);

/// 16-bit gray depth PNG; zero is no measurement. Needs the camera in the options.
Result<Cloud> read_depth_png(const Input& input);

/// Depth TIFF with one 16-bit unsigned or 32-bit float value per pixel, in strips or tiles; zero
/// and non-finite values are no measurement. Needs the camera in the options.
Result<Cloud> read_depth_tiff(const Input& input);

}  // namespace trivet::formats

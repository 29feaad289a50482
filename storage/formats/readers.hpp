/// The readers, one a format. Each checks every count against the bytes that are there before it
/// takes memory, and every index against its bound; errors are bad_data and name the place.
#pragma once

#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/files/input.hpp"

namespace trivet::formats {

/// Unpack, read by the file's name or content, then check and clean what all formats have in common.
Result<Cloud> read(const Input& input);

/// Greg Turk's PLY 1.0, with Stanford's tristrips and range_grid, and PCL's camera element. Faces of one
/// or two corners, as writers put lines, make no triangles.
Result<Cloud> read_ply(const Input& input);

/// The Point Cloud Library's PCD 0.7: ascii, binary, binary_compressed.
Result<Cloud> read_pcd(const Input& input);

/// Wavefront OBJ: v, vn where it has the index of its vertex, f. Points, lines and curves are left
/// out, free-form surfaces refused.
Result<Cloud> read_obj(const Input& input);

/// STL, text or binary; corners at equal coordinates become one point.
Result<Cloud> read_stl(const Input& input);

/// Geomview OFF, text or binary, with or without normals, colors and texture coordinates. Faces of
/// one or two corners, which the format has, make no triangles.
Result<Cloud> read_off(const Input& input);

/// Text of one point a line: x y z, or x y z nx ny nz, or what a header of names says.
Result<Cloud> read_xyz(const Input& input);

/// glTF 2.0, as JSON or binary (GLB): the triangles of the scene's meshes, each where its nodes put it;
/// of a scene without triangles the points. Lines are left out. Lengths are in meters.
Result<Cloud> read_gltf(const Input& input);

/// STEP (ISO 10303-21) by OpenCASCADE, cut into triangles no farther from its faces than a thousandth
/// of the part's diagonal. Lengths are in millimeters, whatever the file's unit. From files only; and
/// only in builds with TRIVET_BUILD_STEP.
Result<Cloud> read_step(const Input& input);

/// A NumPy array: points (N, 3), with normals (N, 6), organized (height, width, 3 or 6), or depths
/// (height, width), which need the camera in the options. Pixels at the origin or without a depth
/// above zero are such without a measurement.
Result<Cloud> read_npy(const Input& input);

/// 16-bit gray PNG of depths; zero is no measurement. Needs the camera in the options.
Result<Cloud> read_depth_png(const Input& input);

/// TIFF of depths, one 16-bit unsigned or 32-bit float value a pixel, in strips or tiles; zero and
/// what is not finite is no measurement. Needs the camera in the options.
Result<Cloud> read_depth_tiff(const Input& input);

}  // namespace trivet::formats

/// Reading of geometry files in any supported format. Files are untrusted: every count is checked
/// against the size of the data before memory is allocated for it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/length_unit.hpp"
#include "storage/data/read_options.hpp"

namespace trivet {

/// Read a PLY, PCD, OBJ, STL, OFF, text (.xyz .txt .asc .csv .pts) or 16-bit depth PNG file. The
/// format follows from the extension, or from the first bytes if the extension is unknown. Text may
/// begin with a UTF-8 byte-order mark and have any kind of line ends. Each format may be compressed
/// by gzip, which is recognized from the bytes; "part.ply.gz" is a PLY file.
///
/// Points with a non-finite coordinate are dropped and counted, with the triangles that use them.
/// Polygons are split into triangles that cover them, including concave ones and those with bridged
/// holes; tristrips are split into their triangles. Values become floats. For clouds far from the
/// origin relative to their extent, an offset is subtracted first, in double (Cloud::offset).
/// Larger clouds with coordinates beyond 1e7 are refused.
/// Errors: missing_input, io, bad_data (file, line or byte, expected, found, what to do).
Result<Cloud> read_cloud(const std::filesystem::path& file, const ReadOptions& options = {});

/// As above, for bytes in memory. `name` stands for the file in messages; its extension selects the
/// format.
Result<Cloud> read_cloud(std::span<const std::byte> bytes, const std::filesystem::path& name,
                         const ReadOptions& options = {});

/// Supported extensions without dots, except those of STEP, which is read from files only.
std::span<const std::string_view> cloud_extensions();

/// The extension of the format that these bytes begin with; empty if unrecognized, as for text.
std::string_view format_by_content(std::span<const std::byte> bytes);

/// Whether the extension, before .gz if present, belongs to a format that may hold a cloud or mesh
/// (case-insensitive). .txt and .csv are excluded, as such files in a folder are mostly notes and
/// tables.
bool is_cloud_file(const std::filesystem::path& file);

/// Whether the extension belongs to a format that may hold a depth image.
bool is_depth_file(const std::filesystem::path& file);

/// The name of the file without folder, .gz and extension.
std::string cloud_name(const std::filesystem::path& file);

/// Points, with their normals and triangles if present, as a binary little-endian PLY file in the
/// frame of the cloud's file: with an offset, coordinates are doubles.
std::string encode_ply(const Cloud& cloud);

/// Write encode_ply to a file, which appears whole or not at all. Errors: cannot_create, io.
Result<void> write_ply(const std::filesystem::path& file, const Cloud& cloud);

/// Write binary glTF (.glb), whose unit is the meter. A node scales lengths of `unit`, so that
/// coordinates are read back to the same bits. Axes are unchanged, although glTF defines y as up.
/// Source: glTF 2.0 specification. Errors: usage (larger than 2 GiB), cannot_create, io.
Result<void> write_glb(const std::filesystem::path& file, const Cloud& cloud, LengthUnit unit);

/// Read the camera of depth images: JSON in the forms of parse_camera (formats/camera_json.hpp),
/// such as {"fx", "fy", "cx", "cy", "depth_scale"}; text with the 9 numbers of its matrix by rows
/// or the four numbers fx fy cx cy; or the entry `image_id` of a BOP scene_camera.json. BOP's
/// depth_scale gives millimeters.
/// Errors: missing_input, bad_data.
Result<Camera> read_camera(const std::filesystem::path& file, std::optional<int> image_id = {});

/// As above, for bytes in memory; `name` stands for the file in messages.
Result<Camera> read_camera(std::span<const std::byte> bytes, const std::string& name,
                           std::optional<int> image_id = {});

/// The id of an image in BOP's scene_camera.json: the number in its file name (000003.png).
std::optional<int> image_id_of(const std::filesystem::path& image);

}  // namespace trivet

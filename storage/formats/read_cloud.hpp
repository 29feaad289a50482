/// Read any file of geometry, whatever its format. Files are untrusted: every count is checked
/// against the bytes that are there before memory is taken for it.
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

/// Read a PLY, PCD, OBJ, STL, OFF, text (.xyz .txt .asc .csv .pts) or 16-bit depth PNG file, chosen
/// by its extension; where it has none that is known, by how its bytes begin. Text may begin with a
/// byte-order mark of UTF-8, and its lines end in any way. Each may be packed by gzip, which is told
/// by its bytes; "part.ply.gz" is a PLY file.
///
/// Points with a non-finite coordinate are dropped and counted; triangles that use one go with
/// them. Polygons become triangles that cover them, also concave ones and those with bridged holes;
/// tristrips become theirs. Values become floats: of clouds that lie far from the origin beside
/// their extent an offset is subtracted first, in double (Cloud::offset). Larger clouds with
/// coordinates beyond 1e7 are refused.
/// Errors: missing_input, io, bad_data (file, line or byte, expected, found, what to do).
Result<Cloud> read_cloud(const std::filesystem::path& file, const ReadOptions& options = {});

/// The same of bytes that came otherwise. `name` stands for the file in messages; its extension
/// tells the format.
Result<Cloud> read_cloud(std::span<const std::byte> bytes, const std::filesystem::path& name,
                         const ReadOptions& options = {});

/// Known extensions without their dots. Those of STEP, read from files only, are left out.
std::span<const std::string_view> cloud_extensions();

/// The one of them whose files begin as these bytes; empty where nothing tells it, as of text.
std::string_view format_by_content(std::span<const std::byte> bytes);

/// Whether the extension, before .gz if there is one, is of a format that may hold a cloud or mesh
/// (case-insensitive). .txt and .csv are excluded: such files of a folder are mostly notes and
/// tables.
bool is_cloud_file(const std::filesystem::path& file);

/// The same of formats that may hold a depth image.
bool is_depth_file(const std::filesystem::path& file);

/// What the file is called: without folder, .gz and extension.
std::string cloud_name(const std::filesystem::path& file);

/// Points, with normals and triangles where there are any, as the bytes of a binary little-endian
/// PLY file in the frame that the cloud was read in: with an offset, coordinates are doubles.
std::string encode_ply(const Cloud& cloud);

/// Write them to a file, which appears whole or not at all. Errors: cannot_create, io.
Result<void> write_ply(const std::filesystem::path& file, const Cloud& cloud);

/// The same as binary glTF (.glb), whose lengths are meters: a node scales those of `unit`, so that
/// coordinates are read back to the same bits. Axes stay as they are, though glTF calls y up.
/// Source: glTF 2.0 specification. Errors: usage (larger than 2 GiB), cannot_create, io.
Result<void> write_glb(const std::filesystem::path& file, const Cloud& cloud, LengthUnit unit);

/// Read the camera of depth images: JSON in the forms of parse_camera (formats/camera_json.hpp), as
/// {"fx", "fy", "cx", "cy", "depth_scale"}; text of the 9 numbers of its matrix by rows or of the four
/// numbers fx fy cx cy; or a BOP scene_camera.json, of which the entry `image_id` is taken. BOP's
/// depth_scale gives millimeters.
/// Errors: missing_input, bad_data.
Result<Camera> read_camera(const std::filesystem::path& file, std::optional<int> image_id = {});

/// The same of bytes that came otherwise; `name` stands for the file in messages.
Result<Camera> read_camera(std::span<const std::byte> bytes, const std::string& name,
                           std::optional<int> image_id = {});

/// The id of an image in BOP's scene_camera.json: the number that is its file's name (000003.png).
std::optional<int> image_id_of(const std::filesystem::path& image);

}  // namespace trivet

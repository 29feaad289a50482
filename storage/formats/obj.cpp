#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "storage/files/text.hpp"
#include "storage/formats/faces.hpp"
#include "storage/formats/positions.hpp"
#include "storage/formats/readers.hpp"

namespace trivet::formats {
namespace {

/// The largest index of some kind and the line that used it: vertices may follow their faces.
struct Highest {
  std::int64_t index = -1;
  std::size_t line = 0;

  void note(std::int64_t used, std::size_t at) {
    if (used > index) *this = {used, at};
  }
};

/// Keywords other than vertices, normals and faces. With names: groups and appearance. With
/// numbers: texture coordinates, points, lines, curves, and attributes of curves and surfaces.
constexpr std::string_view kNaming[] = {"g",      "o",      "usemtl",     "mtllib",
                                        "usemap", "maplib", "shadow_obj", "trace_obj"};
constexpr std::string_view kNumbers[] = {
    "vt",       "vp",       "p",      "l",   "s",    "mg",    "bevel", "lod",   "end",
    "c_interp", "d_interp", "cstype", "deg", "bmat", "step",  "curv",  "curv2", "parm",
    "trim",     "hole",     "scrv",   "sp",  "con",  "ctech", "stech", "res",   "cdc"};
constexpr std::string_view kFreeForm[] = {"surf", "bsp", "bzp", "cdp"};

bool is_among(std::string_view key, std::span<const std::string_view> keys) {
  return std::ranges::find(keys, key) != keys.end();
}

class ObjReader {
 public:
  explicit ObjReader(const Input& input) : input_(input), cursor_(input.text()) {}

  Result<Cloud> read() {
    do {
      TRIVET_TRY(read_line(cursor_.word()));
    } while (cursor_.next_line());

    if (highest_.index >= static_cast<std::int64_t>(positions_.size())) {
      return input_.refuse_line(highest_.line,
                                fmt::format("the face names vertex {}, but the file has {}",
                                            highest_.index + 1, positions_.size()));
    }
    place(std::move(positions_), input_, cloud_);
    cloud_.normals = round_to_floats(std::move(normals_));
    TRIVET_TRY(std::move(faces_).put_into(cloud_, input_));
    if (!paired_ || cloud_.normals.size() != cloud_.points.size()) cloud_.normals = {};
    return std::move(cloud_);
  }

 private:
  Error refuse(std::string_view what) const { return input_.refuse_line(cursor_.line(), what); }

  Result<void> read_line(std::string_view key) {
    continues_ = false;
    if (key.empty() || key[0] == '#') return {};
    if (key == "v") return read_vector(positions_);
    if (key == "vn") return read_vector(normals_);
    if (key == "f" || key == "fo") return read_face();
    if (is_among(key, kNaming)) return {};  // a backslash at their end is part of a path
    if (is_among(key, kNumbers)) {
      while (!word().empty()) continue;  // skip to the end of the last continuation line
      return {};
    }
    if (is_among(key, kFreeForm)) {
      return refuse(
          fmt::format("expected polygons, found the free-form surface {}; export the "
                      "surfaces as faces",
                      quote(key)));
    }
    return refuse(fmt::format("expected an element of an OBJ file, v, vn, vt, f or such, found {}",
                              quote(key)));
  }

  /// The next word; empty at the end of the line and at a comment. A backslash at the end of a line
  /// or word continues with the next line.
  std::string_view word() {
    for (;;) {
      if (std::exchange(continues_, false) && !cursor_.next_line()) return {};
      auto found = cursor_.word();
      continues_ = found.ends_with('\\');
      if (continues_) found.remove_suffix(1);
      if (!found.empty() || !continues_) return found.starts_with('#') ? std::string_view{} : found;
    }
  }

  Result<void> read_vector(Positions& points) {
    if (points.size() == input_.max_points()) return input_.refuse_count(points.size() + 1);
    Eigen::Vector3d v;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const auto found = word();
      const auto number = parse_number(found);
      if (!number)
        return refuse(fmt::format("expected three numbers, found {}", quote_word(found)));
      v[i] = *number;
    }
    // A weight or a color.
    for (auto found = word(); !found.empty(); found = word()) {
      if (!parse_number(found))
        return refuse(fmt::format("expected numbers behind a vertex, found {}", quote(found)));
    }
    points.push_back(v);
    return {};
  }

  /// Convert a 1-based or negative index to 0-based; -1 if invalid.
  static std::int64_t resolve(std::string_view text, std::size_t count) {
    const std::int64_t index = parse_integer(text).value_or(0);
    if (index > std::numeric_limits<std::int32_t>::max()) return -1;
    const auto size = static_cast<std::int64_t>(count);
    return index > 0 ? index - 1 : index < 0 && index >= -size ? size + index : -1;
  }

  /// A corner is "v", "v/vt", "v//vn" or "v/vt/vn".
  Result<void> read_face() {
    faces_.begin();
    for (auto corner = word(); !corner.empty(); corner = word()) {
      const auto slash = corner.find('/');
      const std::int64_t vertex = resolve(corner.substr(0, slash), positions_.size());
      if (vertex < 0) {
        return refuse(
            fmt::format("expected the number of a vertex, counted from 1 or back from -1, "
                        "found {} behind {} vertices",
                        quote(corner), positions_.size()));
      }
      highest_.note(vertex, cursor_.line());
      if (slash != corner.npos && corner.find('/', slash + 1) != corner.npos) {
        const auto normal = corner.substr(corner.find('/', slash + 1) + 1);
        if (resolve(normal, normals_.size()) != vertex) paired_ = false;
      }
      faces_.add(static_cast<std::uint32_t>(vertex));
    }
    if (faces_.num_corners() < 3) {
      return refuse(
          fmt::format("expected a face of three or more corners, found {}; points and "
                      "lines are elements \"p\" and \"l\"",
                      faces_.num_corners()));
    }
    return {};
  }

  const Input& input_;
  TextCursor cursor_;
  Positions positions_, normals_;
  Cloud cloud_;
  Faces faces_;
  bool continues_ = false;  // the line continues on the next one
  Highest highest_;
  bool paired_ = true;  // every corner's normal has the index of its vertex
};

}  // namespace

Result<Cloud> read_obj(const Input& input) { return ObjReader(input).read(); }

}  // namespace trivet::formats

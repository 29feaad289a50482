#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "storage/common/stop.hpp"
#include "storage/files/text.hpp"
#include "storage/formats/faces.hpp"
#include "storage/formats/intensity.hpp"
#include "storage/formats/ply_header.hpp"
#include "storage/formats/positions.hpp"
#include "storage/formats/readers.hpp"

namespace trivet::formats {
namespace {

/// The values after the header, in any encoding. In text, each row of an element is a line.
class PlyBody {
 public:
  PlyBody(const Input& input, const PlyHeader& header)
      : input_(input),
        bytes_(input.bytes.subspan(header.body_begin)),
        text_(input.text().substr(header.body_begin)),
        order_(header.encoding == PlyEncoding::big_endian ? std::endian::big : std::endian::little),
        ascii_(header.encoding == PlyEncoding::ascii),
        first_byte_(header.body_begin),
        first_line_(header.body_line) {}

  void begin_row() {
    check_stop_();
    row_begins_ = true;
  }
  /// In text: an error if the line continues.
  Result<void> end_row(const PlyElement& element, std::uint64_t row) {
    const auto word = ascii_ ? text_.word() : std::string_view{};
    if (word.empty()) return {};
    fault_ = quote(word);
    return fault(element, row, "the end of the line behind the values that the header names");
  }
  /// In text: an error if more follows than the header announces.
  Result<void> end() {
    const auto word = ascii_ ? text_.next_word() : std::string_view{};
    if (word.empty()) return {};
    return refuse(
        fmt::format("expected the end of the file behind the rows that the header "
                    "announces, found {}",
                    quote(word)));
  }

  /// False at the end of the file or without a number; fault() then describes it.
  bool read(Scalar type, double& value) {
    if (ascii_) {
      const auto word = row_begins_ ? text_.next_word() : text_.word();
      row_begins_ = false;
      const auto number = parse_number(word);
      if (!number)
        fault_ = text_.remaining() == 0 && word.empty() ? "the end of the file" : quote_word(word);
      value = number.value_or(0);
      return number.has_value();
    }
    const std::size_t size = size_of(type);
    if (bytes_.size() - at_ < size) {
      fault_ = "the end of the file";
      return false;
    }
    value = load(bytes_.data() + at_, type, order_);
    at_ += size;
    return true;
  }

  /// Whether `count` rows of an element fit: a value takes a byte and a blank in text, or its size.
  bool can_hold(const PlyElement& element) const noexcept {
    std::uint64_t row_bytes = 0;
    for (const auto& property : element.properties) {
      row_bytes += ascii_ ? 2 : size_of(property.count_type.value_or(property.type));
    }
    return row_bytes == 0 || element.count <= (remaining() + 1) / row_bytes;
  }
  bool can_hold(double count, Scalar type) const noexcept {
    return count * static_cast<double>(ascii_ ? 1 : size_of(type)) <=
           static_cast<double>(remaining());
  }

  Error fault(const PlyElement& element, std::uint64_t row, std::string_view expected) const {
    return refuse(fmt::format("{} {} of {}: expected {}, found {}", quote(element.name), row,
                              element.count, expected, fault_));
  }
  Error refuse(std::string_view what) const {
    return ascii_ ? input_.refuse_line(first_line_ + text_.line() - 1, what)
                  : input_.refuse_byte(first_byte_ + at_, what);
  }

 private:
  std::uint64_t remaining() const noexcept {
    return ascii_ ? text_.remaining() : bytes_.size() - at_;
  }

  const Input& input_;
  std::span<const std::byte> bytes_;
  TextCursor text_;
  std::endian order_;
  StopCheck check_stop_{1 << 14};  // rows
  bool ascii_, row_begins_ = true;
  std::size_t first_byte_, first_line_;
  std::size_t at_ = 0;
  std::string fault_;
};

/// The length of a list; an error if the file cannot hold it.
Result<std::uint64_t> read_count(PlyBody& body, const PlyElement& element, std::uint64_t row,
                                 const PlyProperty& list) {
  double count = 0;
  if (!body.read(*list.count_type, count)) return body.fault(element, row, "the length of a list");
  if (!to_index(count, 1ULL << 32) || !body.can_hold(count, list.type)) {
    return body.refuse(fmt::format("{} {}: a list of {} values is longer than the file",
                                   quote(element.name), row, count));
  }
  return static_cast<std::uint64_t>(count);
}

Result<void> skip_property(PlyBody& body, const PlyElement& element, std::uint64_t row,
                           const PlyProperty& property) {
  std::uint64_t count = 1;
  if (property.count_type) {
    TRIVET_TRY_ASSIGN(const auto length, read_count(body, element, row, property));
    count = length;
  }
  for (double ignored = 0; count > 0; --count) {
    if (!body.read(property.type, ignored)) return body.fault(element, row, "a number");
  }
  return {};
}

/// Read the rows of an element; columns[p], if not null, receives the scalar property p.
Result<void> read_scalars(PlyBody& body, const PlyElement& element,
                          std::span<double* const> columns) {
  if (element.properties.empty()) return {};  // any number of rows without a byte
  for (std::uint64_t row = 0; row < element.count; ++row) {
    body.begin_row();
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      if (!columns[p]) {
        TRIVET_TRY(skip_property(body, element, row, element.properties[p]));
        continue;
      }
      double value = 0;
      if (!body.read(element.properties[p].type, value))
        return body.fault(element, row, "a number");
      columns[p][row] = value;
    }
    TRIVET_TRY(body.end_row(element, row));
  }
  return {};
}

/// Read the rows of an element with one list of vertex indices: begin(row, count), then
/// store(value) for each, which returns whether the value is valid.
template <class Begin, class Store>
Result<void> read_index_lists(PlyBody& body, const PlyElement& element, std::size_t list,
                              Begin&& begin, Store&& store) {
  for (std::uint64_t row = 0; row < element.count; ++row) {
    body.begin_row();
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (p != list) {
        TRIVET_TRY(skip_property(body, element, row, property));
        continue;
      }
      TRIVET_TRY_ASSIGN(const auto count, read_count(body, element, row, property));
      if (!begin(row, count)) {
        return body.refuse(fmt::format("{} {}: a list of {} vertices is too long",
                                       quote(element.name), row, count));
      }
      for (std::uint64_t i = 0; i < count; ++i) {
        double value = 0;
        if (!body.read(property.type, value)) return body.fault(element, row, "a vertex index");
        if (!store(value)) {
          return body.refuse(fmt::format("{} {} names vertex {}, which the file does not have",
                                         quote(element.name), row, value));
        }
      }
    }
    TRIVET_TRY(body.end_row(element, row));
  }
  return {};
}

/// Read polygons.
Result<void> read_faces(PlyBody& body, const PlyElement& element, std::size_t list,
                        std::size_t num_vertices, Faces& faces) {
  return read_index_lists(
      body, element, list,
      [&](std::uint64_t, std::uint64_t) {
        faces.begin();
        return true;
      },
      [&](double value) {
        const auto index = to_index(value, num_vertices);
        if (index) faces.add(*index);
        return index.has_value();
      });
}

/// Read strips: each vertex forms a triangle with the two before it, every second one reversed; -1
/// begins a new strip. Triangles with a repeated vertex only join strips and are dropped.
Result<void> read_strips(PlyBody& body, const PlyElement& element, std::size_t list, Cloud& cloud) {
  std::uint32_t older = 0, newer = 0;
  std::uint64_t num_corners = 0;
  return read_index_lists(
      body, element, list,
      [&](std::uint64_t, std::uint64_t) {
        num_corners = 0;
        return true;
      },
      [&](double value) {
        if (value == -1) {
          num_corners = 0;
          return true;
        }
        const auto index = to_index(value, cloud.points.size());
        if (!index) return false;
        const bool proper = older != newer && newer != *index && *index != older;
        if (num_corners >= 2 && proper) {
          if (num_corners % 2 == 0) cloud.triangles.push_back(older, newer, *index);
          if (num_corners % 2 == 1) cloud.triangles.push_back(newer, older, *index);
        }
        older = newer;
        newer = *index;
        ++num_corners;
        return true;
      });
}

/// Read Stanford's range grid: for each pixel a list of no or one vertex.
Result<void> read_range_grid(PlyBody& body, const PlyElement& element, std::size_t list,
                             const PlyHeader& header, Cloud& cloud) {
  if (header.num_rows > element.count || header.num_cols > element.count ||
      header.num_cols * header.num_rows != element.count) {
    return body.refuse(
        fmt::format("a range_grid of {} pixels needs obj_info num_cols and num_rows "
                    "with that product, found {} and {}",
                    element.count, header.num_cols, header.num_rows));
  }
  PixelGrid grid{static_cast<std::uint32_t>(header.num_cols),
                 static_cast<std::uint32_t>(header.num_rows),
                 Column<std::int32_t>(element.count, PixelGrid::kNone)};
  std::uint64_t pixel = 0;
  auto done = read_index_lists(
      body, element, list,
      [&](std::uint64_t row, std::uint64_t count) {
        pixel = row;
        return count <= 1;
      },
      [&](double value) {
        const auto index = to_index(value, cloud.points.size());
        if (index) grid.point_index[pixel] = static_cast<std::int32_t>(*index);
        return index.has_value();
      });
  if (done && grid.width > 1 && grid.height > 1) cloud.grid = std::move(grid);
  return done;
}

/// The scalar properties with three names; empty unless all are present.
std::optional<std::array<std::size_t, 3>> find_three(const PlyElement& element,
                                                     const std::array<std::string_view, 3>& names) {
  std::array<std::size_t, 3> found{};
  for (std::size_t n = 0; n < 3; ++n) {
    const auto at = std::find_if(element.properties.begin(), element.properties.end(),
                                 [&](const PlyProperty& property) {
                                   return !property.count_type && property.name == names[n];
                                 });
    if (at == element.properties.end()) return {};
    found[n] = static_cast<std::size_t>(at - element.properties.begin());
  }
  return found;
}

std::optional<std::size_t> find_intensity(const PlyElement& element) {
  for (std::size_t p = 0; p < element.properties.size(); ++p) {
    const PlyProperty& property = element.properties[p];
    if (!property.count_type && names_intensity(property.name)) return p;
  }
  return {};
}

/// Assign three columns, resized to the element, as destinations of three properties.
void send(const std::array<std::size_t, 3>& properties, const PlyElement& element,
          Positions& positions, std::vector<double*>& columns) {
  positions.resize(element.count);
  columns[properties[0]] = positions.x.data();
  columns[properties[1]] = positions.y.data();
  columns[properties[2]] = positions.z.data();
}

Result<void> read_vertices(PlyBody& body, const PlyElement& element, const Input& input,
                           Cloud& cloud) {
  const auto position = find_three(element, {"x", "y", "z"});
  if (!position) {
    return input.refuse(
        "expected the properties x, y and z in the element vertex, found no such three");
  }
  std::vector<double*> columns(element.properties.size(), nullptr);
  Positions positions, normals;
  send(*position, element, positions, columns);
  const auto normal = find_three(element, {"nx", "ny", "nz"});
  if (normal) send(*normal, element, normals, columns);
  Positions colors;
  Column<double> intensity;
  const auto bright = input.options.intensity ? find_intensity(element) : std::nullopt;
  if (bright) {
    intensity.resize(element.count);
    columns[*bright] = intensity.data();
  } else if (const auto color = find_three(element, kColorNames);
             color && input.options.intensity) {
    send(*color, element, colors, columns);
  }
  TRIVET_TRY(read_scalars(body, element, columns));
  place(std::move(positions), input, cloud);
  if (normal) cloud.normals = round_to_floats(std::move(normals));
  cloud.intensity = bright ? to_floats(intensity) : brightness(colors);
  return {};
}

/// Read PCL's camera element: the position of the sensor; all zero means unknown.
Result<void> read_viewpoint(PlyBody& body, const PlyElement& element,
                            std::optional<Eigen::Vector3d>& viewpoint) {
  Positions found;
  std::vector<double*> columns(element.properties.size(), nullptr);
  const auto position = find_three(element, {"view_px", "view_py", "view_pz"});
  if (position) send(*position, element, found, columns);
  auto done = read_scalars(body, element, columns);
  if (!done || !position) return done;
  const Eigen::Vector3d place(found.x[0], found.y[0], found.z[0]);
  if (place.allFinite() && !place.isZero(0)) viewpoint = place;
  return done;
}

/// The list of vertex indices, under any of its usual names.
std::optional<std::size_t> index_list_of(const PlyElement& element) {
  constexpr std::array<std::string_view, 4> kNames{"vertex_indices", "vertex_index",
                                                   "vertex_indexes", "vertices"};
  for (std::size_t p = 0; p < element.properties.size(); ++p) {
    const PlyProperty& property = element.properties[p];
    const bool named = std::find(kNames.begin(), kNames.end(), property.name) != kNames.end();
    if (property.count_type && named) return p;
  }
  return {};
}

/// The names of its properties, for a message.
std::string names_of(const PlyElement& element) {
  std::string names;
  for (const PlyProperty& property : element.properties) {
    names += fmt::format("{}{}{}", names.empty() ? "" : ", ", property.count_type ? "list " : "",
                         quote(property.name));
  }
  return names.empty() ? "no property" : names;
}

/// Use of an element other than the vertices: triangles, a grid, the sensor or none.
enum class Role { other, camera, face, tristrips, range_grid };

Role role_of(const PlyElement& element) {
  if (element.count == 0) return Role::other;
  if (element.name == "camera" && element.count == 1) return Role::camera;
  if (element.name == "face") return Role::face;
  if (element.name == "tristrips") return Role::tristrips;
  if (element.name == "range_grid") return Role::range_grid;
  return Role::other;
}

Result<void> check_room(const PlyBody& body, const PlyElement& element) {
  if (body.can_hold(element)) return {};
  return body.refuse(
      fmt::format("expected {} rows of element {}, which do not fit into the rest "
                  "of the file; it is truncated or its header is wrong",
                  element.count, quote(element.name)));
}

/// Contents of a file's elements.
struct PlyContent {
  Cloud cloud;
  Faces faces;
  std::optional<Eigen::Vector3d> viewpoint;
};

Result<void> read_element(PlyBody& body, const PlyElement& element, const PlyHeader& header,
                          const Input& input, PlyContent& out) {
  Cloud& cloud = out.cloud;
  TRIVET_TRY(check_room(body, element));
  if (element.name == "vertex") return read_vertices(body, element, input, cloud);
  const Role role = role_of(element);
  if (role == Role::camera) return read_viewpoint(body, element, out.viewpoint);
  if (role == Role::other) {
    return read_scalars(body, element, std::vector<double*>(element.properties.size(), nullptr));
  }
  const auto list = index_list_of(element);
  if (!list) {
    return input.refuse(fmt::format("expected a list vertex_indices in the element {}, found {}",
                                    quote(element.name), names_of(element)));
  }
  if (role == Role::face) return read_faces(body, element, *list, cloud.points.size(), out.faces);
  if (role == Role::tristrips) return read_strips(body, element, *list, cloud);
  return read_range_grid(body, element, *list, header, cloud);
}

}  // namespace

Result<Cloud> read_ply(const Input& input) {
  TRIVET_TRY_ASSIGN(const auto header, parse_ply_header(input));
  const PlyElement* const vertex = header.find("vertex");
  if (!vertex) return input.refuse("expected an element vertex, found none");

  PlyContent content;
  Cloud& cloud = content.cloud;
  PlyBody body(input, header);
  // Faces may precede their vertices.
  TRIVET_TRY(check_room(body, *vertex));
  if (vertex->count > input.max_points()) return input.refuse_count(vertex->count);
  cloud.points.resize(vertex->count);
  for (const PlyElement& element : header.elements) {
    TRIVET_TRY(read_element(body, element, header, input, content));
  }
  TRIVET_TRY(body.end());
  if (content.viewpoint) place_viewpoint(*content.viewpoint, cloud);
  TRIVET_TRY(std::move(content.faces).put_into(cloud, input));
  return std::move(content.cloud);
}

}  // namespace trivet::formats

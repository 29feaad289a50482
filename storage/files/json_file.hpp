/// JSON files, read within bounds; faults name the path of the value in the document.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/file_pose.hpp"
#include "storage/data/model.hpp"

namespace trivet {

/// Thrown while a document is walked over; with_json turns it into a bad_data error.
struct JsonFault {
  std::string message;
};

/// A value of the document that knows its path. Every member throws JsonFault when it cannot hold.
class JsonNode {
 public:
  JsonNode(const nlohmann::json& value, std::string path)
      : value_(&value), path_(std::move(path)) {}

  const JsonNode& object() const;  ///< itself, if it is an object
  /// Itself, if it is an object of such members alone: refuse a name that nobody reads, and tell the
  /// nearest. Names that begin with '_' are notes.
  const JsonNode& only(std::initializer_list<std::string_view> known) const;
  /// Itself, if it is an object without a misspelled member: refuse a name that is nearly one of these.
  /// All others are notes.
  const JsonNode& without_misspelled(std::initializer_list<std::string_view> known) const;
  /// Whether the member is there and not null.
  bool has(std::string_view key) const;
  JsonNode at(std::string_view key) const;
  std::vector<JsonNode> elements() const;                         ///< of an array
  std::vector<std::pair<std::string, JsonNode>> members() const;  ///< of an object, sorted by key

  bool is_array() const { return value_->is_array(); }
  bool is_string() const { return value_->is_string(); }
  bool is_boolean() const { return value_->is_boolean(); }
  const nlohmann::json& value() const { return *value_; }
  double number() const;                 ///< finite
  int integer(int low, int high) const;  ///< within these bounds, both included
  bool boolean() const;
  std::string string() const;
  /// Of an array of numbers, or of rows of them; needs little memory beside them.
  std::vector<double> flat_numbers() const;
  double coordinate() const;        ///< a number of at most kMaxCoordinate
  Eigen::Vector3d vector3() const;  ///< three coordinates
  /// A rigid motion as four rows of four numbers, or 16 numbers row by row. A rotation within 1e-2
  /// is replaced by the nearest true one.
  Pose pose() const;
  /// The same with the translation as it stands there; the rotation is rounded to floats.
  FilePose file_pose() const;
  Eigen::Matrix3f rotation() const;  ///< 9 numbers row by row; else as for a pose
  /// {"axis": three coordinates, "offset": three, 0 if absent}: a line that the object turns about.
  Symmetry::Axis symmetry_axis() const;
  std::vector<Pose> symmetry_poses() const;  ///< an array of poses, without the identity

  /// "PATH: what, found ...": the value itself, unless `found` says what.
  [[noreturn]] void refuse(std::string_view what) const;
  [[noreturn]] void refuse(std::string_view what, std::string_view found) const;

 private:
  std::string_view place() const;  ///< its path, or "the document"
  /// "a", "b": to be told beside the name that is not among them.
  std::string names_of_members() const;

  const nlohmann::json* value_;
  std::string path_;
};

/// Called for each key with the number of objects and arrays around it, in the order of the file.
using OnJsonKey = std::function<void(int depth, const std::string& key)>;

/// Parse a file of at most 256 MB and 32 levels and walk over it.
/// Errors: missing_input, io, bad_data (names the byte or the path of the fault).
Result<void> with_json(const std::filesystem::path& file,
                       const std::function<void(const JsonNode& root)>& walk,
                       const OnJsonKey& on_key = {});

/// The same of bytes that came otherwise; `name` stands for the file in messages.
Result<void> with_json(std::span<const std::byte> bytes, const std::string& name,
                       const std::function<void(const JsonNode& root)>& walk,
                       const OnJsonKey& on_key = {});

}  // namespace trivet

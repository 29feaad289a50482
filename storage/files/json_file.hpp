/// JSON files, read within bounds; errors name the path of the value in the document.
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

/// Thrown while a document is traversed; with_json turns it into a bad_data error.
struct JsonFault {
  std::string message;
};

/// A value of the document with its path. Every member throws JsonFault on a mismatch.
class JsonNode {
 public:
  JsonNode(const nlohmann::json& value, std::string path)
      : value_(&value), path_(std::move(path)) {}

  const JsonNode& object() const;  ///< this value, if it is an object
  /// This value, if it is an object with only these members. An unknown name is refused with the
  /// nearest known one. Names that begin with '_' are notes.
  const JsonNode& only(std::initializer_list<std::string_view> known) const;
  /// This value, if it is an object without a misspelled member. A name that is nearly one of these
  /// is refused; all others are notes.
  const JsonNode& without_misspelled(std::initializer_list<std::string_view> known) const;
  /// Whether the member exists and is not null.
  bool has(std::string_view key) const;
  JsonNode at(std::string_view key) const;
  std::vector<JsonNode> elements() const;                         ///< elements of an array
  std::vector<std::pair<std::string, JsonNode>> members() const;  ///< members of an object, sorted
                                                                  ///< by key

  bool is_array() const { return value_->is_array(); }
  bool is_string() const { return value_->is_string(); }
  bool is_boolean() const { return value_->is_boolean(); }
  const nlohmann::json& value() const { return *value_; }
  double number() const;                 ///< a finite number
  int integer(int low, int high) const;  ///< an integer in [low, high]
  bool boolean() const;
  std::string string() const;
  /// Numbers of an array, or of an array of rows; needs little memory beside them.
  std::vector<double> flat_numbers() const;
  double coordinate() const;        ///< a number of at most kMaxCoordinate
  Eigen::Vector3d vector3() const;  ///< three coordinates
  /// A rigid transform as four rows of four numbers, or 16 numbers row by row. A rotation within
  /// 1e-2 is replaced by the nearest proper one.
  Pose pose() const;
  /// As pose(), with the translation unrounded; the rotation is rounded to floats.
  FilePose file_pose() const;
  Eigen::Matrix3f rotation() const;  ///< 9 numbers row by row; otherwise as in a pose
  /// An axis of rotational symmetry: {"axis": three coordinates, "offset": three, 0 if absent}.
  Symmetry::Axis symmetry_axis() const;
  std::vector<Pose> symmetry_poses() const;  ///< an array of poses, without the identity

  /// Throw "PATH: what, found ..."; the found value is this one unless `found` names another.
  [[noreturn]] void refuse(std::string_view what) const;
  [[noreturn]] void refuse(std::string_view what, std::string_view found) const;

 private:
  std::string_view place() const;  ///< the path, or "the document"
  /// "a", "b": the member names, listed in the error for an unknown name.
  std::string names_of_members() const;

  const nlohmann::json* value_;
  std::string path_;
};

/// Called for each key in file order, with the number of enclosing objects and arrays.
using OnJsonKey = std::function<void(int depth, const std::string& key)>;

/// Parse a file of at most 256 MB and 32 levels and pass its root to a function.
/// Errors: missing_input, io, bad_data (names the byte or the path of the fault).
Result<void> with_json(const std::filesystem::path& file,
                       const std::function<void(const JsonNode& root)>& walk,
                       const OnJsonKey& on_key = {});

/// As above, for bytes in memory; `name` stands for the file in messages.
Result<void> with_json(std::span<const std::byte> bytes, const std::string& name,
                       const std::function<void(const JsonNode& root)>& walk,
                       const OnJsonKey& on_key = {});

}  // namespace trivet

#include "storage/files/json_file.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <new>

#include "storage/files/file.hpp"
#include "storage/files/guess_content.hpp"
#include "storage/files/input.hpp"
#include "storage/files/json_text.hpp"
#include "storage/files/nearest_name.hpp"
#include "storage/files/numbers.hpp"
#include "storage/files/text.hpp"

namespace trivet {
namespace {

constexpr std::uint64_t kMaxBytes = 256ULL << 20;
constexpr int kMaxDepth = 32;

using Matrix3d = Eigen::Matrix3d;
using Matrix4d = Eigen::Matrix4d;

/// The rotation nearest to m in the Frobenius norm (orthogonal Procrustes problem, by SVD).
Matrix3d nearest_rotation(const Matrix3d& m) {
  const Eigen::JacobiSVD<Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs(1, 1,
                        (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

/// Free a document's memory from the leaves to the root. nlohmann's destructor collects the
/// contents in a separate array, and the process ends if there is no memory for it.
void release(nlohmann::json& value) noexcept {
  if (value.is_array()) {
    auto& elements = value.get_ref<nlohmann::json::array_t&>();
    for (nlohmann::json& element : elements) release(element);
    elements.clear();
  } else if (value.is_object()) {
    auto& members = value.get_ref<nlohmann::json::object_t&>();
    for (auto& [key, member] : members) release(member);
    members.clear();
  }
}

/// A parsed document that is freed by release().
struct ParsedJson {
  explicit ParsedJson(nlohmann::json parsed) noexcept : document(std::move(parsed)) {}
  ~ParsedJson() { release(document); }
  ParsedJson(const ParsedJson&) = delete;
  ParsedJson& operator=(const ParsedJson&) = delete;
  nlohmann::json document;
};

}  // namespace

void JsonNode::refuse(std::string_view what) const {
  const std::string found = value_->is_object()  ? "an object"
                            : value_->is_array() ? fmt::format("an array of {}", value_->size())
                            : value_->is_string()
                                ? formats::quote(value_->get_ref<const std::string&>())
                                : formats::quote(json_text(*value_));
  refuse(what, found);
}

void JsonNode::refuse(std::string_view what, std::string_view found) const {
  throw JsonFault{fmt::format("{}: {}, found {}", place(), what, found)};
}

std::string_view JsonNode::place() const {
  return path_.empty() ? std::string_view("the document") : path_;
}

const JsonNode& JsonNode::object() const {
  if (!value_->is_object()) refuse("expected an object");
  return *this;
}

const JsonNode& JsonNode::only(std::initializer_list<std::string_view> known) const {
  for (const auto& [key, value] : object().value_->items()) {
    if (!key.starts_with('_') && std::ranges::find(known, key) == known.end())
      throw JsonFault{fmt::format("{}: {}", place(), unknown_name(key, known))};
  }
  return *this;
}

const JsonNode& JsonNode::without_misspelled(std::initializer_list<std::string_view> known) const {
  for (const auto& [key, value] : object().value_->items()) {
    const bool is_known = std::ranges::find(known, key) != known.end();
    if (!is_known && !nearest_name(key, known).empty())
      throw JsonFault{fmt::format("{}: {}", place(), unknown_name(key, known))};
  }
  return *this;
}

bool JsonNode::has(std::string_view key) const {
  const auto found = object().value_->find(key);
  return found != value_->end() && !found->is_null();
}

JsonNode JsonNode::at(std::string_view key) const {
  if (!has(key)) refuse(fmt::format("expected \"{}\"", key), names_of_members());
  return {*value_->find(key), fmt::format("{}{}{}", path_, path_.empty() ? "" : ".", key)};
}

std::string JsonNode::names_of_members() const {
  constexpr std::size_t kMost = 8;
  std::string names;
  std::size_t count = 0;
  for (const auto& [key, value] : object().value_->items()) {
    if (++count > kMost) return names + ", ...";
    names += fmt::format("{}{}", names.empty() ? "" : ", ", formats::quote(key));
  }
  return names.empty() ? "an empty object" : names;
}

std::vector<JsonNode> JsonNode::elements() const {
  if (!value_->is_array()) refuse("expected an array");
  std::vector<JsonNode> nodes;
  nodes.reserve(value_->size());
  for (std::size_t i = 0; i < value_->size(); ++i) {
    nodes.emplace_back((*value_)[i], fmt::format("{}[{}]", path_, i));
  }
  return nodes;
}

std::vector<std::pair<std::string, JsonNode>> JsonNode::members() const {
  std::vector<std::pair<std::string, JsonNode>> nodes;
  for (const auto& [key, value] : object().value_->items()) {
    nodes.emplace_back(key, JsonNode(value, fmt::format("{}[{}]", path_, formats::quote(key))));
  }
  return nodes;
}

double JsonNode::number() const {
  if (!value_->is_number() || !std::isfinite(value_->get<double>())) refuse("expected a number");
  return value_->get<double>();
}

int JsonNode::integer(int low, int high) const {
  const double value = number();
  if (!(value >= low && value <= high) || value != std::floor(value))
    refuse(fmt::format("expected a whole number from {} to {}", low, high));
  return static_cast<int>(value);
}

std::vector<double> JsonNode::flat_numbers() const {
  if (!value_->is_array()) refuse("expected an array");
  std::vector<double> numbers;
  const auto append_number = [&](const nlohmann::json& value, const auto&... indices) {
    if (value.is_number() && std::isfinite(value.get<double>())) {
      numbers.push_back(value.get<double>());
    } else {
      std::string path = path_;
      ((path += fmt::format("[{}]", indices)), ...);
      JsonNode(value, path).refuse("expected a number");
    }
  };
  for (std::size_t i = 0; i < value_->size(); ++i) {
    const nlohmann::json& element = (*value_)[i];
    if (!element.is_array()) append_number(element, i);
    for (std::size_t j = 0; element.is_array() && j < element.size(); ++j)
      append_number(element[j], i, j);
  }
  return numbers;
}

double JsonNode::coordinate() const {
  if (!(std::abs(number()) <= kMaxCoordinate)) refuse("expected a number of at most 1e10");
  return number();
}

bool JsonNode::boolean() const {
  if (!value_->is_boolean()) refuse("expected true or false");
  return value_->get<bool>();
}

std::string JsonNode::string() const {
  if (!value_->is_string()) refuse("expected a string");
  return value_->get<std::string>();
}

Eigen::Vector3d JsonNode::vector3() const {
  const auto numbers = elements();
  if (numbers.size() != 3) refuse(fmt::format("expected 3 numbers instead of {}", numbers.size()));
  return {numbers[0].coordinate(), numbers[1].coordinate(), numbers[2].coordinate()};
}

namespace {

Eigen::Matrix3f true_rotation(const JsonNode& node, const Matrix3d& linear) {
  const Matrix3d rotation = nearest_rotation(linear);
  if (!((linear - rotation).cwiseAbs().maxCoeff() <= 1e-2))
    node.refuse("expected a rotation within 0.01 in the upper left 3 x 3 numbers");
  return rotation.cast<float>();
}

}  // namespace

Eigen::Matrix3f JsonNode::rotation() const {
  const auto numbers = elements();
  if (numbers.size() != 9)
    refuse(fmt::format("expected 3 x 3 numbers instead of {}", numbers.size()));
  Matrix3d linear;
  for (int i = 0; i < 9; ++i)
    linear(i / 3, i % 3) = numbers[static_cast<std::size_t>(i)].coordinate();
  return true_rotation(*this, linear);
}

Pose JsonNode::pose() const { return file_pose().cast<float>(); }

FilePose JsonNode::file_pose() const {
  const std::vector<double> numbers = flat_numbers();
  if (numbers.size() != 16)
    refuse(fmt::format("expected 4 x 4 numbers instead of {}", numbers.size()));
  for (const double number : numbers) {
    if (!(std::abs(number) <= kMaxCoordinate)) refuse("expected numbers of at most 1e10");
  }

  const Matrix4d matrix =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
  const Eigen::Matrix3f rotation = true_rotation(*this, matrix.topLeftCorner<3, 3>());
  if (!matrix.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1), 1e-6)) {
    refuse("expected 0 0 0 1 in the last row");
  }
  FilePose pose = FilePose::Identity();
  pose.linear() = rotation.cast<double>();
  pose.translation() = matrix.topRightCorner<3, 1>();
  return pose;
}

Symmetry::Axis JsonNode::symmetry_axis() const {
  const Eigen::Vector3d direction = at("axis").vector3();
  if (!(direction.norm() > 1e-6)) at("axis").refuse("expected a direction of some length");
  Symmetry::Axis axis;
  axis.direction = direction.normalized().cast<float>();
  if (has("offset")) axis.point = at("offset").vector3().cast<float>();
  return axis;
}

std::vector<Pose> JsonNode::symmetry_poses() const {
  std::vector<Pose> poses;
  for (const JsonNode& element : elements()) {
    const Pose pose = element.pose();
    if (!pose.matrix().isIdentity(1e-6F)) poses.push_back(pose);
  }
  return poses;
}

Result<void> with_json(const std::filesystem::path& file,
                       const std::function<void(const JsonNode& root)>& walk,
                       const OnJsonKey& on_key) {
  TRIVET_TRY_ASSIGN(const auto bytes, read_file(file, kMaxBytes));
  return with_json(bytes, file.string(), walk, on_key);
}

Result<void> with_json(std::span<const std::byte> bytes, const std::string& name,
                       const std::function<void(const JsonNode& root)>& walk,
                       const OnJsonKey& on_key) {
  const auto refuse = [&](std::string_view what) {
    return Error{ErrorCode::bad_data, fmt::format("{}: {}", name, what)};
  };

  using Event = nlohmann::json::parse_event_t;
  const auto on_event = [&](int depth, Event event, nlohmann::json& value) {
    if (depth > kMaxDepth) throw JsonFault{fmt::format("nests deeper than {} levels", kMaxDepth)};
    if (event == Event::key && on_key) on_key(depth, value.get_ref<const std::string&>());
    return true;
  };
  try {
    const auto* const first = reinterpret_cast<const char*>(bytes.data());
    const ParsedJson parsed([&] {
      const PlainLocale plain;
      return nlohmann::json::parse(first, first + bytes.size(), on_event);
    }());
    walk(JsonNode(parsed.document, ""));
    return {};
  } catch (const JsonFault& fault) {
    return refuse(fault.message);
  } catch (const nlohmann::json::parse_error& fault) {
    if (const formats::ContentGuess found = formats::guess_content(bytes);
        found && found.extension != ".json")
      return refuse(fmt::format("expected JSON, found {}", found.what));
    return refuse(
        fmt::format("no JSON from byte {} on; the file is damaged or something else", fault.byte));
  } catch (const nlohmann::json::exception& fault) {
    return refuse(formats::quote(fault.what()));
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::no_memory, fmt::format("{}: {}", name, kOutOfMemory)};
  }
}

}  // namespace trivet

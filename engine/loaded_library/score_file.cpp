#include "engine/loaded_library/score_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>

#include "engine/loaded_library/score_json.hpp"
#include "storage/files/json_text.hpp"

namespace trivet {
namespace {

using kernels::ScoreModel;

constexpr std::string_view kScoreFormat = "trivet score";
constexpr int kScoreVersion = 1;
constexpr double kLargest = 1e6;
// Errors of neighboring pixels.
constexpr std::array<const char*, 2> kErrors{"independent", "shared"};

template <std::size_t N>
std::array<float, N> read_row(const JsonNode& node, double low) {
  const std::vector<JsonNode> elements = node.elements();
  if (elements.size() != N)
    node.refuse(fmt::format("expected {} numbers instead of {}", N, elements.size()));
  std::array<float, N> row;
  for (std::size_t i = 0; i < N; ++i) row[i] = engine::number_within(elements[i], low, kLargest);
  return row;
}

template <std::size_t N>
std::string row_text(std::string_view name, const std::array<float, N>& row) {
  return fmt::format("      \"{}\": [{:.5g}]", name, fmt::join(row, ", "));
}

}  // namespace

std::string score_text(const FittedScore& score) {
  const ScoreModel& model = score.model;
  std::string parts;
  for (std::size_t part = 0; part < kernels::kNumScoreParts; ++part) {
    parts += fmt::format("{}\n    \"{}\": {{\n{},\n{},\n{}\n    }}", part > 0 ? "," : "",
                         kernels::kScoreParts[part].name, row_text("knots", model.knots[part]),
                         row_text(kErrors[0], model.weights[0][part]),
                         row_text(kErrors[1], model.weights[1][part]));
  }
  return fmt::format(
      "{{\n  \"format\": \"{}\",\n  \"version\": {},\n  \"origin\": {},\n"
      "  \"bias\": {{\"{}\": {:.5g}, \"{}\": {:.5g}}},\n  \"parts\": {{{}\n  }}\n}}\n",
      kScoreFormat, kScoreVersion, json_text(nlohmann::json(score.origin)), kErrors[0],
      model.bias[0], kErrors[1], model.bias[1], parts);
}

Result<FittedScore> parse_score(std::span<const std::byte> bytes, const std::string& name) {
  FittedScore score;
  ScoreModel& model = score.model;
  TRIVET_TRY(with_json(bytes, name, [&](const JsonNode& root) {
    engine::check_format(root, kScoreFormat, kScoreVersion, "trivet fit-score");
    score.origin = root.at("origin").string();
    for (std::size_t errors = 0; errors < kErrors.size(); ++errors) {
      model.bias[errors] =
          engine::number_within(root.at("bias").at(kErrors[errors]), -kLargest, kLargest);
    }
    engine::for_each_part(root.at("parts"), [&](std::size_t part, const JsonNode& rows) {
      model.knots[part] = read_row<ScoreModel::kKnots>(rows.at("knots"), -kLargest);
      if (!std::ranges::is_sorted(model.knots[part]))
        rows.at("knots").refuse("expected numbers that do not fall");
      for (std::size_t errors = 0; errors < kErrors.size(); ++errors)
        model.weights[errors][part] = read_row<ScoreModel::kKnots - 1>(rows.at(kErrors[errors]), 0);
    });
  }));
  return score;
}

}  // namespace trivet

#include "engine/loaded_library/score_calibration.hpp"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <span>

#include "engine/loaded_library/default_score.hpp"
#include "engine/loaded_library/score_json.hpp"
#include "storage/files/file.hpp"
#include "storage/files/json_text.hpp"

namespace trivet {
namespace {

constexpr std::string_view kFormat = "trivet score calibration";
constexpr int kVersion = 1;
constexpr std::size_t kNameDigits = 16;
constexpr double kLargestShift = 100;
constexpr float kRounding = 1e-3F;  // tolerance of a raise, for numbers rounded in the file

std::uint32_t count(const JsonNode& node) {
  return static_cast<std::uint32_t>(node.integer(0, std::numeric_limits<int>::max()));
}

void check_origin(const JsonNode& root) {
  engine::check_format(root, kFormat, kVersion, "trivet calibrate");
  const JsonNode of = root.at("score");
  if (const std::string name = score_name(default_score()); of.string() != name) {
    of.refuse(
        fmt::format("expected {}, the score of this version of trivet; calibrate again, as "
                    "`trivet calibrate` reads the same scans and marks",
                    name));
  }
}

kernels::ScoreAdaptation parse_adaptation(const JsonNode& root) {
  kernels::ScoreAdaptation adaptation;
  adaptation.shift = engine::number_within(root.at("shift"), -kLargestShift, kLargestShift);
  engine::for_each_part(root.at("weights"), [&](std::size_t part, const JsonNode& weight) {
    adaptation.weights[part] =
        engine::number_within(weight, 0, static_cast<double>(kernels::kMaxCostWeight));
  });
  if (kernels::largest_raise(default_score(), adaptation) > kernels::kMaxRaise + kRounding) {
    root.refuse(
        fmt::format("expected a shift and weights that raise the log odds of no pose by "
                    "more than {:.1f}; calibrate again",
                    kernels::kMaxRaise));
  }
  return adaptation;
}

}  // namespace

std::string score_name(const kernels::ScoreModel& score) {
  return xxh3_hex(std::as_bytes(std::span(&score, 1))).substr(0, kNameDigits);
}

kernels::ScoreModel calibrated_score(const ScoreCalibration& calibration) noexcept {
  return kernels::adapted_score(default_score(), calibration.adaptation);
}

Result<void> write_calibration(const std::filesystem::path& file,
                               const ScoreCalibration& calibration) {
  nlohmann::ordered_json weights;
  for (std::size_t k = 0; k < kernels::kNumScoreParts; ++k)
    weights[std::string(kernels::kScoreParts[k].name)] = calibration.adaptation.weights[k];
  const nlohmann::ordered_json document{{"format", kFormat},
                                        {"version", kVersion},
                                        {"score", score_name(default_score())},
                                        {"name", score_name(calibrated_score(calibration))},
                                        {"shift", calibration.adaptation.shift},
                                        {"weights", std::move(weights)},
                                        {"made_from",
                                         {{"scans", calibration.num_scans},
                                          {"right", calibration.num_right},
                                          {"wrong", calibration.num_wrong}}}};
  const std::string text = json_text(document, 2) + '\n';
  return publish_file(file, std::as_bytes(std::span(text)));
}

Result<ScoreCalibration> read_calibration(const std::filesystem::path& file) {
  ScoreCalibration calibration;
  TRIVET_TRY(with_json(file, [&](const JsonNode& root) {
    check_origin(root);
    root.only({"format", "version", "score", "name", "shift", "weights", "made_from"});
    calibration.adaptation = parse_adaptation(root);
    const JsonNode from = root.at("made_from").only({"scans", "right", "wrong"});
    calibration.num_scans = count(from.at("scans"));
    calibration.num_right = count(from.at("right"));
    calibration.num_wrong = count(from.at("wrong"));
  }));
  return calibration;
}

}  // namespace trivet

/// The fitted score, read from its file by the simplest possible code.
#pragma once

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "kernels/scoring/pose_score.hpp"

namespace trivet::test {

inline constexpr const char* kFittedScore =
    TRIVET_SOURCES "/engine/loaded_library/default_score.json";

inline const kernels::ScoreModel& fitted_score() {
  static const kernels::ScoreModel model = [] {
    std::ifstream file(kFittedScore);
    const nlohmann::json score = nlohmann::json::parse(file);
    kernels::ScoreModel out;
    out.bias = {score["bias"]["independent"], score["bias"]["shared"]};
    for (std::size_t part = 0; part < kernels::kNumScoreParts; ++part) {
      const nlohmann::json& rows = score["parts"][std::string(kernels::kScoreParts[part].name)];
      rows["knots"].get_to(out.knots[part]);
      rows["independent"].get_to(out.weights[0][part]);
      rows["shared"].get_to(out.weights[1][part]);
    }
    return out;
  }();
  return model;
}

}  // namespace trivet::test

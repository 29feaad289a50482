#include "engine/loaded_library/default_score.hpp"

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "engine/loaded_library/score_file.hpp"

namespace trivet {
namespace engine {
/// The file default_score.json, embedded in the library by cmake/embed.cmake.
std::span<const std::pair<std::string_view, std::string_view>> embedded_score();
}  // namespace engine

const kernels::ScoreModel& default_score() noexcept {
  static const kernels::ScoreModel model = [] {
    const auto [name, text] = engine::embedded_score().front();
    const Result<FittedScore> score =
        parse_score(std::as_bytes(std::span(text)), std::string(name));
    // Ends the program, since the embedded file is invalid.
    if (!score) throw std::logic_error(score.error().message);
    return score->model;
  }();
  return model;
}

}  // namespace trivet

#include "engine/loaded_library/default_score.hpp"

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "engine/loaded_library/score_file.hpp"

namespace trivet {
namespace engine {
/// The file default_score.json; cmake/embed.cmake makes it a part of the library.
std::span<const std::pair<std::string_view, std::string_view>> embedded_score();
}  // namespace engine

const kernels::ScoreModel& default_score() noexcept {
  static const kernels::ScoreModel model = [] {
    const auto [name, text] = engine::embedded_score().front();
    const Result<FittedScore> score =
        parse_score(std::as_bytes(std::span(text)), std::string(name));
    if (!score) throw std::logic_error(score.error().message);  // ends the program: it was built so
    return score->model;
  }();
  return model;
}

}  // namespace trivet

#include "apps/service/serve/routes/word_table.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <utility>

#include "apps/results/robot_poses.hpp"
#include "apps/words/score_words.hpp"
#include "engine/options/method.hpp"

namespace trivet::apps::service {

nlohmann::ordered_json word_table() {
  nlohmann::ordered_json methods, conventions;
  for (const Source source : {Source::expected, Source::ppf, Source::trisi})
    methods[std::string(name_of(source))] = words_of(source);
  const std::span<const Choice> choices = choices_of<RobotConvention>();
  for (std::size_t k = 0; k < choices.size(); ++k)
    conventions[std::string(choices[k].name)] = label_of(static_cast<RobotConvention>(k));
  const auto row = [](const PartWords& words) {
    return nlohmann::ordered_json{{"label", words.label}, {"meaning", words.meaning}};
  };
  return {{"methods", std::move(methods)},
          {"robot_conventions", std::move(conventions)},
          {"score",
           {{"begin", row(kScoreRows.begin)},
            {"others", row(kScoreRows.others)},
            {"sum", row(kScoreRows.sum)}}}};
}

}  // namespace trivet::apps::service

/// What a person should know of a model before it is used.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/training/survey_model.hpp"
#include "storage/data/length_unit.hpp"

namespace trivet::engine {

/// Sentences without the model's name: a surface that one view sees whole, that is open, much of
/// which is hidden, whose faces look inwards, or that is given by few points.
std::vector<std::string> warn_of_model(const SurveyedModel& model);

/// Of each model: a diameter that is that of no part in this unit, or not of the order of those of
/// the others as those are of one another; empty where there is nothing to say.
std::vector<std::string> warn_of_sizes(std::span<const float> diameters, LengthUnit unit);

}  // namespace trivet::engine

/// Warnings about a model before it is used.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/training/survey_model.hpp"
#include "storage/data/length_unit.hpp"

namespace trivet::engine {

/// Sentences without the model's name. They warn of a surface that is visible in one view
/// completely, is open, is largely hidden, has faces that point inward, or consists of few points.
std::vector<std::string> warn_of_model(const SurveyedModel& model);

/// A warning per model whose diameter is implausible in this unit, or differs from the others' by
/// far more than these differ from one another; empty without a warning.
std::vector<std::string> warn_of_sizes(std::span<const float> diameters, LengthUnit unit);

}  // namespace trivet::engine

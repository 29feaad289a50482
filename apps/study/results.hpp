/// The results of a study, arranged for its report.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/study/plan.hpp"
#include "apps/study/run.hpp"
#include "apps/study/study.hpp"
#include "engine/evaluation/compare_paired.hpp"
#include "engine/evaluation/evaluate.hpp"

namespace trivet::apps::study {

/// Successes of some trials, and the Wilson interval of their rate.
struct Rate {
  std::size_t right = 0, all = 0;
  double value() const noexcept;  ///< 0 without trials
  std::pair<double, double> interval() const noexcept;
};

/// The harmonic mean of recall (the found fraction of truths) and precision (the correct fraction
/// of reports).
double f1_score(const Rate& found, std::size_t num_false) noexcept;

/// Whether a difference is significant: McNemar's p is below 0.05, and the interval excludes 0.
bool beyond_chance(const PairedComparison& comparison) noexcept;

/// One method under one condition.
struct PanelCell {
  Rate found;
  /// Detections without a truth. None in a bin of truths, to which no detection belongs.
  std::optional<std::size_t> false_positives;
  std::size_t num_scenes = 0, num_add_right = 0;
  double f1 = 0;
  double threshold = 0;           ///< lowest score that counts as reported
  std::optional<double> seconds;  ///< per scene on one core, median
  std::optional<double> translation_error, rotation_error_deg;  ///< medians over correct detections
  std::optional<PairedComparison> change;                       ///< this row minus its reference
  std::optional<PairedComparison> lead;  ///< this method minus the panel's first
};

/// The row with which a row of a panel is compared.
enum class Reference : std::uint8_t { none, fixed, previous };

/// A table and its curves: methods under the conditions of the rows.
struct Panel {
  std::string title;
  std::string axis;       ///< quantity or category of the rows
  bool is_curve = false;  ///< rows are ordered by a quantity; false: rows are names
  std::vector<std::string> rows;
  bool has_total = false;  ///< the last row is the total of the others, and not part of a curve
  std::vector<Method> methods;
  std::vector<std::vector<PanelCell>> cells;  ///< indexed by method, then by row
  Reference reference = Reference::none;
  std::size_t reference_row = 0;  ///< used with Reference::fixed
};

/// The question of an experiment.
enum class ExperimentKind : std::uint8_t {
  /// Which truths are found: rows are bins of truths, then all.
  bins,
  /// The performance of the methods: rows are groups of scenes.
  groups,
  /// The contribution of each step: rows are variants, each compared with the previous one.
  steps,
  /// The choice of a default: rows are values, compared with it.
  parameter,
  /// The robustness of the methods: rows are values of something that is not a parameter of the
  /// method.
  conditions,
};

struct ExperimentResults {
  ExperimentKind kind = ExperimentKind::groups;
  std::vector<Panel> panels;
};

/// A scene for the report, with the results of one method in it.
struct StudyPicture {
  std::size_t set = 0, scene = 0;  ///< indices in the plan
  std::string caption;
  SceneResult result;
  Evaluation evaluation;  ///< evaluation of this scene alone
};

/// The resources of a library, whatever is searched for in it.
struct LibraryRow {
  std::size_t num_models = 0;
  std::uint64_t file_bytes = 0;
  LibraryUse use{};
};

struct StudyResults {
  std::vector<Manifest> sets;
  std::vector<ExperimentResults> experiments;
  std::vector<LibraryRow> libraries;  ///< libraries of increasing numbers of models
  std::vector<StudyPicture> pictures;
  std::size_t num_recognitions = 0, num_scenes = 0, num_instances = 0;
};

/// Evaluates all cells. Errors: of reading and evaluating.
Result<StudyResults> evaluate_study(const Study& study, const StudyPlan& plan,
                                    const StudyFolder& folder);

}  // namespace trivet::apps::study

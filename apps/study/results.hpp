/// What a study found, arranged as its report shows it.
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

/// Successes of some trials, with what Wilson's interval says of their rate.
struct Rate {
  std::size_t right = 0, all = 0;
  double value() const noexcept;  ///< 0 without trials
  std::pair<double, double> interval() const noexcept;
};

/// The harmonic mean of the share found and of the share of reports that are right.
double f1_score(const Rate& found, std::size_t num_false) noexcept;

/// Whether chance alone explains a difference badly: McNemar's p below 0.05, and an interval that
/// leaves 0 out.
bool beyond_chance(const PairedComparison& comparison) noexcept;

/// One method under one condition.
struct PanelCell {
  Rate found;
  /// Detections that no truth has. None in a bin of truths, which no detection belongs to.
  std::optional<std::size_t> false_positives;
  std::size_t num_scenes = 0, num_add_right = 0;
  double f1 = 0;
  double threshold = 0;           ///< of the scores that count as reported
  std::optional<double> seconds;  ///< a scene on one core, median
  std::optional<double> translation_error, rotation_error_deg;  ///< medians, of right ones
  std::optional<PairedComparison> change;                       ///< this row less its reference
  std::optional<PairedComparison> lead;  ///< this method less the panel's first
};

/// What a row of a panel is compared with.
enum class Reference : std::uint8_t { none, fixed, previous };

/// A table and its curves: methods under the conditions that the rows are.
struct Panel {
  std::string title;
  std::string axis;       ///< what the rows are
  bool is_curve = false;  ///< rows are in the order of a quantity, not names
  std::vector<std::string> rows;
  bool has_total = false;  ///< the last row is all others together, and no part of a curve
  std::vector<Method> methods;
  std::vector<std::vector<PanelCell>> cells;  ///< of each method, one a row
  Reference reference = Reference::none;
  std::size_t reference_row = 0;  ///< with Reference::fixed
};

/// What an experiment asks.
enum class ExperimentKind : std::uint8_t {
  bins,        ///< which truths are found: rows are bins of truths, then all
  groups,      ///< how the methods do: rows are groups of scenes
  steps,       ///< what each adds: rows are variants, compared with the one before
  parameter,   ///< where a default lies: rows are values, compared with it
  conditions,  ///< what the methods bear: rows are values of something that is not the method's
};

struct ExperimentResults {
  ExperimentKind kind = ExperimentKind::groups;
  std::vector<Panel> panels;
};

/// A scene to be shown, with what one method found in it.
struct StudyPicture {
  std::size_t set = 0, scene = 0;  ///< of the plan
  std::string caption;
  SceneResult result;
  Evaluation evaluation;  ///< of this scene alone
};

/// What a library takes, whatever is searched for in it.
struct LibraryRow {
  std::size_t num_models = 0;
  std::uint64_t file_bytes = 0;
  LibraryUse use{};
};

struct StudyResults {
  std::vector<Manifest> sets;
  std::vector<ExperimentResults> experiments;
  std::vector<LibraryRow> libraries;  ///< of different numbers of models, rising
  std::vector<StudyPicture> pictures;
  std::size_t num_recognitions = 0, num_scenes = 0, num_instances = 0;
};

/// Judge all cells. Errors: of reading and evaluating.
Result<StudyResults> evaluate_study(const Study& study, const StudyPlan& plan,
                                    const StudyFolder& folder);

}  // namespace trivet::apps::study

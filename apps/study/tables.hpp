/// A study as a table for spreadsheets and statistics programs.
#pragma once

#include "apps/study/results.hpp"
#include "apps/study/run.hpp"
#include "apps/study/study.hpp"

namespace trivet::apps::study {

/// Writes FOLDER/results.csv, one row per method and condition: the found fraction, with Wilson's
/// interval; the differences from the panel's reference row (change) and from its first method
/// (lead), with bootstrap interval and McNemar's p. Empty if a number is unknown.
/// Errors: cannot_create, io.
Result<void> write_study_table(const Study& study, const StudyResults& results,
                               const StudyFolder& folder);

}  // namespace trivet::apps::study

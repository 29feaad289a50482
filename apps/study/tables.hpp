/// A study as a table for spreadsheets and statistics programs.
#pragma once

#include "apps/study/results.hpp"
#include "apps/study/run.hpp"
#include "apps/study/study.hpp"

namespace trivet::apps::study {

/// Write FOLDER/results.csv, one row a method under one condition: what was found, with Wilson's
/// interval; the difference from the panel's reference row (change) and from its first method
/// (lead), with bootstrap interval and McNemar's p. Empty where a number is not known. Errors:
/// cannot_create, io.
Result<void> write_study_table(const Study& study, const StudyResults& results,
                               const StudyFolder& folder);

}  // namespace trivet::apps::study

/// The report of a study: a single self-contained page.
#pragma once

#include <string>

#include "apps/study/results.hpp"
#include "apps/study/run.hpp"
#include "apps/study/study.hpp"

namespace trivet::apps::study {

/// Writes FOLDER/index.html: a headline for each experiment, then its curves and tables, pictures
/// of scenes, and instructions to reproduce the numbers. The page appears whole or not at all.
/// Errors: of reading and drawing the scenes; cannot_create, io.
///
/// command  reproduces this page, quoted for a shell
Result<void> write_study_page(const Study& study, const StudyResults& results,
                              const StudyFolder& folder, const std::string& command);

}  // namespace trivet::apps::study

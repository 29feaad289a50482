/// The report of a study: one page that needs nothing else.
#pragma once

#include <string>

#include "apps/study/results.hpp"
#include "apps/study/run.hpp"
#include "apps/study/study.hpp"

namespace trivet::apps::study {

/// Write FOLDER/index.html: a headline for each experiment, then its curves and tables, pictures of
/// scenes, and what leads to the same numbers again. The page appears whole or not at all. Errors:
/// of reading and drawing the scenes; cannot_create, io.
///
/// command  that leads to this page, as a shell takes it
Result<void> write_study_page(const Study& study, const StudyResults& results,
                              const StudyFolder& folder, const std::string& command);

}  // namespace trivet::apps::study

#include "python/src/evaluate.hpp"

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/inputs/inputs.hpp"
#include "apps/results/evaluation_json.hpp"
#include "engine/evaluation/bop_scores.hpp"
#include "engine/evaluation/evaluate.hpp"
#include "engine/evaluation/manifest_inputs.hpp"
#include "engine/recognition/recognize.hpp"
#include "python/src/call.hpp"
#include "python/src/library.hpp"
#include "python/src/recognize.hpp"
#include "storage/files/json_text.hpp"

namespace trivet::python {
namespace {

/// Returns the document of `trivet evaluate --json`.
std::string evaluate_manifest(const OpenLibrary& library, const std::string& file,
                              const std::string& preset, const py::object& progress,
                              const py::dict& keywords) {
  RecognizeOptions options = recognize_options(preset, keywords);
  options.doubtful_score = std::min(kLowestKeptScore, options.min_score);
  std::stop_source stop;
  Reports reports(progress, stop);
  const auto judge = [&](const std::stop_token& token) -> Result<std::string> {
    const Result<Manifest> manifest = apps::read_listing(file);
    if (!manifest) return manifest.error();
    const Result<std::vector<EvaluationMesh>> meshes = read_evaluation_meshes(*manifest);
    if (!meshes) return meshes.error();
    std::vector<std::optional<SceneResult>> results(manifest->scenes.size());
    const Result<void> done = recognize_all(
        *library.recognizer, scenes_of(*manifest, library.library().header.unit), options,
        reports.to(token),
        [&](std::size_t index, const SceneResult& result) { results[index] = result; });
    if (!done) return done.error();
    const Result<Evaluation> evaluation = evaluate(*manifest, *meshes, results, options.min_score,
                                                   options.require_pose, options.require_identity);
    if (!evaluation) return evaluation.error();
    const Result<BopScores> bop = bop_scores(*manifest, *meshes, results);
    if (!bop) return bop.error();
    return json_text(apps::evaluation_json(
        *manifest, *evaluation,
        {options.min_score, options.require_pose, options.require_identity, options.doubtful_score},
        *bop, results));
  };
  const Result<std::string> document = interruptibly(judge, stop);
  reports.rethrow();
  return unwrap(document);
}

}  // namespace

void add_evaluate(py::module_& module) { module.def("_evaluate", &evaluate_manifest); }

}  // namespace trivet::python

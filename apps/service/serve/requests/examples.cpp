#include "apps/service/serve/requests/examples.hpp"

#include "apps/inputs/inputs.hpp"
#include "apps/service/serve/requests/reading_query.hpp"

namespace trivet::apps::service {

Result<std::vector<Example>> list_examples(const std::string& listing) {
  const Result<Manifest> manifest = read_listing(listing);
  if (!manifest) return manifest.error();
  std::vector<Example> examples;
  for (const ManifestScene& scene : manifest->scenes) {
    examples.push_back({scene.name, scene.file, reading_query(scene, manifest->unit)});
  }
  return examples;
}

}  // namespace trivet::apps::service

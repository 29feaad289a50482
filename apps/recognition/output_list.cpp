#include "apps/recognition/output_list.hpp"

namespace trivet::apps {

void OutputList::add(const RecognizedScene& scene) {
  for (Entry& entry : entries_) {
    if (entry.added) entry.added = entry.output->add(scene);
  }
}

void OutputList::add_failed(const SceneInput& scene, const Error& error) {
  for (const Entry& entry : entries_) entry.output->add_failed(scene, error);
}

Result<void> OutputList::finish() {
  for (const Entry& entry : entries_) {
    TRIVET_TRY(entry.added);
  }
  for (const Entry& entry : entries_) {
    TRIVET_TRY(entry.output->finish());
  }
  return {};
}

}  // namespace trivet::apps

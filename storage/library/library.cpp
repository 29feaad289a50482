#include "storage/library/library.hpp"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <utility>

#include "storage/common/precondition.hpp"
#include "storage/library/library_checks.hpp"

namespace trivet {
namespace {

/// Resident size of the files that the process maps.
std::uint64_t mapped_bytes_in_memory() {
  std::uint64_t all = 0, resident = 0, of_files = 0;
  std::ifstream("/proc/self/statm") >> all >> resident >> of_files;
  return of_files * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace

FeatureLevels::FeatureLevels(FeatureIndex levels, std::size_t num_models,
                             std::shared_ptr<const LibraryChecks> checks)
    : levels_(std::make_shared<const FeatureIndex>(std::move(levels))),
      num_models_(num_models),
      checks_(std::move(checks)) {}

const FeatureLevel& FeatureLevels::at(std::size_t level) const {
  TRIVET_REQUIRE(level < size(), "a level of the index");
  return (*levels_)[level];
}

LevelShape FeatureLevels::shape(std::size_t level) const {
  const FeatureLevel& found = at(level);
  return {found.resolution, found.models, found.size(), found.codes.size()};
}

Result<const FeatureLevel*> FeatureLevels::level(std::size_t level) const {
  const FeatureLevel& found = at(level);
  if (checks_) TRIVET_TRY(checks_->check(found, level, num_models_));
  return &found;
}

Library::Library(std::vector<Model> all_models, FeatureLevels levels,
                 std::shared_ptr<const LibraryChecks> checks)
    : index(std::move(levels)) {
  Contents contents;
  contents.infos.reserve(all_models.size());
  contents.columns.reserve(all_models.size());
  for (Model& model : all_models) {
    contents.infos.push_back(std::move(static_cast<ModelInfo&>(model)));
    contents.columns.push_back(std::move(static_cast<ModelColumns&>(model)));
  }
  contents.checks = std::move(checks);
  contents_ = std::make_shared<const Contents>(std::move(contents));
  models = contents_->infos;
}

const ModelColumns& Library::columns_of(std::uint32_t model) const {
  TRIVET_REQUIRE(contents_ && model < contents_->columns.size(), "a model of the library");
  return contents_->columns[model];
}

ModelShape Library::shape(std::uint32_t model) const { return shape_of(columns_of(model)); }

bool Library::has_pairs() const noexcept {
  return contents_ && std::ranges::any_of(contents_->columns, [](const ModelColumns& columns) {
           return shape_of(columns).has_pairs();
         });
}

Result<void> Library::check(std::uint32_t model, ModelPart part) const {
  const ModelColumns& columns = columns_of(model);
  const LibraryChecks* const checks = contents_->checks.get();
  return checks ? checks->check(contents_->infos[model].name, columns, model, part)
                : Result<void>();
}

template <class Columns>
Result<const Columns*> Library::checked(std::uint32_t model, ModelPart part) const {
  TRIVET_TRY(check(model, part));
  return &columns_of(model);
}

Result<const ModelSurface*> Library::surface(std::uint32_t model) const {
  return checked<ModelSurface>(model, ModelPart::surface);
}

Result<const ModelSamples*> Library::samples(std::uint32_t model) const {
  return checked<ModelSamples>(model, ModelPart::samples);
}

Result<const ModelPairs*> Library::pairs(std::uint32_t model) const {
  return checked<ModelPairs>(model, ModelPart::pairs);
}

Result<const ModelFeatures*> Library::features(std::uint32_t model) const {
  return checked<ModelFeatures>(model, ModelPart::features);
}

Result<Model> Library::model(std::uint32_t model) const {
  for (const ModelPart part : kModelParts) {
    TRIVET_TRY(check(model, part));
  }
  return Model{contents_->infos[model], contents_->columns[model]};
}

Result<void> Library::unchanged() const {
  return contents_ && contents_->checks ? contents_->checks->unchanged() : Result<void>();
}

bool Library::is_changed() const noexcept {
  return contents_ && contents_->checks && contents_->checks->is_changed();
}

Result<void> Library::check_all() const {
  for (std::uint32_t m = 0; m < models.size(); ++m) {
    for (const ModelPart part : kModelParts) {
      TRIVET_TRY(check(m, part));
    }
  }
  for (std::size_t level = 0; level < index.size(); ++level) {
    TRIVET_TRY(index.level(level));
  }
  return {};
}

void Library::ask_for(std::uint32_t model, ModelPart part) const noexcept {
  if (contents_ && contents_->checks) contents_->checks->ask_for(model, part);
}

void Library::release_memory(std::uint64_t more_than) const {
  if (contents_ && contents_->checks && mapped_bytes_in_memory() > more_than)
    contents_->checks->release_memory();
}

}  // namespace trivet

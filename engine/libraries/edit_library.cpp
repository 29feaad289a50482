#include "engine/libraries/edit_library.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "engine/libraries/assemble_library.hpp"
#include "storage/files/json_text.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;

/// A library that will be replaced.
struct OpenedForChange {
  FileLock lock;
  Library library;
};

Result<OpenedForChange> open_for_change(const fs::path& file) {
  TRIVET_TRY_ASSIGN(FileLock lock, FileLock::acquire(file));
  TRIVET_TRY_ASSIGN(Library library, open_library(file));
  return OpenedForChange{std::move(lock), std::move(library)};
}

bool has_model(const Library& library, const std::string& name) {
  return std::ranges::binary_search(library.models, name, {}, &Model::name);
}

Result<void> write_again(const OpenedForChange& opened, std::vector<ModelCopy> models,
                         const Progress& progress) {
  return assemble_library(opened.library.header, opened.library.basis, std::move(models),
                          opened.lock, progress);
}

/// Members of a JSON object that differ from another's; all if one of them is not an object.
std::string parameters_beside(const std::string& own, const std::string& other) {
  const auto a = parse_json(own), b = parse_json(other);
  if (!a.is_object() || !b.is_object()) return own;
  nlohmann::json differing = nlohmann::json::object();
  for (const auto& [key, value] : a.items())
    if (!b.contains(key) || b.at(key) != value) differing[key] = value;
  for (const auto& [key, value] : b.items())
    if (!a.contains(key)) differing[key] = nullptr;
  return json_text(differing);
}

/// Whether two models were trained from the same input; unknown inputs are different.
bool same_model(const ModelInfo& a, const ModelInfo& b) {
  return !a.fingerprint.empty() && a.fingerprint == b.fingerprint;
}

}  // namespace

Result<std::uint32_t> find_model(const Library& library, const std::string& name) {
  const auto found = std::ranges::lower_bound(library.models, name, {}, &Model::name);
  if (found != library.models.end() && found->name == name)
    return static_cast<std::uint32_t>(found - library.models.begin());
  return Error{ErrorCode::usage,
               fmt::format("{}: has no model '{}'; `trivet library list` names those that it has",
                           library.file.string(), name)};
}

Result<void> remove_models(const fs::path& file, std::span<const std::string> names,
                           const Progress& progress) {
  TRIVET_TRY_ASSIGN(const OpenedForChange opened, open_for_change(file));
  for (const std::string& name : names) {
    TRIVET_TRY(find_model(opened.library, name));
  }
  std::vector<ModelCopy> staying = copies_of(opened.library);
  std::erase_if(staying, [&](const ModelCopy& copy) {
    return std::ranges::find(names, copy.name) != names.end();
  });
  if (staying.empty()) {
    return Error{
        ErrorCode::usage,
        fmt::format("{}: expected models that stay, found none: remove the file", file.string())};
  }
  return write_again(opened, std::move(staying), progress);
}

Result<void> rename_model(const fs::path& file, const std::string& from, const std::string& to,
                          const Progress& progress) {
  TRIVET_TRY_ASSIGN(const OpenedForChange opened, open_for_change(file));
  TRIVET_TRY_ASSIGN(const std::uint32_t renamed, find_model(opened.library, from));
  if (has_model(opened.library, to)) {
    return Error{ErrorCode::usage,
                 fmt::format("{}: has a model '{}' already; remove it first", file.string(), to)};
  }
  std::vector<ModelCopy> models = copies_of(opened.library);
  models[renamed].name = to;
  return write_again(opened, std::move(models), progress);
}

std::string why_not_together(const Library& library, const LibraryHeader& header,
                             const TriSpinBasis& basis) {
  const PcaBasis &p = library.basis.components, &q = basis.components;
  if (library.header.unit != header.unit)
    return fmt::format("the unit {}", unit_name(library.header.unit));
  if (library.header.parameters != header.parameters)
    return fmt::format("the parameters {}",
                       parameters_beside(library.header.parameters, header.parameters));
  if (library.basis.support != basis.support || library.basis.code_step != basis.code_step ||
      p.mean != q.mean || p.components != q.components)
    return fmt::format("the principal components of {}", library.header.producer);
  return "";
}

Result<void> copy_models(const Library& from, const fs::path& file, std::size_t most_models,
                         const Progress& progress) {
  TRIVET_TRY_ASSIGN(const OpenedForChange opened, open_for_change(file));
  const Library& library = opened.library;
  if (const std::string differs = why_not_together(from, library.header, library.basis);
      !differs.empty()) {
    return Error{ErrorCode::usage,
                 fmt::format("{}: was trained with {}, other than {}; train it as the others",
                             from.file.string(), differs, file.string())};
  }
  std::vector<ModelCopy> models = copies_of(library);
  std::erase_if(models, [&](const ModelCopy& copy) { return has_model(from, copy.name); });
  std::ranges::move(copies_of(from), std::back_inserter(models));
  if (models.size() > most_models) {
    return Error{ErrorCode::usage, fmt::format("{}: expected at most {} models, found {}",
                                               file.string(), most_models, models.size())};
  }
  return write_again(opened, std::move(models), progress);
}

Result<void> merge_libraries(std::span<const fs::path> files, const fs::path& into,
                             const Progress& progress) {
  std::deque<Library> libraries;  // referenced by copies
  std::map<std::string, ModelCopy> models;
  for (const fs::path& file : files) {
    TRIVET_TRY_ASSIGN(Library opened, open_library(file));
    const Library& library = libraries.emplace_back(std::move(opened));
    const Library& first = libraries.front();
    if (const std::string differs = why_not_together(library, first.header, first.basis);
        !differs.empty()) {
      return Error{ErrorCode::usage,
                   fmt::format("{}: was trained with {}, other than {}; train both alike",
                               file.string(), differs, first.file.string())};
    }
    for (ModelCopy& copy : copies_of(library)) {
      const auto [at, added] = models.emplace(copy.name, copy);
      if (added || same_model(at->second.info(), copy.info())) continue;
      return Error{ErrorCode::usage,
                   fmt::format("{} and {}: both have a model '{}', and not the same; rename one",
                               at->second.library->file.string(), file.string(), copy.name)};
    }
  }
  TRIVET_TRY_ASSIGN(const FileLock lock, FileLock::acquire(into));
  std::vector<ModelCopy> all;
  for (auto& [name, copy] : models) all.push_back(std::move(copy));
  return assemble_library(libraries.front().header, libraries.front().basis, std::move(all), lock,
                          progress);
}

LibraryDifference compare_libraries(const Library& before, const Library& after) {
  LibraryDifference out;
  out.same_parameters = before.header.unit == after.header.unit &&
                        before.header.parameters == after.header.parameters;
  std::multimap<std::string, std::string> added;  // keyed by fingerprint
  for (const ModelInfo& model : after.models) {
    if (!has_model(before, model.name)) added.emplace(model.fingerprint, model.name);
  }
  for (const ModelInfo& model : before.models) {
    if (const Result<std::uint32_t> now = find_model(after, model.name)) {
      if (same_model(model, after.models[*now])) {
        ++out.num_same;
      } else {
        out.changed.push_back(model.name);
      }
      continue;
    }
    const auto renamed = model.fingerprint.empty() ? added.end() : added.find(model.fingerprint);
    if (renamed == added.end()) {
      out.removed.push_back(model.name);
    } else {
      out.renamed.emplace_back(model.name, renamed->second);
      added.erase(renamed);
    }
  }
  for (const auto& [fingerprint, name] : added) out.added.push_back(name);
  std::ranges::sort(out.added);
  return out;
}

}  // namespace trivet

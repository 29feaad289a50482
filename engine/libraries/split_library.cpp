#include "engine/libraries/split_library.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <system_error>

#include "engine/libraries/assemble_library.hpp"

namespace trivet {
namespace {

double weight_of(const Model& model) {
  std::size_t codes = 0;
  for (const TriSpinFeatures& features : model.features) codes += features.codes.size();
  return static_cast<double>(model.ppf.entries.size_bytes() + model.ppf.offsets.size_bytes() +
                             codes + 1);
}

}  // namespace

std::vector<std::vector<std::uint32_t>> split_models(const Library& library,
                                                     std::size_t num_parts) {
  const std::size_t n = library.models.size();
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(
      order, {}, [&](std::uint32_t m) { return library.models[m].ppf.quantization.distance_step; });
  double all = 0, before = 0;
  for (const Model& model : library.models) all += weight_of(model);
  std::vector<std::vector<std::uint32_t>> parts(num_parts);
  std::size_t part = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double weight = weight_of(library.models[order[i]]);
    const auto wanted =
        static_cast<std::size_t>((before + weight / 2) / all * static_cast<double>(num_parts));
    before += weight;
    // One further at most, and only from a part that has something; the last models fill what
    // would stay empty.
    const std::size_t least = num_parts - std::min(num_parts, n - i);
    const bool may_step = !parts[part].empty() && part + 1 < num_parts;
    if (may_step && (wanted > part || least > part)) ++part;
    parts[part].push_back(order[i]);
  }
  for (std::vector<std::uint32_t>& models : parts) std::ranges::sort(models);
  return parts;
}

Result<std::vector<std::filesystem::path>> split_library(const Library& library,
                                                         std::size_t num_parts,
                                                         const std::filesystem::path& folder) {
  if (num_parts < 1 || num_parts > library.models.size()) {
    return Error{ErrorCode::usage,
                 fmt::format("{}: expected 1 to {} parts, one a model at most, found {}",
                             library.file.string(), library.models.size(), num_parts)};
  }
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    return Error{ErrorCode::cannot_create,
                 fmt::format("{}: cannot create the folder: {}", folder.string(), error.message())};
  }
  std::vector<std::filesystem::path> files;
  for (const std::vector<std::uint32_t>& models : split_models(library, num_parts)) {
    files.push_back(folder /
                    fmt::format("{}-{}.h5", library.file.stem().string(), files.size() + 1));
    std::vector<ModelCopy> copies;
    for (const std::uint32_t m : models) copies.push_back(copy_of(library, m));
    const Result<FileLock> lock = FileLock::acquire(files.back());
    if (!lock) return lock.error();
    if (const Result<void> copied =
            assemble_library(library.header, library.basis, std::move(copies), *lock);
        !copied)
      return copied.error();
  }
  return files;
}

}  // namespace trivet

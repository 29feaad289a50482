#include "engine/training/training_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "engine/common/parallel.hpp"
#include "storage/file.hpp"

namespace trivet::engine {
namespace {

namespace fs = std::filesystem;

// A part costs two fsyncs and a file; what is not in one yet is lost with its process.
constexpr std::chrono::seconds kLongestPart{10};
constexpr std::uint64_t kLargestPart = std::uint64_t{256} << 20U;

fs::path part_of(const fs::path& folder, int writer, int number) {
  return folder / fmt::format("{}-{}.h5", writer, number);
}

}  // namespace

fs::path parts_folder(const fs::path& library) {
  fs::path folder = library;
  folder += ".parts";
  return folder;
}

std::vector<Library> open_parts(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder, error)) files.push_back(entry.path());
  std::ranges::sort(files);
  std::vector<Library> parts;
  for (const fs::path& file : files) {
    Result<Library> part = open_library(file);
    if (part) {
      parts.push_back(std::move(*part));
    } else {
      fs::remove(file, error);
    }
  }
  return parts;
}

void remove_parts(const fs::path& folder, std::vector<Library> parts) noexcept {
  for_each_index(parts.size(), [&](std::size_t k) {
    std::error_code error;
    fs::remove(std::exchange(parts[k], {}).file, error);
  });
  std::error_code error;
  fs::remove_all(folder, error);
}

Result<void> PartWriter::open() {
  if (const Result<void> made = make_folder(folder_); !made) return made;
  std::error_code error;
  while (fs::exists(part_of(folder_, writer_, num_parts_), error)) ++num_parts_;
  Result<LibraryWriter> part =
      LibraryWriter::create(part_of(folder_, writer_, num_parts_), header_);
  if (!part) return part.error();
  if (basis_.components.size() > 0) {
    if (const Result<void> added = part->add(basis_); !added) return added;
  }
  part_ = std::move(*part);
  opened_ = std::chrono::steady_clock::now();
  num_bytes_ = 0;
  return {};
}

Result<std::shared_ptr<PackedModel>> PartWriter::add(const Model& model) {
  if (!part_) {
    if (const Result<void> opened = open(); !opened) return opened.error();
  }
  const Result<std::shared_ptr<PackedModel>> packed = part_->pack(model);
  const Result<void> added = packed ? part_->add(**packed) : packed.error();
  if (!added) {
    part_.reset();
    return added.error();
  }
  num_bytes_ += stored_bytes(model);
  if (num_bytes_ < kLargestPart && std::chrono::steady_clock::now() - opened_ < kLongestPart)
    return packed;
  if (const Result<void> closed = close(); !closed) return closed.error();
  return packed;
}

Result<void> PartWriter::close() {
  if (!part_) return {};
  const Result<void> published = part_->publish();
  part_.reset();
  if (published) give_back_file(part_of(folder_, writer_, num_parts_));
  return published;
}

std::uint64_t stored_bytes(const Model& model) {
  constexpr std::uint64_t kPoint = 3 * sizeof(float);
  std::uint64_t bytes = kPoint * (model.vertices.size() + model.triangles.size() +
                                  2 * model.samples.size() + 2 * model.ppf_points.size()) +
                        std::span(model.sample_views).size_bytes() +
                        model.ppf.offsets.size_bytes() + model.ppf.entries.size_bytes();
  for (const TriSpinFeatures& features : model.features) {
    bytes += kPoint * features.size() + std::span(features.frames).size_bytes() +
             std::span(features.codes).size_bytes();
  }
  return bytes;
}

}  // namespace trivet::engine

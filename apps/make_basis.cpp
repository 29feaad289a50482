/// Computes the principal components that all libraries share, from generated machine parts and
/// household items, and writes engine/training/standard_basis.bin. Libraries that were trained with
/// other components cannot accept models trained with these: increase kTrainingRevision with every
/// new basis.
#include <fmt/format.h>

#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include "engine/common/parallel.hpp"
#include "engine/simulation/make_parts.hpp"
#include "engine/training/find_basis.hpp"
#include "engine/training/standard_basis.hpp"
#include "storage/files/file.hpp"

namespace {

using namespace trivet;

constexpr std::size_t kPartsAFamily = 8;
constexpr std::size_t kImagesAPart = 150;
constexpr std::uint64_t kSeed = 1;

std::vector<float> images_of(const Part& part) {
  Cloud cloud;
  cloud.points = part.vertices;
  cloud.triangles = part.triangles;
  const auto images = engine::sample_images(cloud, {part.name, part.name, 1, {}}, kImagesAPart);
  return images ? *images : std::vector<float>();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: make_basis FILE\n", stderr);
    return 2;
  }
  std::vector<std::string> families = part_families();
  for (const std::string& family : families_of("household")) families.push_back(family);
  const std::vector<Part> parts = make_parts(kPartsAFamily * families.size(), kSeed, families);
  std::vector<std::vector<float>> some(parts.size());
  engine::for_each_index(parts.size(), [&](std::size_t p) { some[p] = images_of(parts[p]); });
  std::vector<float> images;
  for (const std::vector<float>& of_part : some)
    images.insert(images.end(), of_part.begin(), of_part.end());

  const TriSpinBasis basis = engine::basis_of(images, kMostComponents);
  const std::string bytes = engine::basis_bytes(basis);
  const Result<void> written = publish_file(argv[1], std::as_bytes(std::span(bytes)));
  if (!written) {
    fmt::print(stderr, "error: {}\n", written.error().message);
    return 74;
  }
  fmt::print("{}: {} parts, {} images, {} components\n", argv[1], parts.size(),
             images.size() / basis.components.dimension, basis.components.size());
  return 0;
}

// Damaged files are refused or read as the library that was written, never as another.
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "storage/library/library.hpp"
#include "support/damaged_library.hpp"

#ifdef __SANITIZE_ADDRESS__
// HDF5 1.10.8 leaks about 300 bytes for each damaged object header.
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5"; }
#endif

namespace trivet {
namespace {

using test::difference;
using test::LibraryDamageTest;
using test::read_bytes;

TEST_F(LibraryDamageTest, RefusesATruncationAtEvery512Bytes) {
  const auto whole = read_bytes(file());
  for (std::size_t size = 0; size < whole.size(); size += 512) {
    write_file(std::string_view(whole).substr(0, size));
    expect_refused(size == 0 ? "another kind of file" : "truncated");
  }
}

TEST_F(LibraryDamageTest, RefusesBytesAfterTheEnd) {
  auto longer = read_bytes(file());
  longer.push_back('\0');
  write_file(longer);
  expect_refused("damaged");
}

TEST_F(LibraryDamageTest, NeverBecomesAnotherLibraryByAFlippedBit) {
  const auto whole = read_bytes(file());
  constexpr std::uint64_t kSeed = 20240607;
  std::mt19937_64 random(kSeed);
  for (int i = 0; i < 500; ++i) {
    const std::uint64_t bit = random() % (whole.size() * 8);
    auto damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
    write_file(damaged);
    expect_refused_or_equal("bit " + std::to_string(bit) + ", seed " + std::to_string(kSeed));
  }
}

// Metadata is a small part of the file: more bits are flipped in the first 2 kB, which is only
// metadata.
TEST_F(LibraryDamageTest, NeverBecomesAnotherLibraryByAFlippedBitOfTheStructure) {
  const auto whole = read_bytes(file());
  for (std::size_t bit = 0; bit < 8 * 2048; bit += 31) {
    auto damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
    write_file(damaged);
    expect_refused_or_equal("bit " + std::to_string(bit));
  }
}

TEST_F(LibraryDamageTest, NeverBecomesAnotherLibraryByZeroedOrSwappedBlocks) {
  const auto whole = read_bytes(file());
  for (std::size_t at = 0; at + 1024 <= whole.size(); at += 512) {
    auto zeroed = whole;
    std::fill_n(zeroed.begin() + static_cast<std::ptrdiff_t>(at), 512, char{0});
    write_file(zeroed);
    expect_refused_or_equal("zeroed at " + std::to_string(at));

    auto swapped = whole;
    const auto block = swapped.begin() + static_cast<std::ptrdiff_t>(at);
    std::swap_ranges(block, block + 512, block + 512);
    write_file(swapped);
    expect_refused_or_equal("swapped at " + std::to_string(at));
  }
}

// Nothing is asked for before: the access itself checks the part, and no other one.
TEST_F(LibraryDamageTest, GivesNoDamagedPartAndNamesTheFault) {
  const auto whole = read_bytes(file());
  const auto damage = [&](auto column) {
    auto damaged = whole;
    const auto bytes = std::as_bytes(std::span(column));
    const std::size_t at =
        whole.find(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    ASSERT_NE(at, std::string::npos);
    damaged[at + bytes.size() / 2] = static_cast<char>(damaged[at + bytes.size() / 2] ^ 1);
    write_file(damaged);
  };
  const auto expect = [&](auto get, const std::string& named) {
    const auto library = open_library(file());
    ASSERT_TRUE(library) << library.error().message;
    for (int again = 0; again < 2; ++again) {
      const auto given = get(*library);
      ASSERT_FALSE(given) << "expected a refusal: " << named;
      EXPECT_EQ(given.error().code, ErrorCode::damaged);
      EXPECT_NE(given.error().message.find(file().string() + ": /models/a/" + named),
                std::string::npos)
          << given.error().message;
    }
    EXPECT_EQ(library->shape(0).num_vertices, models_[0].vertices.size());
    const auto parts = {library->surface(0).has_value(), library->samples(0).has_value(),
                        library->pairs(0).has_value(), library->features(0).has_value()};
    EXPECT_EQ(std::ranges::count(parts, false), 1) << named;
    EXPECT_FALSE(library->model(0));
    EXPECT_TRUE(library->model(1));
  };
  const Model& model = models_[0];
  damage(model.triangles.c);
  expect([](const Library& library) { return library.surface(0); }, "triangles: expected checksum");
  damage(model.sample_normals.x);
  expect([](const Library& library) { return library.samples(0); },
         "sample_normals: expected checksum");
  damage(model.ppf.entries);
  expect([](const Library& library) { return library.pairs(0); }, "ppf/entries: expected checksum");
  damage(std::span(model.features[1].codes));
  expect([](const Library& library) { return library.features(0); },
         "trisi_2x/features: expected checksum");
}

// Recognition reads single models: a part that is given equals what was written, whatever damage
// lies elsewhere.
TEST_F(LibraryDamageTest, NeverGivesAnotherModelWhereAPartIsCheckedWhenItIsFirstRead) {
  const auto whole = read_bytes(file());
  std::mt19937_64 random(20261124);
  std::size_t num_opened = 0, num_refused_parts = 0;
  for (int i = 0; i < 1000; ++i) {
    auto damaged = whole;
    const std::size_t at = random() % whole.size();
    if (i % 3 == 0) {  // splices in other bytes
      const std::size_t from = random() % whole.size();
      const std::size_t n = std::min({whole.size() - at, whole.size() - from, random() % 5000});
      damaged.replace(at, n, whole, from, n);
    } else {
      damaged[at] = static_cast<char>(damaged[at] ^ (1 << (i % 8)));
    }
    write_file(damaged);
    const auto library = open_library(file());
    if (!library) continue;
    ++num_opened;
    ASSERT_EQ(library->models.size(), models_.size());
    for (std::uint32_t m = 0; m < models_.size(); ++m) {
      Model used = models_[m];
      static_cast<ModelInfo&>(used) = library->models[m];
      const auto take = [&](const auto& given, auto& columns) {
        if (given) {
          columns = **given;
          return;
        }
        ++num_refused_parts;
        EXPECT_NE(given.error().message.find("/models/" + models_[m].name), std::string::npos)
            << given.error().message;
      };
      take(library->surface(m), static_cast<ModelSurface&>(used));
      take(library->samples(m), static_cast<ModelSamples&>(used));
      take(library->pairs(m), static_cast<ModelPairs&>(used));
      take(library->features(m), static_cast<ModelFeatures&>(used));
      ASSERT_EQ(difference(used, models_[m]), "") << "at " << at << ", try " << i;
    }
  }
  EXPECT_GT(num_opened, 400U) << "most of the file is columns";
  EXPECT_GT(num_refused_parts, 200U);
}

}  // namespace
}  // namespace trivet

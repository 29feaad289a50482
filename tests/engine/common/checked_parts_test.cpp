#include "engine/common/checked_parts.hpp"

#include <gtest/gtest.h>

#include <array>
#include <stdexcept>
#include <string>

#include "support/library_file.hpp"
#include "support/random_model.hpp"
#include "support/temp_dir.hpp"

namespace trivet::engine {
namespace {

class CheckedParts : public test::LibraryTest {
 protected:
  CheckedParts() {
    auto writer = LibraryWriter::create(file(), {LengthUnit::meter, "trivet test", "{}"});
    const auto add = [&](const char* name, std::uint64_t seed) {
      Model model = test::random_model(name, seed);
      model.features = {};
      return static_cast<bool>(writer->add(model));
    };
    if (!writer || !add("a", 1) || !add("b", 2) || !add("c", 3) || !writer->publish())
      throw std::runtime_error("cannot write the library");
  }
};

TEST_F(CheckedParts, NamesTheModelWhosePartIsDamaged) {
  std::string bytes = test::read_bytes(file());
  {
    const auto whole = open_library(file());
    ASSERT_TRUE(whole) << whole.error().message;
    const std::span<const float> x = (*whole->samples(1))->samples.x;
    const std::size_t at = bytes.find({reinterpret_cast<const char*>(x.data()), x.size_bytes()});
    ASSERT_NE(at, std::string::npos);
    bytes[at] = static_cast<char>(bytes[at] ^ 1);
  }
  write_file(bytes);
  const auto library = open_library(file());
  ASSERT_TRUE(library) << library.error().message;
  constexpr std::array<std::uint32_t, 3> kAll{0, 1, 2};
  const auto good = pairs_of(*library, kAll);
  ASSERT_TRUE(good) << good.error().message;
  EXPECT_EQ((*good)[2], *library->pairs(2));
  const auto bad = samples_of(*library, kAll);
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().code, ErrorCode::damaged);
  EXPECT_NE(bad.error().message.find("/models/b/samples"), std::string::npos)
      << bad.error().message;
  constexpr std::array<std::uint32_t, 2> kOthers{0, 2};
  EXPECT_TRUE(samples_of(*library, kOthers));
}

}  // namespace
}  // namespace trivet::engine

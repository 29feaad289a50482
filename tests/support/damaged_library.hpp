/// Fixture for tests of libraries that are damaged, or changed by others: two models in a file.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <vector>

#include "storage/library/library.hpp"
#include "support/library_file.hpp"
#include "support/random_model.hpp"

namespace trivet::test {

class LibraryDamageTest : public LibraryTest {
 protected:
  LibraryDamageTest() {
    auto writer = LibraryWriter::create(file(), {LengthUnit::meter, "trivet test", "{}"});
    if (!writer || !writer->add(basis_) || !writer->add(models_[0]) || !writer->add(models_[1]) ||
        !writer->publish()) {
      throw std::runtime_error("cannot write the library");
    }
  }

  /// Expects the library to be refused, when it is opened or when a part is checked, with a message
  /// that contains this text.
  void expect_refused(const std::string& text) const {
    expect_refused(text, {ErrorCode::bad_data, ErrorCode::damaged});
  }
  void expect_refused(const std::string& text, std::initializer_list<ErrorCode> codes) const {
    const auto library = verify_library(file());
    ASSERT_FALSE(library) << "expected a refusal: " << text;
    EXPECT_EQ(std::ranges::count(codes, library.error().code), 1) << library.error().message;
    EXPECT_NE(library.error().message.find(file().string()), std::string::npos);
    EXPECT_NE(library.error().message.find(text), std::string::npos) << library.error().message;
  }

  /// Expects the library to be refused, or equal to what was written.
  void expect_refused_or_equal(const std::string& what) const {
    const auto library = verify_library(file());
    if (!library) return;
    ASSERT_EQ(library->models.size(), models_.size()) << what;
    EXPECT_EQ(library->header.unit, LengthUnit::meter) << what;
    EXPECT_EQ(library->header.producer, "trivet test") << what;
    EXPECT_EQ(library->header.parameters, "{}") << what;
    for (std::uint32_t i = 0; i < models_.size(); ++i) {
      EXPECT_EQ(difference(*library->model(i), models_[i]), "") << what;
    }
    EXPECT_EQ(difference(library->basis, basis_), "") << what;
  }

  const TriSpinBasis basis_ = random_basis(3, kRandomComponents);
  const std::vector<Model> models_{random_model("a", 1), random_model("b", 2)};
};

}  // namespace trivet::test

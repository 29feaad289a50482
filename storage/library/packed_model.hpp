/// A model as it is going to lie in a library.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/data/model.hpp"
#include "storage/library/packed_group.hpp"

namespace trivet {

struct PackedModel {
  Model model;  ///< keeps alive what the groups only look at
  PackedGroup own;
  std::vector<std::pair<std::string, PackedGroup>> parts;  ///< groups in the model's own, by name

  StoredGroup described() const;
};

}  // namespace trivet

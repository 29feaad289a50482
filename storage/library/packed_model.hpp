/// A model as it is going to lie in a library.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/library/packed_group.hpp"
#include "storage/model.hpp"

namespace trivet {

struct PackedModel {
  Model model;  ///< keeps alive what the groups only look at
  PackedGroup own;
  std::vector<std::pair<std::string, PackedGroup>> parts;  ///< groups in the model's own, by name

  StoredGroup described() const;
};

/// num_components  of the basis of its features; 0: none of them are kept
PackedModel pack_model(const Model& model, std::string_view unit, std::size_t num_components);

}  // namespace trivet

/// A model prepared for writing to a library.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/data/model.hpp"
#include "storage/library/packed_group.hpp"

namespace trivet {

struct PackedModel {
  Model model;  ///< keeps the viewed data of the groups alive
  PackedGroup own;
  std::vector<std::pair<std::string, PackedGroup>> parts;  ///< subgroups of the model's group, by
                                                           ///< name

  StoredGroup described() const;
};

}  // namespace trivet

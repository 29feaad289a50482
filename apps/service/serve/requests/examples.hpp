/// Example scans that the page offers to users without a scan.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "storage/common/result.hpp"

namespace trivet::apps::service {

struct Example {
  std::string name;
  std::filesystem::path file;
  std::string query;  ///< parameters of a recognition, including format
};

/// The scenes of a manifest or a BOP data set. Errors: those of read_listing.
Result<std::vector<Example>> list_examples(const std::string& listing);

}  // namespace trivet::apps::service

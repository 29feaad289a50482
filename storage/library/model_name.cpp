#include "storage/model_name.hpp"

#include <algorithm>

#include "storage/files/text.hpp"
#include "storage/read_cloud.hpp"

namespace trivet {
namespace {

using formats::is_alphanumeric;

constexpr std::size_t kLongest = 128;

bool is_allowed(char c) noexcept { return is_alphanumeric(c) || c == '.' || c == '_' || c == '-'; }

}  // namespace

bool is_model_name(std::string_view name) noexcept {
  return !name.empty() && name.size() <= kLongest && is_alphanumeric(name.front()) &&
         std::ranges::all_of(name, is_allowed) && name.find("..") == std::string_view::npos;
}

std::string model_name_of(const std::filesystem::path& file) {
  const std::string stem = cloud_name(file);
  if (is_model_name(stem)) return stem;
  std::string name;
  bool replaced = false;  // the last character
  for (const char c : stem) {
    const bool repeats = is_allowed(c) ? c == '.' && name.ends_with('.') : replaced;
    replaced = !is_allowed(c);
    if (!repeats && name.size() < kLongest && (!name.empty() || is_alphanumeric(c)))
      name += replaced ? '_' : c;
  }
  while (!name.empty() && !is_alphanumeric(name.back())) name.pop_back();
  return name.empty() ? "model" : name;
}

}  // namespace trivet

#include "storage/datasets/bop.hpp"

#include <fmt/format.h>

namespace trivet {

std::string bop_model_name(int object_id) { return fmt::format("obj_{:06}", object_id); }

std::filesystem::path bop_scene_folder(const std::filesystem::path& split_folder, int scene_id) {
  return split_folder / fmt::format("{:06}", scene_id);
}

std::filesystem::path bop_depth_file(const std::filesystem::path& scene_folder, int image_id) {
  return scene_folder / "depth" / fmt::format("{:06}.png", image_id);
}

std::filesystem::path bop_mask_file(const std::filesystem::path& scene_folder, int image_id,
                                    std::size_t instance) {
  return scene_folder / "mask" / fmt::format("{:06}_{:06}.png", image_id, instance);
}

std::filesystem::path bop_visible_mask_file(const std::filesystem::path& scene_folder, int image_id,
                                            std::size_t instance) {
  return scene_folder / "mask_visib" / fmt::format("{:06}_{:06}.png", image_id, instance);
}

}  // namespace trivet

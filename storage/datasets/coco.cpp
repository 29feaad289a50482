#include "storage/datasets/coco.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "storage/files/file.hpp"
#include "storage/files/json_text.hpp"

namespace trivet {
namespace {

using nlohmann::ordered_json;

ordered_json mask_json(const CocoMask& mask) {
  return {{"counts", mask.counts}, {"size", {mask.height, mask.width}}};
}

ordered_json result_json(const CocoResult& result) {
  return {{"scene_id", result.scene_id},
          {"image_id", result.image_id},
          {"category_id", result.object_id},
          {"score", result.score},
          {"bbox", result.bbox},
          {"segmentation", mask_json(result.mask)},
          {"time", result.seconds}};
}

ordered_json image_json(const CocoImage& image) {
  return {{"id", image.id},
          {"file_name", image.file},
          {"width", image.width},
          {"height", image.height},
          {"license", 1}};
}

ordered_json instance_json(std::size_t id, const CocoImage& image, const CocoInstance& instance) {
  return {{"id", id},
          {"image_id", image.id},
          {"category_id", instance.object_id},
          {"iscrowd", 0},
          {"area", instance.mask.num_pixels},
          {"bbox", instance.bbox},
          {"segmentation", mask_json(instance.mask)},
          {"width", image.width},
          {"height", image.height},
          {"ignore", instance.ignore}};
}

Result<void> publish(const std::filesystem::path& file, const std::string& text) {
  return publish_file(file, std::as_bytes(std::span(text)));
}

}  // namespace

CocoMask encode_coco_mask(std::span<const std::uint8_t> pixels, std::uint32_t width) {
  CocoMask mask;
  mask.width = width;
  mask.height = static_cast<std::uint32_t>(pixels.size() / width);
  bool on = false;
  std::uint32_t run = 0;
  for (std::uint32_t u = 0; u < mask.width; ++u) {
    for (std::uint32_t v = 0; v < mask.height; ++v) {
      const bool here = pixels[std::size_t{v} * width + u] != 0;
      if (here != on) {
        mask.counts.push_back(std::exchange(run, 0));
        on = here;
      }
      ++run;
      mask.num_pixels += here ? 1 : 0;
    }
  }
  mask.counts.push_back(run);
  return mask;
}

Result<void> write_coco_results(const std::filesystem::path& file,
                                std::span<const CocoResult> results) {
  std::string text = "[";
  for (const CocoResult& result : results)
    text += fmt::format("{}\n  {}", text == "[" ? "" : ",", json_text(result_json(result)));
  return publish(file, text + "\n]\n");
}

Result<void> write_coco_truth(const std::filesystem::path& file, std::span<const int> object_ids,
                              std::span<const CocoImage> images) {
  ordered_json document{{"info", {{"description", "scene_gt_coco"}}},
                        {"licenses", ordered_json::array()},
                        {"categories", ordered_json::array()},
                        {"images", ordered_json::array()},
                        {"annotations", ordered_json::array()}};
  for (const int id : object_ids)
    document["categories"].push_back({{"id", id}, {"name", std::to_string(id)}});
  for (const CocoImage& image : images) {
    document["images"].push_back(image_json(image));
    for (const CocoInstance& instance : image.instances) {
      if (instance.mask.num_pixels == 0) continue;
      document["annotations"].push_back(
          instance_json(document["annotations"].size() + 1, image, instance));
    }
  }
  return publish(file, json_text(document) + "\n");
}

}  // namespace trivet

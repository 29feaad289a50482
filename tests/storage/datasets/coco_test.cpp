#include "storage/datasets/coco.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/temp_dir.hpp"

namespace trivet {
namespace {

/// Decodes a mask as the COCO toolkit does: runs alternate between off and on, column by column.
std::vector<std::uint8_t> decode(const nlohmann::json& segmentation) {
  const std::size_t height = segmentation["size"][0], width = segmentation["size"][1];
  std::vector<std::uint8_t> pixels(width * height);
  std::size_t at = 0;
  bool on = false;
  for (const std::size_t run : segmentation["counts"]) {
    for (std::size_t i = 0; i < run; ++i, ++at) {
      EXPECT_LT(at, pixels.size());
      pixels[at % height * width + at / height] = on ? 255 : 0;
    }
    on = !on;
  }
  EXPECT_EQ(at, pixels.size());
  return pixels;
}

class Coco : public testing::Test {
 protected:
  nlohmann::json read(const char* name) const {
    return nlohmann::json::parse(test::read_bytes(folder_ / name));
  }
  static std::vector<std::vector<std::uint8_t>> masks() {
    std::vector<std::vector<std::uint8_t>> masks{std::vector<std::uint8_t>(15, 0),
                                                 std::vector<std::uint8_t>(15, 255)};
    for (std::size_t i = 0; i < 15; ++i) {
      masks.push_back(masks[0]);
      masks.back()[i] = 255;
    }
    return masks;
  }
  test::TempDir folder_;
};

TEST_F(Coco, WritesResultsWhoseMasksReadBack) {
  std::vector<CocoResult> results;
  for (const auto& mask : masks())
    results.push_back({1, 20, 3, 0.25, {0, 1, 4, 2}, encode_coco_mask(mask, 5), 0.5});
  ASSERT_TRUE(write_coco_results(folder_ / "r.json", results));
  const nlohmann::json read_back = read("r.json");
  ASSERT_EQ(read_back.size(), results.size());
  for (std::size_t i = 0; i < results.size(); ++i) {
    const nlohmann::json& one = read_back[i];
    EXPECT_EQ(one["scene_id"], 1);
    EXPECT_EQ(one["image_id"], 20);
    EXPECT_EQ(one["category_id"], 3);
    EXPECT_EQ(one["score"], 0.25);
    EXPECT_EQ(one["bbox"], nlohmann::json({0, 1, 4, 2}));
    EXPECT_EQ(one["time"], 0.5);
    EXPECT_EQ(one["segmentation"]["size"], nlohmann::json({3, 5}));
    EXPECT_EQ(decode(one["segmentation"]), masks()[i]);
  }
  ASSERT_TRUE(write_coco_results(folder_ / "none.json", {}));
  EXPECT_EQ(read("none.json"), nlohmann::json::array());
}

TEST_F(Coco, BeginsTheRunsWithWhatIsOff) {
  EXPECT_EQ(encode_coco_mask(masks()[0], 5).counts, std::vector<std::uint32_t>({15}));
  EXPECT_EQ(encode_coco_mask(masks()[1], 5).counts, std::vector<std::uint32_t>({0, 15}));
  const CocoMask mask = encode_coco_mask(masks()[3], 5);  // the second pixel of the first row
  EXPECT_EQ(mask.counts, std::vector<std::uint32_t>({3, 1, 11}));
  EXPECT_EQ(mask.num_pixels, 1U);
}

TEST_F(Coco, WritesTheTruthOfAScene) {
  const std::vector<CocoImage> images{{7,
                                       "depth/000007.png",
                                       5,
                                       3,
                                       {{2, {0, 0, 5, 3}, encode_coco_mask(masks()[1], 5), false},
                                        {4, {0, 0, 1, 1}, encode_coco_mask(masks()[0], 5), true},
                                        {4, {0, 0, 1, 1}, encode_coco_mask(masks()[2], 5), true}}}};
  ASSERT_TRUE(write_coco_truth(folder_ / "t.json", std::vector{2, 4}, images));
  const nlohmann::json document = read("t.json");
  EXPECT_EQ(document["categories"][1]["id"], 4);
  EXPECT_EQ(document["images"][0]["id"], 7);
  EXPECT_EQ(document["images"][0]["width"], 5);
  const nlohmann::json& annotations = document["annotations"];
  ASSERT_EQ(annotations.size(), 2U) << "nothing is seen of the second";
  EXPECT_EQ(annotations[0]["area"], 15);
  EXPECT_EQ(annotations[1]["id"], 2);
  EXPECT_EQ(annotations[1]["category_id"], 4);
  EXPECT_EQ(annotations[1]["ignore"], true);
  EXPECT_EQ(decode(annotations[1]["segmentation"]), masks()[2]);
}

}  // namespace
}  // namespace trivet

#include <array>

#include "engine/simulation/parts/design.hpp"

namespace trivet::engine::parts {

std::span<const Family> families() {
  static constexpr std::array<Family, 24> kFamilies{{
      {"bracket", bracket, 0, 0.06F, 0.2F, false, false},
      {"hex_nut", hex_nut, 1, 0.02F, 0.06F, true, false},
      {"lever", lever, 2, 0.06F, 0.2F, false, false},
      {"elbow", elbow, 3, 0.06F, 0.18F, false, false},
      {"flange", flange, 4, 0.06F, 0.2F, true, false},
      {"housing", housing, 5, 0.08F, 0.2F, false, false},
      {"tee", tee, 6, 0.06F, 0.18F, false, false},
      {"bolt", bolt, 7, 0.03F, 0.12F, true, false},
      {"gear", gear, 8, 0.04F, 0.15F, true, false},
      {"clamp_left", clamp, 9, 0.06F, 0.16F, false, false},
      {"clamp_right", clamp, 9, 0.06F, 0.16F, false, true},
      {"washer", washer, 10, 0.02F, 0.08F, true, false},
      {"knob", knob, 11, 0.03F, 0.1F, false, false},
      {"shaft", shaft, 12, 0.06F, 0.2F, true, false},
      {"plate", plate, 13, 0.05F, 0.16F, false, false},
      {"drill_plate", drill_plate, 13, 0.05F, 0.16F, false, false},
      {"yoke", yoke, 14, 0.04F, 0.14F, true, false},
      {"angle_left", angle, 15, 0.05F, 0.16F, false, false},
      {"angle_right", angle, 15, 0.05F, 0.16F, false, true},
      {"bushing", bushing, 16, 0.02F, 0.08F, true, false},
      {"keyed_gear", keyed_gear, 17, 0.04F, 0.15F, true, false},
      {"street_elbow", street_elbow, 18, 0.05F, 0.15F, false, false},
      {"ratchet", ratchet, 19, 0.04F, 0.14F, true, false},
      {"v_block", v_block, 20, 0.05F, 0.14F, true, false},
  }};
  return kFamilies;
}

std::span<const Family> other_families() {
  static constexpr std::array<Family, 23> kFamilies{{
      {"cup", cup, 32, 0.08F, 0.15F, false, false},
      {"carton", carton, 33, 0.08F, 0.3F, false, false},
      {"bottle", bottle, 34, 0.12F, 0.3F, false, false},
      {"mug", mug, 35, 0.09F, 0.16F, false, false},
      {"can", can, 36, 0.07F, 0.17F, false, false},
      {"bowl", bowl, 37, 0.12F, 0.22F, false, false},
      {"flask", flask, 38, 0.12F, 0.26F, false, false},
      {"marker", marker, 39, 0.1F, 0.15F, false, false},
      {"drink_can", drink_can, 40, 0.11F, 0.18F, true, false},
      {"screwdriver", screwdriver, 41, 0.12F, 0.25F, false, false},
      {"tub", tub, 42, 0.08F, 0.2F, false, false},
      {"spray", spray, 43, 0.18F, 0.28F, false, false},
      {"hammer", hammer, 44, 0.2F, 0.33F, false, false},
      {"dish", dish, 45, 0.15F, 0.27F, false, false},
      {"sheet", sheet, 64, 0.06F, 0.16F, true, false},
      {"sheet_angle", sheet_angle, 65, 0.06F, 0.16F, true, false},
      {"sheet_channel", sheet_channel, 66, 0.06F, 0.16F, true, false},
      {"cut_block", cut_block, 67, 0.06F, 0.2F, false, false},
      {"drilled_block", drilled_block, 67, 0.06F, 0.2F, false, false},
      {"tray", tray, 68, 0.1F, 0.3F, false, false},
      {"cover", cover, 69, 0.1F, 0.3F, false, false},
      {"cap_screw", cap_screw, 70, 0.03F, 0.1F, true, false},
      {"pin", pin, 71, 0.03F, 0.1F, true, false},
  }};
  return kFamilies;
}

std::span<const Group> groups() {
  using Names = std::string_view;
  static constexpr std::array<Names, 14> kHousehold{
      "cup",    "carton",    "bottle",      "mug", "can",   "bowl",   "flask",
      "marker", "drink_can", "screwdriver", "tub", "spray", "hammer", "dish"};
  static constexpr std::array<Names, 3> kSheets{"sheet", "sheet_angle", "sheet_channel"};
  static constexpr std::array<Names, 4> kBoxes{"cut_block", "drilled_block", "tray", "cover"};
  static constexpr std::array<Names, 6> kFasteners{"bolt",    "cap_screw", "pin",
                                                   "hex_nut", "washer",    "bushing"};
  static constexpr std::array<Group, 4> kGroups{{{"household", kHousehold},
                                                 {"sheets", kSheets},
                                                 {"boxes", kBoxes},
                                                 {"fasteners", kFasteners}}};
  return kGroups;
}

}  // namespace trivet::engine::parts

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

std::span<const Family> household_families() {
  static constexpr std::array<Family, 14> kFamilies{{
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
  }};
  return kFamilies;
}

}  // namespace trivet::engine::parts

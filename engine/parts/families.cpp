#include <array>

#include "engine/parts/design.hpp"

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

}  // namespace trivet::engine::parts

/// Input of untrusted clients as functions that accept any bytes: for fuzzers, and for the ordinary
/// tests, which replay seeds and past findings.
#pragma once

#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace trivet::fuzz {

/// A violated guarantee of the code under test.
struct Broken : std::logic_error {
  using std::logic_error::logic_error;
};
inline void require(bool holds, const std::string& promise) {
  if (!holds) throw Broken(promise);
}

void parse_target(std::string_view input);
/// The header; then, if there are tensors, a zero byte and the tensors.
void parse_inference(std::string_view input);
/// The content type, a line feed, then the body.
void split_form(std::string_view input);
/// A digit for the format, then the body.
void read_scan(std::string_view input);
/// A digit for the format, a letter for the other options, then the body.
void recognize_scene(std::string_view input);
/// A letter for the coding, then the compressed body.
void unpack(std::string_view input);
/// Parameters, or the JSON of a form's options.
void parse_query(std::string_view input);

struct Target {
  const char* name;
  void (*run)(std::string_view input);
  std::vector<std::string> (*seeds)();  ///< small valid inputs to start from
};

std::vector<std::string> parse_target_seeds();
std::vector<std::string> parse_inference_seeds();
std::vector<std::string> split_form_seeds();
std::vector<std::string> read_scan_seeds();
std::vector<std::string> recognize_scene_seeds();
std::vector<std::string> parse_query_seeds();
std::vector<std::string> unpack_seeds();

inline constexpr std::array kTargets{
    Target{"parse_target", parse_target, parse_target_seeds},
    Target{"parse_inference", parse_inference, parse_inference_seeds},
    Target{"split_form", split_form, split_form_seeds},
    Target{"read_scan", read_scan, read_scan_seeds},
    Target{"recognize_scene", recognize_scene, recognize_scene_seeds},
    Target{"parse_query", parse_query, parse_query_seeds},
    Target{"unpack", unpack, unpack_seeds},
};

}  // namespace trivet::fuzz

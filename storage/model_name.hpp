/// What models are called in libraries, manifests, results and on the command line.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace trivet {

/// What a model may be called, in words.
inline constexpr std::string_view kModelNameRule =
    "a letter or digit, then at most 127 letters, digits, dots, dashes and underscores, without "
    "'..'";

/// [A-Za-z0-9][A-Za-z0-9._-]{0,127} without "..".
bool is_model_name(std::string_view name) noexcept;

/// The name of a model from that of its file, without folder and extension. What is no name is made
/// one: each run of other characters becomes an underscore, each run of dots a dot; what is no
/// letter or digit goes from both ends, and what is beyond 128; "model" where nothing is left.
std::string model_name_of(const std::filesystem::path& file);

}  // namespace trivet

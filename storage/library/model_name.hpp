/// What models are called in libraries, manifests, results and on the command line.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace trivet {

/// What a model may be called, in words.
inline constexpr std::string_view kModelNameRule =
    "letters and digits of any script, dots, dashes and underscores, at most 128 bytes of UTF-8, "
    "with "
    "a letter or digit first and without '..'";

/// [A-Za-z0-9._-] and what UTF-8 has beyond ASCII, but for controls, blanks, marks that reorder text,
/// and what stands for no character; 1 to 128 bytes, the first none of "._-", without "..". Names are
/// the same where their bytes are.
bool is_model_name(std::string_view name);

/// The name of a model from that of its file, without folder and extension, in Unicode's normal form
/// C, so that it is the same from all file systems. What is no name is made one: each run of other characters becomes an underscore, each run of dots a dot; dots, dashes and
/// underscores go from both ends, and what is beyond 128 bytes; "model" where nothing is left.
std::string model_name_of(const std::filesystem::path& file);

}  // namespace trivet

/// Words that clients without a proxy show to be let in.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "storage/common/result.hpp"

namespace trivet::apps::service {

/// What a file of tokens holds.
struct TokenFile {
  std::vector<std::string> tokens;     ///< one at least
  bool is_readable_by_others = false;  ///< than its owner and group
};

/// One token a line, of letters, digits and -._~+/= (RFC 6750, 2.1); blank lines and those that
/// begin with # are left out. A message never tells a token. Errors: missing_input, io, bad_data
/// (no token, or a line that is none).
Result<TokenFile> read_token_file(const std::filesystem::path& file);

/// All members may be called from any thread.
class BearerTokens {
 public:
  /// Those that are taken from now on.
  void set(std::vector<std::string> tokens);
  /// Whether a header Authorization has one of them. The time tells nothing but the tokens' lengths.
  bool allow(std::string_view authorization) const;

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> tokens_;
};

}  // namespace trivet::apps::service

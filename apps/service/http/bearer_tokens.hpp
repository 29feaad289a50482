/// Bearer tokens: they admit clients that do not come through a proxy.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "storage/common/result.hpp"

namespace trivet::apps::service {

/// Contents of a token file.
struct TokenFile {
  std::vector<std::string> tokens;     ///< at least one
  bool is_readable_by_others = false;  ///< by others than its owner and group
};

/// Reads one token per line, of letters, digits and -._~+/= (RFC 6750, 2.1). Blank lines and lines
/// that begin with # are skipped. Messages never contain a token.
/// Errors: missing_input, io, bad_data (no token, or an invalid line).
Result<TokenFile> read_token_file(const std::filesystem::path& file);

/// All members may be called from any thread.
class BearerTokens {
 public:
  /// Replaces the accepted tokens.
  void set(std::vector<std::string> tokens);
  /// Whether an Authorization header contains an accepted token. The time depends on nothing but
  /// the lengths of the tokens.
  bool allow(std::string_view authorization) const;

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> tokens_;
};

}  // namespace trivet::apps::service

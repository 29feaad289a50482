#include "apps/service/http/bearer_tokens.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "storage/files/errno_text.hpp"
#include "storage/files/file.hpp"
#include "storage/files/text.hpp"

namespace trivet::apps::service {
namespace {

constexpr std::uint64_t kMaxTokenFile = 1 << 20;

bool is_token(std::string_view text) {
  return std::ranges::all_of(text, [](char c) {
    return formats::is_alphanumeric(c) ||
           std::string_view("-._~+/=").find(c) != std::string_view::npos;
  });
}

std::string_view without_blanks(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Compares in constant time: reads every character of the given token, whichever differs first.
bool is_same(std::string_view given, std::string_view token) {
  unsigned differ = given.size() == token.size() ? 0 : 1;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const char other = token[i % token.size()];
    differ |= static_cast<unsigned char>(given[i]) ^ static_cast<unsigned char>(other);
  }
  return differ == 0;
}

}  // namespace

Result<TokenFile> read_token_file(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) {
    return Error{ErrorCode::missing_input,
                 fmt::format("{}: cannot be read: {}", file.string(), errno_text())};
  }
  struct stat found {};
  const bool is_known = ::fstat(descriptor, &found) == 0;
  const Result<std::vector<std::byte>> bytes = read_all(descriptor, file.string(), kMaxTokenFile);
  ::close(descriptor);
  if (!bytes) return bytes.error();
  TokenFile out;
  out.is_readable_by_others = is_known && (found.st_mode & S_IROTH) != 0;
  std::string_view rest(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = without_blanks(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (line.empty() || line.front() == '#') continue;
    if (!is_token(line)) {
      return Error{ErrorCode::bad_data,
                   fmt::format("{}:{}: expected a token of letters, digits and -._~+/=, found "
                               "other characters",
                               file.string(), number)};
    }
    out.tokens.emplace_back(line);
  }
  if (out.tokens.empty()) {
    return Error{ErrorCode::bad_data,
                 fmt::format("{}: expected a token a line, found none; `openssl rand -hex 32` "
                             "makes one",
                             file.string())};
  }
  return out;
}

void BearerTokens::set(std::vector<std::string> tokens) {
  const std::lock_guard lock(mutex_);
  tokens_ = std::move(tokens);
}

bool BearerTokens::allow(std::string_view authorization) const {
  constexpr std::string_view kScheme = "bearer ";
  const bool is_bearer = authorization.size() > kScheme.size() &&
                         formats::lower_case(authorization.substr(0, kScheme.size())) == kScheme;
  if (!is_bearer) return false;
  const std::string_view given = without_blanks(authorization.substr(kScheme.size()));
  if (given.empty()) return false;
  const std::lock_guard lock(mutex_);
  bool is_one = false;
  for (const std::string& token : tokens_) is_one |= is_same(given, token);
  return is_one;
}

}  // namespace trivet::apps::service

/// Access control: which requests the service answers. Checked before a body is read.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/service/http/bearer_tokens.hpp"
#include "apps/service/http/http_server.hpp"
#include "storage/common/result.hpp"

namespace trivet::apps::service {

/// Why a request is refused. Metrics and logs have one word for each fault.
enum class AccessFault : std::uint8_t { path, host, origin, page, token, read_only };
inline constexpr std::array<std::string_view, 6> kAccessFaults{"path", "host",  "origin",
                                                               "page", "token", "read_only"};
constexpr std::string_view name_of(AccessFault fault) {
  return kAccessFaults[static_cast<std::size_t>(fault)];
}

struct AccessRefusal {
  AccessFault fault;
  unsigned status;
  std::string reason;  ///< sentence for the client

  HttpResponse response() const;
};

/// The header that the page of the service sends with every request. No other page can send it: the
/// browser would first send a preflight request (Fetch, "CORS-preflight request"), which is
/// refused.
inline constexpr std::string_view kPageHeader = "x-trivet", kPageWord = "page";

/// Normalizes a name or address of a Host header: in lower case, without a dot at its end.
/// Errors: usage (a scheme, a port, or characters that no name has).
Result<std::string> parse_host_name(std::string_view text);

class Access {
 public:
  /// host_names  names that are served beside those of loopback and the address of the connection,
  ///             as returned by parse_host_name
  /// tokens      tokens of which every request that is not free must show one; null: no token is
  ///             required
  Access(std::vector<std::string> host_names, const BearerTokens* tokens)
      : host_names_(std::move(host_names)), tokens_(tokens) {}

  /// Checks the head of a request, before its body is read. Returns the refusal; none: go on.
  ///
  /// * The path must be unambiguous (see check_path), so that the service answers the path that a
  ///   proxy has checked.
  /// * The host must be one that is served. After DNS rebinding, the name of a foreign page is not.
  /// * A request that may change something comes from the service's page or from no page.
  /// * The request shows a token, unless it `is_free`.
  std::optional<AccessRefusal> refuse(const HttpRequest& head, bool is_free) const;

 private:
  bool is_served(std::string_view host, const std::string& local_address) const;
  std::optional<AccessRefusal> refuse_host(const HttpRequest& head) const;

  const std::vector<std::string> host_names_;
  const BearerTokens* const tokens_;
};

}  // namespace trivet::apps::service

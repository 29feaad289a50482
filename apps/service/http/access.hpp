/// Whom a service answers: looked at before a body is read.
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

/// Why a request is refused, a word each for metrics and logs.
enum class AccessFault : std::uint8_t { path, host, origin, page, token, read_only };
inline constexpr std::array<std::string_view, 6> kAccessFaults{"path", "host",  "origin",
                                                               "page", "token", "read_only"};
constexpr std::string_view name_of(AccessFault fault) {
  return kAccessFaults[static_cast<std::size_t>(fault)];
}

struct AccessRefusal {
  AccessFault fault;
  unsigned status;
  std::string reason;  ///< a sentence for who asked

  HttpResponse response() const;
};

/// What the page of the service sends with all that it asks. No page elsewhere can: a browser would
/// ask first whether it may (Fetch, "CORS-preflight request"), and is refused.
inline constexpr std::string_view kPageHeader = "x-trivet", kPageWord = "page";

/// A name or address as a Host header has it, in lower case, without a dot at its end. Errors: usage
/// (a scheme, a port, or characters that no name has).
Result<std::string> parse_host_name(std::string_view text);

class Access {
 public:
  /// host_names  that are served beside those of loopback and the address that a connection came in
  ///             on, as parse_host_name gives them
  /// tokens      one of which all must show that is not free; null: nobody is asked for one
  Access(std::vector<std::string> host_names, const BearerTokens* tokens)
      : host_names_(std::move(host_names)), tokens_(tokens) {}

  /// Look at a request without its body; none: it may be answered.
  ///
  /// * Its path says all in one way: see check_path. So what a proxy sees is what is answered.
  /// * Its host is one that is served: after DNS rebinding, the name of a foreign page is not.
  /// * What may change something comes from the service's own page or from no page.
  /// * It shows a token, unless it `is_free`.
  std::optional<AccessRefusal> refuse(const HttpRequest& head, bool is_free) const;

 private:
  bool is_served(std::string_view host, const std::string& local_address) const;
  std::optional<AccessRefusal> refuse_host(const HttpRequest& head) const;

  const std::vector<std::string> host_names_;
  const BearerTokens* const tokens_;
};

}  // namespace trivet::apps::service

#include "apps/service/http/access.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/ip/address.hpp>
#include <utility>

#include "apps/service/http/http_messages.hpp"
#include "apps/service/http/query.hpp"
#include "storage/files/text.hpp"

namespace trivet::apps::service {
namespace {

constexpr std::size_t kMaxHostSize = 255, kMaxShownHost = 100;

/// The address in comparable form; none: the text is a name.
std::optional<boost::asio::ip::address> address_of(const std::string& text) {
  boost::system::error_code error;
  boost::asio::ip::address address = boost::asio::ip::make_address(text, error);
  if (error) return std::nullopt;
  if (!address.is_v6()) return address;
  boost::asio::ip::address_v6 six = address.to_v6();
  if (six.is_v4_mapped()) return make_address_v4(boost::asio::ip::v4_mapped, six);
  six.scope_id(0);  // the zone is the interface, which no client of this service knows
  return six;
}

/// The host of HOST, HOST:PORT, [ADDRESS] or [ADDRESS]:PORT, with the brackets; none: another form.
std::optional<std::string_view> without_port(std::string_view host) {
  const std::size_t bracket = host.starts_with('[') ? host.find(']') : 0;
  if (bracket == std::string_view::npos) return std::nullopt;
  const std::size_t colon = host.find(':', bracket);
  const std::string_view port = host.substr(std::min(colon, host.size()));
  const bool is_port =
      port.size() <= 6 && std::ranges::all_of(port.substr(std::min<std::size_t>(1, port.size())),
                                              [](char c) { return c >= '0' && c <= '9'; });
  if (!is_port) return std::nullopt;
  return host.substr(0, colon);
}

/// Removes the default port, which browsers omit from an origin and some clients do not omit from a
/// host.
std::string_view without_usual_port(std::string_view host, std::string_view scheme) {
  const std::string_view port = scheme == "https" ? ":443" : ":80";
  if (host.ends_with(port)) host.remove_suffix(port.size());
  return host;
}

/// Whether an origin belongs to a page that was served by this host.
bool is_origin_of(const std::string& origin, const std::string& host) {
  for (const std::string_view scheme : {"http", "https"}) {
    const std::string front = fmt::format("{}://", scheme);
    if (!origin.starts_with(front)) continue;
    return without_usual_port(std::string_view(origin).substr(front.size()), scheme) ==
           without_usual_port(host, scheme);
  }
  return false;
}

bool only_reads(const HttpRequest& head) {
  return head.method == "GET" || head.method == "HEAD" || head.method == "OPTIONS";
}

/// Refuses foreign pages, for requests that change something or cost more than a read.
std::optional<AccessRefusal> refuse_foreign_page(const HttpRequest& head) {
  const std::string origin = formats::lower_case(head.header("origin"));
  const std::string host =
      formats::lower_case(head.named_host.empty() ? head.header("host") : head.named_host);
  const std::string site = formats::lower_case(head.header("sec-fetch-site"));
  const bool is_foreign = (!origin.empty() && !is_origin_of(origin, host)) ||
                          site == "cross-site" || site == "same-site";
  if (is_foreign) {
    return AccessRefusal{
        AccessFault::origin, 403,
        fmt::format("Origin: expected that of the service's own page at '{}', found '{}'; pages "
                    "elsewhere may not ask for this",
                    host.substr(0, kMaxShownHost),
                    (origin.empty() ? site : origin).substr(0, kMaxShownHost))};
  }
  const bool is_of_page = !origin.empty() || !site.empty();
  if (is_of_page && head.header(kPageHeader) != kPageWord) {
    return AccessRefusal{
        AccessFault::page, 403,
        "expected the header X-Trivet: page, which browsers let only the service's "
        "own page send, found none"};
  }
  return std::nullopt;
}

}  // namespace

HttpResponse AccessRefusal::response() const {
  HttpResponse out = error_response(status, reason);
  if (fault == AccessFault::token)
    out.headers.emplace_back("WWW-Authenticate", "Bearer realm=\"trivet\"");
  return out;
}

Result<std::string> parse_host_name(std::string_view text) {
  std::string name = formats::lower_case(text);
  if (name.starts_with('[') && name.ends_with(']')) name = name.substr(1, name.size() - 2);
  if (const auto address = address_of(name)) return address->to_string();
  if (name.ends_with('.')) name.pop_back();
  const bool is_name =
      !name.empty() && name.size() <= kMaxHostSize && std::ranges::all_of(name, [](char c) {
        return formats::is_alphanumeric(c) || c == '-' || c == '.' || c == '_';
      });
  if (is_name) return name;
  return Error{ErrorCode::usage,
               fmt::format("host-name: expected a name or an IP address, as cell.example, without "
                           "scheme and port, found '{}'",
                           text.substr(0, kMaxShownHost))};
}

bool Access::is_served(std::string_view host, const std::string& local_address) const {
  const std::optional<std::string_view> named = without_port(host);
  if (!named) return false;
  const Result<std::string> name = parse_host_name(*named);
  if (!name) return false;
  if (*name == "localhost" || std::ranges::count(host_names_, *name) > 0) return true;
  // A foreign page's host is always a name. A client that gives an address has connected to it.
  const auto address = address_of(*name);
  return address && (address->is_loopback() || address == address_of(local_address));
}

std::optional<AccessRefusal> Access::refuse_host(const HttpRequest& head) const {
  for (const std::string& host : {head.named_host, head.header("host")}) {
    // Without a Host header, DNS rebinding is impossible: probes that speak HTTP/1.0 send none.
    if (host.empty() || is_served(host, head.local_address)) continue;
    return AccessRefusal{
        AccessFault::host, 421,
        fmt::format(
            "Host: expected localhost, the address that the service was asked at, or a name "
            "that --host-name gives, found '{}'",
            host.substr(0, kMaxShownHost))};
  }
  return std::nullopt;
}

std::optional<AccessRefusal> Access::refuse(const HttpRequest& head, bool is_free) const {
  if (const Result<void> good = check_path(head.target); !good)
    return AccessRefusal{AccessFault::path, 400, good.error().message};
  if (auto refused = refuse_host(head)) return refused;
  if (!only_reads(head)) {
    if (auto refused = refuse_foreign_page(head)) return refused;
  }
  if (tokens_ && !is_free && !tokens_->allow(head.header("authorization"))) {
    return AccessRefusal{AccessFault::token, 401,
                         "expected a token of the service's --token-file, as Authorization: Bearer "
                         "TOKEN"};
  }
  return std::nullopt;
}

}  // namespace trivet::apps::service

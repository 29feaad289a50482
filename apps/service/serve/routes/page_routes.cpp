#include "apps/service/serve/routes/page_routes.hpp"

#include <functional>
#include <string>

#include "apps/service/http/http_messages.hpp"
#include "apps/service/serve/routes/openapi.hpp"
#include "apps/service/serve/routes/page.hpp"
#include "apps/service/serve/routes/word_table.hpp"

namespace trivet::apps::service {

Routes PageRoutes::routes() const {
  using std::bind_front;
  return {
      {"GET", "/v1/openapi.json", false, false, Effect::reads, "openapi",
       bind_front(&PageRoutes::openapi, this)},
      {"GET", "/v1/words", false, false, Effect::reads, "words",
       bind_front(&PageRoutes::words, this)},
      {"GET", "/", true, false, Effect::reads, "page", bind_front(&PageRoutes::page, this)},
  };
}

void PageRoutes::openapi(const CallPtr& call, std::string_view) const {
  responder_.reply(call, {200, std::string(openapi_document()), "application/json", {}});
}

void PageRoutes::words(const CallPtr& call, std::string_view) const {
  responder_.reply(call, json_response(200, word_table()));
}

void PageRoutes::page(const CallPtr& call, std::string_view rest) const {
  const PageFile* const file = find_page_file(rest.empty() ? "index.html" : rest);
  if (!file && rest.empty()) return responder_.reply(call, no_page_response(call->request));
  if (!file) return responder_.reply(call, error_response(404, "no such path"));
  responder_.reply(call, {200,
                          std::string(file->bytes),
                          std::string(file->content_type),
                          {{"Content-Security-Policy",
                            "default-src 'self'; img-src 'self' data: blob:; style-src 'self'; "
                            "frame-ancestors 'none'"},
                           {"X-Content-Type-Options", "nosniff"},
                           {"Cache-Control", "no-cache"}}});
}

}  // namespace trivet::apps::service

#include "apps/service/serve/routes/example_routes.hpp"

#include <fmt/format.h>

#include <functional>
#include <optional>

#include "apps/service/http/file_response.hpp"
#include "apps/service/http/http_messages.hpp"

namespace trivet::apps::service {

Routes ExampleRoutes::routes() const {
  using std::bind_front;
  return {
      {"GET", "/v1/examples", true, false, Effect::reads, "examples",
       bind_front(&ExampleRoutes::view, this)},
  };
}

void ExampleRoutes::view(const CallPtr& call, std::string_view rest) const {
  if (rest.empty()) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < examples_.size(); ++i) {
      list.push_back({{"name", examples_[i].name},
                      {"query", examples_[i].query},
                      {"url", fmt::format("/v1/examples/{}", i)}});
    }
    return responder_.reply(call, json_response(200, {{"examples", std::move(list)}}));
  }
  const std::optional<std::size_t> index = whole_number(rest.substr(1));
  if (rest.front() != '/' || !index || *index >= examples_.size())
    return responder_.reply(call, error_response(404, "no such example"));
  responder_.reply(call, file_response(examples_[*index].file));
}

}  // namespace trivet::apps::service

// The options of a recognition, as query parameters or as a JSON object.
#include "apps/service/http/json_parameters.hpp"
#include "apps/service/serve/requests/recognize_query.hpp"
#include "fuzz/targets.hpp"

namespace trivet::fuzz {

void parse_query(std::string_view input) {
  apps::service::Parameters parameters;
  if (input.starts_with('{')) {
    const Result<void> read = with_json(
        std::as_bytes(std::span(input)), "options",
        [&](const JsonNode& root) { parameters = apps::service::parameters_of(root.object()); });
    if (!read) return require(read.error().code == ErrorCode::bad_data, "faults are the client's");
  } else {
    Result<apps::service::Target> target = apps::service::parse_target("/?" + std::string(input));
    if (!target) return;
    parameters = std::move(target->parameters);
  }
  const Result<apps::service::RecognizeQuery> query =
      apps::service::parse_recognize_query(parameters);
  if (!query) {
    require(query.error().code == ErrorCode::usage, "faults are the client's");
    return require(!query.error().message.empty(), "there is a reason");
  }
  require(validate(query->options).has_value(), "what is taken is valid");
  require(query->options.expected.empty(), "no file is read");
}

std::vector<std::string> parse_query_seeds() {
  return {"method=ppf&preset=fast&min-score=0.5&max-instances=3&unit=mm",
          "camera=525,525,319.5,239.5,0.001&viewpoint=0,0,1&rejected=5",
          "models=a,b&region=0,0,0,1,1,1&tilt=0,0,1,0,0,1,20&ablate=rays,correlated-noise&rounds=1",
          "keypoints=iss&grouping=ransac&max-ratio=0.9&weigh-by-ratio=true&max-lean=0.15",
          R"({"camera":{"fx":1,"fy":1,"cx":0,"cy":0},"viewpoint":[0,0,1],"require-pose":true})"};
}

}  // namespace trivet::fuzz

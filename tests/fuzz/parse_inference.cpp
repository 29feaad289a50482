// A request of the Open Inference Protocol: JSON, then binary tensors.
#include <nlohmann/json.hpp>

#include "apps/service/serve/inference/protocol.hpp"
#include "fuzz/targets.hpp"

namespace trivet::fuzz {

void parse_inference(std::string_view input) {
  const std::size_t zero = input.find('\0');
  std::optional<std::size_t> header_size;
  std::string body(input);
  if (zero != input.npos) {
    header_size = zero;
    body.erase(zero, 1);
  }
  (void)apps::service::inference_timeout(body.substr(0, header_size.value_or(body.size())));
  const Result<apps::service::InferenceRequest> request =
      apps::service::parse_inference(body, header_size);
  if (!request) {
    require(request.error().code == ErrorCode::bad_data,
            "faults are the client's, and no count is believed that the body cannot hold");
    return;
  }
  require(request->points.size() <= body.size() / 6, "each number takes a byte and a comma");
  const apps::service::InferenceResponse response =
      apps::service::write_inference(*request, {}, "library", 1);
  require(nlohmann::json::accept(response.body.substr(0, response.header_size)),
          "whatever was asked, the answer is JSON");
}

std::vector<std::string> parse_inference_seeds() {
  const std::string point = R"({"name":"points","datatype":"FP32","shape":[1,3],)";
  const std::string packed = R"("parameters":{"binary_data_size":12}})";
  const std::string zeros(12, '\0');
  return {R"({"id":"7","parameters":{"method":"ppf","min-score":0.5,"weigh-by-ratio":true},)"
          R"("inputs":[)" +
              point + R"("data":[[1,2.5,-3e2]]},)" +
              R"({"name":"viewpoint","datatype":"FP32","shape":[3],"data":[0,0,1]}]})",
          R"({"parameters":{"binary_data_output":true},"inputs":[)" + point + packed + "]}" +
              std::string(1, '\0') + zeros,
          R"({"parameters":{"timeout":1000,"priority":1,"sequence_id":"a","sequence_end":true},)"
          R"("outputs":[{"name":"poses","parameters":{"binary_data":true}},{"name":"models"}],)"
          R"("inputs":[)" +
              point + packed + "]}" + std::string(1, '\0') + zeros,
          R"({"inputs":[],"outputs":[{"name":"poses","parameters":{"binary_data":true}}]})"};
}

}  // namespace trivet::fuzz

// The description of the service for programs is what the service does.
#include "apps/service/serve/openapi.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "apps/service/serve/recognize_query.hpp"
#include "apps/service/serve_fixture.hpp"

namespace trivet {
namespace {

const std::string kSources = TRIVET_SOURCES;

TEST(OpenApi, NamesTheParametersThatAreTaken) {
  const nlohmann::json document = nlohmann::json::parse(apps::service::openapi_document());
  std::set<std::string> described;
  for (const nlohmann::json& parameter : document["paths"]["/v1/recognize"]["post"]["parameters"]) {
    const std::string name = parameter["$ref"].get<std::string>().substr(24);
    const nlohmann::json& full = document["components"]["parameters"][name];
    EXPECT_EQ(full["name"], name);
    if (full["in"] == "query") described.insert(name);
  }
  EXPECT_TRUE(described.erase("format")) << "which chooses the reader";
  for (const std::string& name : described) {
    const auto query = apps::service::parse_recognize_query({{name, "?"}});
    if (query) continue;  // a name that may be any
    EXPECT_EQ(query.error().message.rfind(name + ": expected", 0), 0U) << query.error().message;
  }
  EXPECT_FALSE(apps::service::parse_recognize_query({{"expected", "file.json"}}));
}

TEST(RecognizeQuery, AsksForTheVeryPoseOnlyIfItIsTold) {
  for (const auto& [value, required] : {std::pair{"", true}, {"true", true}, {"false", false}}) {
    const auto query = apps::service::parse_recognize_query({{"require-pose", value}});
    ASSERT_TRUE(query) << query.error().message;
    EXPECT_EQ(query->options.require_pose, required) << value;
  }
  EXPECT_FALSE(apps::service::parse_recognize_query({})->options.require_pose);
  EXPECT_FALSE(apps::service::parse_recognize_query({{"require-pose", "perhaps"}}));
}

TEST(OpenApi, GivesDefaultsAndChoicesThatAreTaken) {
  const nlohmann::json document = nlohmann::json::parse(apps::service::openapi_document());
  const auto text = [](const nlohmann::json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
  };
  for (const auto& [name, parameter] : document["components"]["parameters"].items()) {
    if (parameter["in"] != "query" || name == "format" || name == "max-points") continue;
    const nlohmann::json& schema = parameter["schema"];
    std::vector<nlohmann::json> good, bad;
    for (const char* const key : {"default", "minimum", "maximum"}) {
      if (schema.contains(key)) good.push_back(schema[key]);
    }
    for (const nlohmann::json& choice : schema.value("enum", nlohmann::json::array()))
      good.push_back(choice);
    for (const nlohmann::json& choice :
         schema.value("items", nlohmann::json::object()).value("enum", nlohmann::json::array()))
      good.push_back(choice);
    if (schema.contains("minimum")) bad.push_back(schema["minimum"].get<std::int64_t>() - 1);
    if (schema.contains("maximum")) bad.push_back(schema["maximum"].get<std::int64_t>() + 1);
    if (schema.contains("exclusiveMinimum")) bad.push_back(schema["exclusiveMinimum"]);
    if (schema.contains("enum")) bad.push_back("other");
    for (const nlohmann::json& value : good) {
      const auto query = apps::service::parse_recognize_query({{name, text(value)}});
      EXPECT_TRUE(query) << name << "=" << value << ": " << query.error().message;
    }
    for (const nlohmann::json& value : bad)
      EXPECT_FALSE(apps::service::parse_recognize_query({{name, text(value)}}))
          << name << "=" << value;
  }
}

class OpenApiOfAService : public test::ServeFixture {};

TEST_F(OpenApiOfAService, IsWhatItAnswers) {
  const test::Outcome outcome = serve({"--examples", "scans/manifest.json"}, [&](int port) {
    const test::Outcome checked = test::run_program(
        TRIVET_PYTHON,
        {kSources + "/tests/apps/service/check_openapi.py", std::to_string(port), depth_,
         query_.substr(query_.find('?') + 1), kSources + "/apps/service/serve/service_routes.cpp"},
        {.folder = folder_.path(), .environment = {}, .watch = {}});
    EXPECT_EQ(checked.exit_code, 0) << checked.out << checked.error;
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

}  // namespace
}  // namespace trivet

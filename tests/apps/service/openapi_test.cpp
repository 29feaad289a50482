// The OpenAPI description of the service matches its behavior.
#include "apps/service/serve/routes/openapi.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "apps/service/serve/requests/recognize_query.hpp"
#include "apps/service/serve_fixture.hpp"

namespace trivet {
namespace {

const std::string kSources = TRIVET_SOURCES;

TEST(OpenApi, NamesTheAcceptedParameters) {
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
    if (query) continue;  // accepts any text
    EXPECT_EQ(query.error().message.rfind(name + ": expected", 0), 0U) << query.error().message;
  }
  EXPECT_FALSE(apps::service::parse_recognize_query({{"expected", "file.json"}}));
}

TEST(RecognizeQuery, RequiresThePoseOnlyOnRequest) {
  for (const auto& [value, required] : {std::pair{"", true}, {"true", true}, {"false", false}}) {
    const auto query = apps::service::parse_recognize_query({{"require-pose", value}});
    ASSERT_TRUE(query) << query.error().message;
    EXPECT_EQ(query->options.require_pose, required) << value;
  }
  EXPECT_FALSE(apps::service::parse_recognize_query({})->options.require_pose);
  EXPECT_FALSE(apps::service::parse_recognize_query({{"require-pose", "perhaps"}}));
}

TEST(RecognizeQuery, RequiresTheIdentityOnlyOnRequest) {
  const auto query = apps::service::parse_recognize_query({{"require-identity", "true"}});
  ASSERT_TRUE(query) << query.error().message;
  EXPECT_TRUE(query->options.require_identity);
  EXPECT_FALSE(apps::service::parse_recognize_query({})->options.require_identity);
}

TEST(OpenApi, GivesDefaultsAndChoicesThatAreAccepted) {
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
    // The parameters for reading a camera's image occur together with a camera.
    const bool is_of_camera = name == "depth" || name == "distortion" || name == "image-size";
    for (const nlohmann::json& value : good) {
      apps::service::Parameters parameters{{name, text(value)}};
      if (is_of_camera) parameters.emplace_back("camera", "500,500,320,240");
      const auto query = apps::service::parse_recognize_query(parameters);
      EXPECT_TRUE(query) << name << "=" << value << ": " << query.error().message;
    }
    for (const nlohmann::json& value : bad)
      EXPECT_FALSE(apps::service::parse_recognize_query({{name, text(value)}}))
          << name << "=" << value;
  }
}

/// Checks for errors that OpenAPI linters report and that break client generators.
class Linter {
 public:
  explicit Linter(const nlohmann::json& document) : document_(document) {
    check_info();
    for (const auto& [path, operations] : document["paths"].items()) {
      for (const auto& [method, operation] : operations.items())
        check_operation(method + " " + path, path, operation);
    }
    walk(document, "");
    for (const auto& [kind, components] : document["components"].items()) {
      for (const auto& [name, component] : components.items()) {
        const std::string pointer = "#/components/" + kind + "/" + name;
        if (!used_.contains(pointer)) fault(pointer + " is not used");
      }
    }
  }
  const std::vector<std::string>& faults() const { return faults_; }

 private:
  void fault(const std::string& what) { faults_.push_back(what); }
  static bool has_text(const nlohmann::json& node, const char* key) {
    return node.contains(key) && node[key].is_string() && !node[key].get<std::string>().empty();
  }

  void check_info() {
    const nlohmann::json& info = document_["info"];
    for (const char* const key : {"title", "version", "description"}) {
      if (!has_text(info, key)) fault(std::string("info has no ") + key);
    }
    if (!info.contains("contact")) fault("info has no contact");
    const nlohmann::json license = info.value("license", nlohmann::json::object());
    if (!has_text(license, "name") ||
        !(has_text(license, "identifier") || has_text(license, "url"))) {
      fault("info has no license with a name and an identifier");
    }
    for (const nlohmann::json& tag : document_["tags"]) {
      if (!has_text(tag, "description")) fault("a tag has no description: " + tag.dump());
      tags_.insert(tag["name"]);
    }
  }

  void check_operation(const std::string& where, const std::string& path,
                       const nlohmann::json& operation) {
    for (const char* const key : {"operationId", "summary", "description"}) {
      if (!has_text(operation, key)) fault(where + " has no " + key);
    }
    if (!ids_.insert(operation.value("operationId", "")).second)
      fault(where + " has the operationId of another");
    if (!operation.contains("security") && !document_.contains("security"))
      fault(where + " does not say what security it asks for");
    for (const nlohmann::json& tag : operation.value("tags", nlohmann::json::array())) {
      if (!tags_.contains(tag)) fault(where + " has a tag that is not declared");
    }
    std::set<char> classes;
    for (const auto& [status, response] : operation["responses"].items())
      classes.insert(status.front());
    if (!classes.contains('2') || !classes.contains('4'))
      fault(where + " has no response to a good request, or to a bad one");
    std::set<std::string> in_path, declared;
    const std::regex name("[{]([^}]+)[}]");
    for (std::sregex_iterator at(path.begin(), path.end(), name), end; at != end; ++at)
      in_path.insert((*at)[1]);
    for (nlohmann::json parameter : operation.value("parameters", nlohmann::json::array())) {
      if (parameter.contains("$ref")) parameter = resolve(parameter["$ref"]);
      if (parameter["in"] == "path") declared.insert(parameter["name"]);
    }
    if (in_path != declared) fault(where + " declares other parameters than its path has");
  }

  nlohmann::json resolve(const std::string& pointer) {
    return document_.value(nlohmann::json::json_pointer(pointer.substr(1)),
                           nlohmann::json::object());
  }

  void walk(const nlohmann::json& node, const std::string& path) {
    if (node.is_object()) {
      if (node.contains("$ref")) used_.insert(node["$ref"]);
      const nlohmann::json type = node.value("type", nlohmann::json());
      if (type == "array" && !node.contains("items")) fault(path + " is an array of anything");
      for (const nlohmann::json& name : type == "object"
                                            ? node.value("required", nlohmann::json::array())
                                            : nlohmann::json::array()) {
        if (!node.value("properties", nlohmann::json::object()).contains(name))
          fault(path + " requires what it does not describe");
      }
    }
    if (!node.is_structured()) return;
    for (const auto& [key, value] : node.items()) walk(value, path + "/" + key);
  }

  const nlohmann::json& document_;
  std::vector<std::string> faults_;
  std::set<std::string> tags_, ids_, used_;
};

TEST(OpenApi, HasNoFaultsThatLintersFind) {
  const nlohmann::json good = nlohmann::json::parse(apps::service::openapi_document());
  EXPECT_EQ(Linter(good).faults(), std::vector<std::string>());
  // The linter detects each of these errors.
  const auto finds = [&](const std::string& what, const auto& spoil) {
    nlohmann::json document = good;
    spoil(document);
    const std::vector<std::string> faults = Linter(document).faults();
    ASSERT_FALSE(faults.empty()) << what;
    EXPECT_NE(faults.front().find(what), std::string::npos) << faults.front();
  };
  using Json = nlohmann::json;
  finds("license", [](Json& d) { d["info"].erase("license"); });
  finds("contact", [](Json& d) { d["info"].erase("contact"); });
  finds("tag", [](Json& d) { d["tags"][0].erase("description"); });
  finds("security", [](Json& d) { d.erase("security"); });
  finds("get /v2 has no description",
        [](Json& d) { d["paths"]["/v2"]["get"].erase("description"); });
  finds("operationId", [](Json& d) { d["paths"]["/v2"]["get"]["operationId"] = "live"; });
  finds("bad one", [](Json& d) {
    for (const char* const status : {"400", "401", "408", "421", "431"})
      d["paths"]["/v2"]["get"]["responses"].erase(status);
  });
  finds("than its path has", [](Json& d) {
    d["paths"]["/v2/{more}"] = {{"get", d["paths"]["/v2"]["get"]}};
    d["paths"].erase("/v2");
  });
  finds("array of anything",
        [](Json& d) { d["components"]["schemas"]["Tensor"]["properties"]["data"].erase("items"); });
  finds("does not describe",
        [](Json& d) { d["components"]["schemas"]["Error"]["required"].push_back("code"); });
  finds("is not used", [](Json& d) { d["components"]["schemas"]["Other"] = {{"type", "null"}}; });
}

TEST(OpenApi, NamesTheVersionsOfALibrary) {
  const nlohmann::json paths = nlohmann::json::parse(apps::service::openapi_document())["paths"];
  for (const char* const view : {"", "/ready", "/config", "/stats", "/infer"}) {
    const nlohmann::json& plain = paths.at(std::string("/v2/models/{library}") + view);
    const nlohmann::json& version =
        paths.at(std::string("/v2/models/{library}/versions/{version}") + view);
    EXPECT_EQ(version.begin().value()["responses"], plain.begin().value()["responses"]);
  }
}

class OpenApiOfAService : public test::ServeFixture {};

TEST_F(OpenApiOfAService, IsWhatItAnswers) {
  std::filesystem::create_directory(folder_ / "in");
  const test::Outcome outcome =
      serve({"--examples", "scans/manifest.json", "--session", "cell", "--allow-training", "drafts",
             "--watch", "in", "--watch-query", parameters_},
            [&](int port) {
              const test::Outcome checked = test::run_program(
                  TRIVET_PYTHON,
                  {kSources + "/tests/apps/service/check_openapi.py", std::to_string(port), depth_,
                   query_.substr(query_.find('?') + 1), kSources + "/apps/service/serve/routes"},
                  {.folder = folder_.path(), .environment = {}, .watch = {}});
              EXPECT_EQ(checked.exit_code, 0) << checked.out << checked.error;
            });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

}  // namespace
}  // namespace trivet

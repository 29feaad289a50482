// An option is declared once; its parsing and its documentation follow from that.
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/options/recognize_arguments.hpp"
#include "apps/program.hpp"
#include "apps/report/html.hpp"
#include "apps/service/serve/requests/recognize_query.hpp"
#include "apps/service/serve/routes/openapi.hpp"
#include "apps/study/settings.hpp"
#include "storage/formats/read_cloud.hpp"
#include "storage/library/library.hpp"
#include "support/changed_option.hpp"
#include "support/rendered_scene.hpp"
#include "support/temp_dir.hpp"

namespace trivet::apps {
namespace {

template <class Options>
OptionValue changed(const Option<Options>& option) {
  return test::changed_value(option.info, option.get({}));
}

/// --NAME=VALUE with a changed value, for every option of the command line.
template <class Options>
std::vector<std::string> changed_arguments() {
  std::vector<std::string> arguments;
  for (const Option<Options>& option : options_of<Options>()) {
    if (option.info.place == OptionPlace::service_only) continue;
    arguments.push_back("--" + std::string(option.info.name) + "=" +
                        test::text_of(changed(option)));
  }
  return arguments;
}

TEST(RecognizeOption, IsSetByTheCommandLine) {
  for (const auto& option : options_of<RecognizeOptions>()) {
    if (option.info.place == OptionPlace::service_only) continue;
    RecognizeArguments arguments;
    CLI::App app;
    add_recognize_options(app, arguments);
    app.parse("--" + std::string(option.info.name) + "=" + test::text_of(changed(option)));
    const Result<RecognizeOptions> options = recognize_options(arguments);
    ASSERT_TRUE(options) << options.error().message;
    EXPECT_EQ(option.get(*options), changed(option)) << option.info.name;
  }
}

TEST(RecognizeOption, IsAParameterOfTheServiceWhichIsDescribed) {
  const nlohmann::json document = nlohmann::json::parse(service::openapi_document());
  for (const auto& option : options_of<RecognizeOptions>()) {
    const std::string name(option.info.name);
    const auto query = service::parse_recognize_query({{name, test::text_of(changed(option))}});
    ASSERT_TRUE(query) << query.error().message;
    EXPECT_EQ(option.get(query->options), changed(option)) << name;
    EXPECT_TRUE(document["components"]["parameters"].contains(name)) << name;
  }
}

TEST(RecognizeOption, IsASettingOfStudies) {
  for (const auto& option : options_of<RecognizeOptions>()) {
    const study::Setting* const setting =
        study::find_setting("recognize." + std::string(option.info.name));
    ASSERT_EQ(setting != nullptr, option.info.place == OptionPlace::anywhere) << option.info.name;
    if (!setting) continue;
    study::StudySettings settings;
    ASSERT_TRUE(setting->set(settings, changed(option))) << option.info.name;
    EXPECT_EQ(option.get(settings.recognize), changed(option)) << option.info.name;
  }
}

TEST(RecognizeOption, IsListedInReportsAndTrainOptionInLibraries) {
  const test::TempDir folder;
  const test::Shape bracket = test::bracket();
  ASSERT_TRUE(write_ply(folder / "bracket.ply", test::cloud_of(bracket)));
  const Pose pose = test::pose_of({2.1F, 0.7F, -0.4F}, {-0.02F, 0.03F, 0.85F});
  ASSERT_TRUE(write_ply(folder / "scan.ply", test::render_scan({{&bracket, pose}})));
  const auto run = [&](std::vector<std::string> arguments, const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    const test::Outcome outcome =
        test::run_trivet(arguments, {.folder = folder.path(), .environment = {}, .watch = {}});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  };
  run({"train", "bolt=bracket.ply", "-o", "library.h5"}, changed_arguments<TrainOptions>());
  const Result<Library> library = open_library(folder / "library.h5");
  ASSERT_TRUE(library) << library.error().message;
  const nlohmann::json parameters = nlohmann::json::parse(library->header.parameters);
  for (const auto& option : options_of<TrainOptions>()) {
    const nlohmann::json expected =
        std::visit([](const auto& value) { return nlohmann::json(value); }, changed(option));
    EXPECT_EQ(parameters[std::string(option.info.name)], expected) << option.info.name;
  }

  run({"train", "bolt=bracket.ply", "-o", "library.h5"}, {});
  run({"recognize", "library.h5", "scan.ply", "--report", "out"},
      changed_arguments<RecognizeOptions>());
  const std::string page = test::read_bytes(folder / "out/index.html");
  for (const auto& option : options_of<RecognizeOptions>()) {
    if (option.info.place == OptionPlace::service_only) continue;
    const std::string row = "<tr><td>" + label_with_unit(option.info) + "<td class=\"words\">" +
                            escape_html(value_text(changed(option))) + "\n";
    EXPECT_NE(page.find(row), std::string::npos) << row;
  }
}

}  // namespace
}  // namespace trivet::apps

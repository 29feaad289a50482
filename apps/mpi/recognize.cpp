#include "engine/recognition/recognize.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstring>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <type_traits>
#include <utility>

#include "apps/mpi/commands.hpp"
#include "apps/recognition/json_output.hpp"
#include "apps/recognition/recognize_request.hpp"
#include "apps/results/detections_json.hpp"
#include "apps/results/failed_scenes.hpp"
#include "apps/words/reported_part.hpp"
#include "engine/results/camera_check.hpp"
#include "storage/files/json_text.hpp"

namespace trivet::apps::mpi {
namespace {

using Json = nlohmann::ordered_json;

/// The result of a scene for rank 0.
struct SceneOutcome {
  Json scene;
  std::optional<CameraCheck> check;
  std::optional<Error> failure{};
};

// All ranks run the same program: structures without pointers are sent as bytes, in hexadecimal
// digits.

template <class T>
std::string hex_of(const T& value) {
  std::string text;
  for (const std::byte b : std::as_bytes(std::span(&value, 1)))
    text += fmt::format("{:02x}", std::to_integer<unsigned>(b));
  return text;
}

template <class T>
T from_hex(const std::string& text) {
  T value{};
  for (std::byte& b : std::as_writable_bytes(std::span(&value, 1))) {
    const char* const digits = text.data() + 2 * (&b - reinterpret_cast<std::byte*>(&value));
    unsigned number = 0;
    std::from_chars(digits, digits + 2, number, 16);
    b = static_cast<std::byte>(number);
  }
  return value;
}

Json check_json(const std::optional<CameraCheck>& check) {
  if (!check) return nullptr;
  Json objects = Json::array();
  for (const kernels::ScalePull& object : check->objects) objects.push_back(hex_of(object));
  return {{"camera", hex_of(check->camera)},
          {"objects", std::move(objects)},
          {"rays", check->num_rays},
          {"depth", hex_of(check->depth)}};
}

std::optional<CameraCheck> parse_check(const Json& json) {
  if (json.is_null()) return std::nullopt;
  CameraCheck check;
  check.camera = from_hex<Camera>(json.at("camera").get<std::string>());
  for (const Json& object : json.at("objects"))
    check.objects.push_back(from_hex<kernels::ScalePull>(object.get<std::string>()));
  check.num_rays = json.at("rays").get<std::size_t>();
  check.depth = from_hex<DepthReading>(json.at("depth").get<std::string>());
  return check;
}

std::optional<Error> parse_failure(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return Error{static_cast<ErrorCode>(json.at(0).get<int>()), json.at(1).get<std::string>()};
}

std::string outcome_bytes(std::size_t index, const SceneOutcome& outcome) {
  Json failure;
  if (outcome.failure)
    failure = {static_cast<int>(outcome.failure->code), outcome.failure->message};
  const Json all{{"index", index},
                 {"scene", outcome.scene},
                 {"check", check_json(outcome.check)},
                 {"failure", std::move(failure)}};
  return json_text(all);
}

/// Recognizes the scenes of this rank one after the other, each with all its threads.
Result<void> recognize_share(const RecognitionRequest& request, const Worker& worker,
                             const std::stop_token& stop) {
  while (const std::optional<std::string> job = worker.next()) {
    const auto index = static_cast<std::size_t>(std::stoull(*job));
    const SceneInput& scene = request.scenes.sources[index];
    const auto emit = [&](std::size_t, const SceneResult& all) {
      const SceneResult result = reported_part(all, request.kept);
      worker.done(outcome_bytes(
          index, {JsonOutput::element(scene, result, request), result.stats.camera_check}));
    };
    const auto fail = [&](std::size_t, const Error& error) {
      worker.done(outcome_bytes(index, {failed_scene_json(scene.file.string(), error), {}, error}));
    };
    const Result<void> done = recognize_all(request.recognizer, std::span(&scene, 1), request.kept,
                                            {{}, stop}, emit, fail);
    if (!done) return done;
  }
  return {};
}

Result<void> refuse_what_is_not_shared(const SceneCommand& arguments) {
  const OutputArguments& outputs = arguments.outputs;
  if (outputs.json.empty())
    return Error{ErrorCode::usage, "expected --json FILE, where all results go together"};
  for (const auto& [given, option] : {std::pair(!outputs.bop_csv.empty(), "--bop-csv"),
                                      {!outputs.coco.empty(), "--coco"},
                                      {!outputs.report.empty(), "--report"},
                                      {!outputs.robot_csv.empty(), "--robot-csv"},
                                      {arguments.estimate_camera, "--estimate-camera"}}) {
    if (given)
      return Error{ErrorCode::usage, fmt::format("{}: only `trivet recognize` has it", option)};
  }
  return {};
}

Result<void> recognize(const SceneCommand& arguments, const Ranks& ranks, const Context& context) {
  TRIVET_TRY(refuse_what_is_not_shared(arguments));
  Result<RecognitionRequest> opened = make_request(arguments, context.console);
  if (!opened) return opened.error();
  const RecognitionRequest& request = *opened;
  const std::size_t num_scenes = request.scenes.sources.size();
  const Progress progress = context.console.progress("recognized", context.stop);
  std::size_t next = 0;
  std::map<std::size_t, SceneOutcome> outcomes;
  const JobBook book{
      [&]() -> std::optional<std::string> {
        if (next == num_scenes || context.stop.stop_requested()) return std::nullopt;
        return std::to_string(next++);
      },
      [&](const std::string& bytes) {
        const Json json = parse_json<Json>(bytes);
        const auto index = json.at("index").get<std::size_t>();
        outcomes.emplace(index, SceneOutcome{json.at("scene"), parse_check(json.at("check")),
                                             parse_failure(json.at("failure"))});
        progress(outcomes.size(), num_scenes, request.scenes.sources[index].file.string());
      }};
  const Result<void> shared = share_jobs(
      ranks, book,
      [&](const Worker& worker) { return recognize_share(request, worker, context.stop); },
      context.stop);
  if (!ranks.is_first() || !shared) return shared;
  if (outcomes.size() < num_scenes) {
    return Error{ErrorCode::resumable,
                 fmt::format("stopped after {} of {} scenes", outcomes.size(), num_scenes)};
  }
  JsonOutput output(arguments.outputs.json, arguments.library, request);
  std::vector<Error> failures;
  for (auto& [index, outcome] : outcomes) {
    output.add_element(std::move(outcome.scene), outcome.check);
    if (outcome.failure) failures.push_back(std::move(*outcome.failure));
  }
  TRIVET_TRY(output.finish());
  return failed_scenes(failures, num_scenes);
}

}  // namespace

void add_recognize(CLI::App& app, const Ranks& ranks, Context& context) {
  auto arguments = std::make_shared<SceneCommand>();
  CLI::App* command = app.add_subcommand("recognize",
                                         "Find the models of a library in scenes\n\n"
                                         "As trivet recognize with --json. Rank 0 hands the scenes "
                                         "out one by one and writes what all\n"
                                         "ranks found, in the order of the scenes.");
  add_scene_command(*command, *arguments);
  command->callback([arguments, &ranks, &context] {
    context.run = [arguments, &ranks, &context] { return recognize(*arguments, ranks, context); };
  });
}

}  // namespace trivet::apps::mpi

// A scan or mesh in the body of a request, read, prepared and searched with a library of one model.
#include <cmath>

#include "engine/recognition/recognize.hpp"
#include "engine/training/standard_basis.hpp"
#include "engine/training/train.hpp"
#include "fuzz/targets.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/degenerate_geometry.hpp"
#include "support/geometry_files.hpp"
#include "support/shapes.hpp"

namespace trivet::fuzz {
namespace {

constexpr std::array<std::string_view, 6> kSceneFormats{"ply", "obj", "stl", "off", "xyz", "png"};
constexpr char kFirstChoice = 'a';  // followed by one bit each: closed, viewpoint, another unit
constexpr int kNumChoices = 8;

/// A foot with a pillar, some 200 wide, coarsely sampled and trained for voting alone.
const Recognizer& recognizer() {
  static const Recognizer made = [] {
    test::Shape part = test::box({-80, -50, 0}, {80, 50, 20});
    part.join(test::box({-70, -40, 20}, {-30, 10, 110}));
    Cloud cloud;
    cloud.points = part.vertices;
    cloud.triangles = part.triangles;
    TrainOptions options;
    options.relative_step = 0.1F;
    options.num_samples = 256;
    options.tri_spin_images = false;
    TriSpinBasis basis = engine::standard_basis(options);
    Result<TrainedModel> trained = train_model(cloud, {"part", "part.ply", 1, {}}, options, basis);
    require(trained.has_value(), "the library's part is a good one");
    Library library({std::move(trained->model)});
    library.header.unit = LengthUnit::millimeter;
    library.basis = std::move(basis);
    return Recognizer(std::move(library));
  }();
  return made;
}

RecognizeOptions few_of_all() {
  RecognizeOptions options;
  options.method = Method::ppf;
  options.vote.max_references = 50;
  options.vote.max_votes = 1000;
  options.pose.max_clusters = 50;
  options.pose.max_refined = 4;
  options.pose.max_examined = 4;
  options.pose.rounds = 1;
  return options;
}

}  // namespace

void recognize_scene(std::string_view input) {
  if (input.size() < 2) return;
  const auto format = static_cast<std::size_t>(static_cast<unsigned char>(input[0]) - '0');
  const int choice = input[1] - kFirstChoice;
  if (format >= kSceneFormats.size() || choice < 0 || choice >= kNumChoices) return;

  SceneInput scene{.file = "body." + std::string(kSceneFormats[format])};
  scene.closed_surface = (choice & 1) != 0;
  if ((choice & 2) != 0) scene.viewpoint = Eigen::Vector3d(0, 0, 0);
  scene.scale = (choice & 4) != 0 ? 1000 : 1;
  const std::vector<char> body(input.begin() + 2, input.end());
  const ReadOptions limits{.camera = test::kCamera, .max_points = 20'000, .max_pixels = 20'000};
  const Result<Cloud> cloud = read_cloud(std::as_bytes(std::span(body)), scene.file, limits);
  if (!cloud) return;  // covered by read_scan

  const Result<SceneResult> result = recognize(recognizer(), *cloud, scene, few_of_all());
  if (!result) {
    require(result.error().code == ErrorCode::bad_data,
            "faults are the client's: " + result.error().message);
    return;
  }
  for (const Detection& detection : result->detections) {
    require(detection.T_scene_model.matrix().allFinite(), "poses are numbers");
    require(detection.score >= 0 && detection.score <= 1, "scores are shares");
  }
}

std::vector<std::string> recognize_scene_seeds() {
  std::vector<std::string> seeds;
  const auto add = [&](char format, const std::string& body) {
    for (int choice = 0; choice < kNumChoices; choice += 3)
      seeds.push_back({std::string{format, static_cast<char>(kFirstChoice + choice)} + body});
  };
  for (const test::DegenerateMesh& mesh : test::degenerate_meshes()) {
    const std::size_t n = mesh.cloud.points.size();
    if (n == 1 || n == 3 || n == 4 || n == 12) add('1', test::obj_file(mesh.cloud));
  }
  for (const std::size_t layers : {1U, 20U}) {
    add('1', test::obj_file(test::layered_tetrahedron(layers)));
    add('1', test::obj_file(test::shifted_tetrahedra(layers)));
  }
  std::string points;
  for (int i = 0; i < 400; ++i) {
    points += std::to_string(i % 20 * 10 - 100) + ' ' + std::to_string(i / 20 * 10 - 100) + ' ' +
              std::to_string(500 + i % 7) + '\n';
  }
  add('4', points);
  add('4', points + points);
  return seeds;
}

}  // namespace trivet::fuzz

#include "engine/recognition/explain_place.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <string>
#include <tuple>

#include "storage/common/stop.hpp"

namespace trivet::engine {
namespace {

/// Maximum distance of a place from a posed model's samples at which it counts as part of the model
/// [diameters]: for proposed poses and for refined ones.
constexpr float kReach = 0.1F, kTouch = 0.03F;
constexpr float kSigmas = 3;
constexpr std::size_t kMostExplained = 20;  // models per place

/// A place of the scene and the models that may lie there.
class Place {
 public:
  /// point  place in the scene's frame [library unit]
  Place(const Eigen::Vector3f& point, float noise) : point_(point), noise_(noise) {}

  /// Whether a posed model reaches the place.
  bool is_reached(const kernels::ModelSamples& m, const Pose& T_scene_model, float share) const {
    const Eigen::Vector3f point = T_scene_model.inverse() * point_;
    // The place may lie between samples of the surface.
    const float reach = share * m.diameter + m.spacing + kSigmas * noise_;
    if ((point - m.center).norm() > m.diameter + reach) return false;
    const PointsView samples = m.points;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if ((samples[i] - point).squaredNorm() <= reach * reach) return true;
    }
    return false;
  }

 private:
  const Eigen::Vector3f point_;
  const float noise_;
};

/// Rows of a model near the place.
struct Nearby {
  std::array<std::size_t, kNumPoseStages> num_poses{};
  std::optional<Row> detection{}, refused{};  // the best by score
  std::optional<Row> given_up{};  // pose with the latest stage among those not tested in full
};

/// Of refused poses, whose scores are 0, the one that agrees most is the likeliest answer.
void keep_better(const PoseTable& table, Row row, std::optional<Row>& best) {
  const auto merit = [&](Row tested) {
    return std::tuple(table.score[tested], table.test(tested).examination.consistent);
  };
  if (!best || merit(row) > merit(*best)) best = row;
}

/// Sort key of poses that went no further than the same stage.
auto furthest(const PoseTable& table, Row row) {
  return std::tuple(table.stage[row],
                    table.stage[row] == PoseStage::refined ? table.score[row] : table.votes[row]);
}

std::map<std::uint32_t, Nearby> find_nearby(const PoseTable& table, const PoseVerifier& verifier,
                                            const Place& place) {
  std::map<std::uint32_t, Nearby> nearby;
  for (Row row = 0; row < table.size(); ++row) {
    check_stop();
    const std::uint32_t model = table.model[row];
    const kernels::ModelSamples& samples = verifier.tester(model).samples();
    const bool is_tested = table.stage[row] == PoseStage::examined;
    const bool began_here = place.is_reached(samples, table.T_proposed[row], kReach);
    const bool ended_here =
        is_tested && place.is_reached(samples, table.T_scene_model[row], kReach);
    if (!began_here && !ended_here) continue;
    Nearby& near = nearby[model];
    const auto last = static_cast<std::size_t>(std::min(table.stage[row], PoseStage::refined));
    for (std::size_t stage = 0; began_here && stage <= last; ++stage) ++near.num_poses[stage];
    if (ended_here) ++near.num_poses[static_cast<std::size_t>(PoseStage::examined)];
    if (!is_tested) {
      if (!near.given_up || furthest(table, row) > furthest(table, *near.given_up))
        near.given_up = row;
    } else if (table.fate[row] != PoseFate::given_up &&
               place.is_reached(samples, table.T_scene_model[row], kTouch)) {
      keep_better(table, row,
                  table.fate[row] == PoseFate::detection ? near.detection : near.refused);
    }
  }
  return nearby;
}

/// Test a discarded pose in full. Returns its new row; absent if too little of it is visible or it
/// is beyond the limits.
Result<std::optional<Row>> test_after_all(const PoseVerifier& verifier, Row given_up,
                                          float least_score, PoseTable& table) {
  const Row row =
      table.add(table.model[given_up], table.source[given_up], table.T_proposed[given_up]);
  table.fate[row] = PoseFate::given_up;
  verifier.refine(table, {&row, 1});
  if (!(table.score[row] > least_score)) return std::optional<Row>();
  const Result<std::vector<Row>> within = verifier.examine(table, {&row, 1});
  if (!within) return within.error();
  return within->empty() ? std::optional<Row>() : row;
}

}  // namespace

Result<std::vector<ExplainedModel>> explain_place(const Library& library,
                                                  const PreparedScene& scene,
                                                  const PlaceQuestion& question, float least_score,
                                                  const PoseVerifier& verifier, PoseTable& table) {
  const Eigen::Vector3d point = scene.scale * *question.point;
  const Place place(point.cast<float>(), scene.sensor.noise);
  std::map<std::uint32_t, Nearby> nearby = find_nearby(table, verifier, place);
  std::vector<std::uint32_t> models;
  for (std::uint32_t m = 0; m < library.models.size(); ++m) {
    const bool is_asked =
        std::ranges::find(question.models, library.models[m].name) != question.models.end();
    if (question.models.empty() ? nearby.contains(m) : is_asked) models.push_back(m);
  }
  const auto order = [&](std::uint32_t m) {
    const Nearby& near = nearby[m];
    const auto [stage, merit] =
        near.given_up ? furthest(table, *near.given_up) : std::tuple(PoseStage::proposed, 0.0F);
    return std::tuple(!near.detection, near.refused ? -table.score[*near.refused] : 1.0F,
                      -static_cast<int>(stage), -merit);
  };
  std::ranges::stable_sort(models, {}, order);
  if (question.models.empty()) models.resize(std::min(models.size(), kMostExplained));

  std::vector<ExplainedModel> explained;
  for (const std::uint32_t m : models) {
    const Nearby& near = nearby[m];
    ExplainedModel& of = explained.emplace_back();
    of.model = m;
    of.num_poses = near.num_poses;
    of.pose = near.detection ? near.detection : near.refused;
    if (!of.pose && near.given_up &&
        near.num_poses[static_cast<std::size_t>(PoseStage::examined)] == 0) {
      const auto row = test_after_all(verifier, *near.given_up, least_score, table);
      if (!row) return row.error();
      of.pose = *row;
      of.given_up = true;
    }
    if (!of.pose) continue;
    auto rays = verifier.judged_rays(m, table.T_scene_model[*of.pose]);
    if (!rays) return rays.error();
    of.rays = *std::move(rays);
  }
  return explained;
}

}  // namespace trivet::engine

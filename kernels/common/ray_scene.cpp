#include "kernels/common/ray_scene.hpp"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <new>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "storage/common/precondition.hpp"
#include "storage/common/wait_for_memory.hpp"

namespace trivet::kernels {
namespace {

/// Embree reports errors through a callback on the calling thread; this is the last message.
thread_local std::string last_message;
thread_local bool is_out_of_memory = false;

void keep_message(void*, RTCError error, const char* message) {
  is_out_of_memory = error == RTC_ERROR_OUT_OF_MEMORY;
  if (!is_out_of_memory) last_message = message ? message : "";
}

/// One device per process. Its "threads" stays unset, as it would limit TBB in the whole process.
RTCDevice device() {
  static const RTCDevice instance = [] {
    RTCDevice created = rtcNewDevice("set_affinity=0");
    if (!created && rtcGetDeviceError(nullptr) == RTC_ERROR_OUT_OF_MEMORY)
      throw std::bad_alloc();  // retried next time
    if (created) rtcSetDeviceErrorFunction(created, keep_message, nullptr);
    return created;
  }();
  return instance;
}

/// Throws std::bad_alloc for lack of memory, which is not the model's fault.
Error embree_error(const std::string& doing) {
  if (std::exchange(is_out_of_memory, false)) throw std::bad_alloc();
  std::string message = "Embree failed while " + doing;
  if (!device()) return {ErrorCode::internal, message + ": it could not be started"};
  if (!last_message.empty()) message += ": " + last_message;
  return {ErrorCode::internal, message + "; free memory or use a smaller mesh"};
}

/// Geometry that is released at the end of the scope; an attached one stays in its scene.
struct Geometry {
  RTCGeometry handle;
  explicit Geometry(RTCGeometryType type) : handle(rtcNewGeometry(device(), type)) {}
  ~Geometry() {
    if (handle) rtcReleaseGeometry(handle);
  }
  Geometry(const Geometry&) = delete;
  Geometry& operator=(const Geometry&) = delete;

  template <class T>
  T* buffer(RTCBufferType type, RTCFormat format, std::size_t stride, std::size_t count) {
    return static_cast<T*>(rtcSetNewGeometryBuffer(handle, type, 0, format, stride, count));
  }
};

RTCRay make_ray(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_near,
                float t_far) noexcept {
  RTCRay ray{};
  ray.org_x = origin.x();
  ray.org_y = origin.y();
  ray.org_z = origin.z();
  ray.tnear = t_near;
  ray.dir_x = direction.x();
  ray.dir_y = direction.y();
  ray.dir_z = direction.z();
  ray.tfar = t_far;
  ray.mask = 0xFFFF'FFFFU;
  return ray;
}

}  // namespace

struct RayScene::State {
  RTCScene scene = nullptr;
  std::vector<Eigen::Matrix3f> rotations;  ///< instance frame to world frame, for normals
  std::size_t num_primitives = 0;

  State() {
    last_message.clear();
    is_out_of_memory = false;
    if (!device()) return;
    scene = rtcNewScene(device());
    if (scene) rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  }
  ~State() {
    if (scene) rtcReleaseScene(scene);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  /// Building a tree crashes in Embree 3.13 if memory runs out. Throws std::bad_alloc instead if
  /// the expected amount is not available beforehand.
  void require_memory() const {
    void* volatile probe = ::operator new(memory_bytes(num_primitives));
    ::operator delete(probe);
  }

  /// Attach under the next index, in the order of the calls.
  void attach(const Geometry& geometry) {
    rtcCommitGeometry(geometry.handle);
    rtcAttachGeometry(scene, geometry.handle);
  }
  bool commit() {
    require_memory();
    const WaitForMemoryEverywhere scope;
    rtcCommitScene(scene);
    return last_message.empty() && !is_out_of_memory;
  }
};

RayScene::RayScene(std::unique_ptr<State> state) : state_(std::move(state)) {}
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;
RayScene::~RayScene() = default;

std::size_t RayScene::memory_bytes() const noexcept { return memory_bytes(state_->num_primitives); }

std::size_t RayScene::memory_bytes(std::size_t num_primitives) noexcept {
  // Corners, indices and the tree over them: Embree counts 85 to 93 bytes per triangle for meshes
  // of 450 to 100,000 triangles.
  constexpr std::size_t kBytesAPrimitive = 96, kBytesAScene = 4096;
  return kBytesAScene + num_primitives * kBytesAPrimitive;
}

Result<RayScene> RayScene::from_mesh(PointsView vertices, TrianglesView triangles) {
  if (triangles.empty()) {
    return Error{ErrorCode::bad_data,
                 "a mesh of at least one triangle expected for ray tracing, none found; "
                 "treat the vertices as a cloud"};
  }
  auto state = std::make_unique<State>();
  if (!state->scene) return embree_error("creating a scene");

  Geometry mesh(RTC_GEOMETRY_TYPE_TRIANGLE);
  if (!mesh.handle) return embree_error("creating a mesh");
  auto* positions = mesh.buffer<float>(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                       vertices.size());
  auto* indices = mesh.buffer<std::uint32_t>(RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3,
                                             3 * sizeof(std::uint32_t), triangles.size());
  if (!positions || !indices) return embree_error("taking memory for a mesh");
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    Eigen::Map<Eigen::Vector3f>(positions + 3 * i) = vertices[i];
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    indices[3 * t] = triangles.a[t];
    indices[3 * t + 1] = triangles.b[t];
    indices[3 * t + 2] = triangles.c[t];
  }
  // Readers check this, but a mapped file may have changed since.
  if (std::ranges::any_of(std::span(indices, 3 * triangles.size()),
                          [&](std::uint32_t index) { return index >= vertices.size(); })) {
    return Error{ErrorCode::bad_data,
                 fmt::format("a mesh of {} vertices: expected faces that name these, found others",
                             vertices.size())};
  }

  state->num_primitives = triangles.size();
  state->attach(mesh);
  if (!state->commit()) return embree_error("building the tree of a mesh");
  return RayScene(std::move(state));
}

namespace {

/// Set points with radii, common to spheres and discs.
bool set_points(Geometry& geometry, PointsView points, float radius) {
  auto* values = geometry.buffer<float>(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4,
                                        4 * sizeof(float), points.size());
  if (!values) return false;
  for (std::size_t i = 0; i < points.size(); ++i) {
    Eigen::Map<Eigen::Vector3f>(values + 4 * i) = points[i];
    values[4 * i + 3] = radius;
  }
  return true;
}

/// Rejects hits from behind: such a ray came through a gap between the discs in front.
void keep_fronts(const RTCFilterFunctionNArguments* query) {
  for (unsigned k = 0; k < query->N; ++k) {
    const float along =
        RTCRayN_dir_x(query->ray, query->N, k) * RTCHitN_Ng_x(query->hit, query->N, k) +
        RTCRayN_dir_y(query->ray, query->N, k) * RTCHitN_Ng_y(query->hit, query->N, k) +
        RTCRayN_dir_z(query->ray, query->N, k) * RTCHitN_Ng_z(query->hit, query->N, k);
    if (along > 0) query->valid[k] = 0;
  }
}

Error no_points() {
  return {ErrorCode::bad_data,
          "at least one point expected for ray tracing, none found; check the input cloud"};
}

}  // namespace

Result<RayScene> RayScene::from_spheres(PointsView centers, float radius) {
  if (centers.empty()) return no_points();
  TRIVET_REQUIRE(radius > 0, "a sphere without a radius stops no ray");
  auto state = std::make_unique<State>();
  if (!state->scene) return embree_error("creating a scene");

  Geometry spheres(RTC_GEOMETRY_TYPE_SPHERE_POINT);
  if (!spheres.handle) return embree_error("creating spheres");
  if (!set_points(spheres, centers, radius)) return embree_error("taking memory for spheres");

  state->num_primitives = centers.size();
  state->attach(spheres);
  if (!state->commit()) return embree_error("building the tree of a cloud");
  return RayScene(std::move(state));
}

Result<RayScene> RayScene::from_discs(PointsView points, NormalsView normals, float radius) {
  if (points.empty()) return no_points();
  TRIVET_REQUIRE(radius > 0, "a disc without a radius stops no ray");
  auto state = std::make_unique<State>();
  if (!state->scene) return embree_error("creating a scene");

  Geometry discs(RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
  if (!discs.handle) return embree_error("creating discs");
  if (!set_points(discs, points, radius)) return embree_error("taking memory for discs");
  auto* directions = discs.buffer<float>(RTC_BUFFER_TYPE_NORMAL, RTC_FORMAT_FLOAT3,
                                         3 * sizeof(float), points.size());
  if (!directions) return embree_error("taking memory for the normals of discs");
  for (std::size_t i = 0; i < points.size(); ++i) {
    Eigen::Map<Eigen::Vector3f>(directions + 3 * i) = normals[i];
  }

  rtcSetGeometryIntersectFilterFunction(discs.handle, keep_fronts);
  rtcSetGeometryOccludedFilterFunction(discs.handle, keep_fronts);
  state->num_primitives = points.size();
  state->attach(discs);
  if (!state->commit()) return embree_error("building the tree of an oriented cloud");
  return RayScene(std::move(state));
}

Result<RayScene> RayScene::from_instances(std::span<const Instance> instances) {
  auto state = std::make_unique<State>();
  if (!state->scene) return embree_error("creating a scene");
  for (const Instance& instance : instances) {
    Geometry placed(RTC_GEOMETRY_TYPE_INSTANCE);
    if (!placed.handle) return embree_error("creating an instance");
    rtcSetGeometryInstancedScene(placed.handle, instance.scene->state_->scene);
    rtcSetGeometryTimeStepCount(placed.handle, 1);
    const Eigen::Matrix<float, 3, 4> affine = instance.T_world_scene.affine();
    rtcSetGeometryTransform(placed.handle, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, affine.data());
    state->attach(placed);
    state->rotations.push_back(instance.T_world_scene.linear());
  }
  if (!state->commit()) return embree_error("building the tree of a scene of instances");
  return RayScene(std::move(state));
}

bool RayScene::occluded(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                        float t_near, float t_far) const noexcept {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray = make_ray(origin, direction, t_near, t_far);
  rtcOccluded1(state_->scene, &context, &ray);
  return ray.tfar < 0;  // Embree marks an occluded ray by minus infinity
}

std::uint32_t RayScene::occluded(const Eigen::Vector3f& origin,
                                 PointsView directions) const noexcept {
  assert(directions.size() <= kPacket && "more rays than are traced at a time");
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  alignas(32) std::array<int, kPacket> wanted{};  // -1: requested
  alignas(32) RTCRay8 rays{};
  for (std::size_t k = 0; k < directions.size(); ++k) {
    wanted[k] = -1;
    rays.org_x[k] = origin.x();
    rays.org_y[k] = origin.y();
    rays.org_z[k] = origin.z();
    rays.dir_x[k] = directions.x[k];
    rays.dir_y[k] = directions.y[k];
    rays.dir_z[k] = directions.z[k];
    rays.tfar[k] = std::numeric_limits<float>::infinity();
    rays.mask[k] = 0xFFFF'FFFFU;
  }
  rtcOccluded8(wanted.data(), state_->scene, &context, &rays);
  std::uint32_t found = 0;
  for (std::size_t k = 0; k < directions.size(); ++k) found |= (rays.tfar[k] < 0 ? 1U : 0U) << k;
  return found;
}

Hit RayScene::intersect(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                        float t_near, float t_far) const noexcept {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query{make_ray(origin, direction, t_near, t_far), {}};
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(state_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};

  Eigen::Vector3f normal(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z);
  const std::uint32_t instance = query.hit.instID[0];
  if (instance != RTC_INVALID_GEOMETRY_ID) normal = state_->rotations[instance] * normal;
  return {query.ray.tfar, query.hit.primID, instance, normal.normalized()};
}

void RayScene::intersect_many(const Eigen::Vector3f& origin, PointsView directions,
                              std::span<float> distances, NormalsSpan normals) const noexcept {
  constexpr std::size_t kWidth = 8;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  for (std::size_t first = 0; first < directions.size(); first += kWidth) {
    const std::size_t count = std::min(kWidth, directions.size() - first);
    RTCRayHit8 query{};
    alignas(32) int valid[kWidth];
    for (std::size_t k = 0; k < kWidth; ++k) {
      const std::size_t i = first + std::min(k, count - 1);
      valid[k] = k < count ? -1 : 0;
      query.ray.org_x[k] = origin.x();
      query.ray.org_y[k] = origin.y();
      query.ray.org_z[k] = origin.z();
      query.ray.dir_x[k] = directions.x[i];
      query.ray.dir_y[k] = directions.y[i];
      query.ray.dir_z[k] = directions.z[i];
      query.ray.tnear[k] = 0;
      query.ray.tfar[k] = std::numeric_limits<float>::infinity();
      query.ray.mask[k] = 0xFFFF'FFFFU;
      query.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect8(valid, state_->scene, &context, &query);
    for (std::size_t k = 0; k < count; ++k) {
      const bool met = query.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;
      distances[first + k] = met ? query.ray.tfar[k] : std::numeric_limits<float>::infinity();
      if (!met) continue;
      const Eigen::Vector3f normal(query.hit.Ng_x[k], query.hit.Ng_y[k], query.hit.Ng_z[k]);
      normals.set(first + k, normal.normalized());
    }
  }
}

}  // namespace trivet::kernels

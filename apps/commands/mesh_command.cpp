#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include "apps/commands/commands.hpp"
#include "apps/options/add_options.hpp"
#include "engine/meshing/surface_from_points.hpp"
#include "storage/common/counted.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet::apps {
namespace {

struct MeshArguments {
  std::string cloud, output, camera, method;
  std::optional<int> image_id;
  std::vector<double> viewpoint;
  SurfaceOptions options;
};

std::string_view method_name(SurfaceMethod method) {
  return std::ranges::find(kSurfaceMethods, method, &SurfaceMethodName::method)->name;
}

/// Two digits, and whole numbers from ten percent on.
std::string percent_of_edges(double share) {
  return share < 0.1 ? fmt::format("{:.2g} %", 100 * share) : fmt::format("{:.0f} %", 100 * share);
}

Result<void> mesh(const MeshArguments& arguments, const Context& context) {
  const auto start = std::chrono::steady_clock::now();
  ReadOptions reading;
  if (!arguments.camera.empty()) {
    const Result<Camera> camera = read_camera(
        arguments.camera, arguments.image_id ? arguments.image_id : image_id_of(arguments.cloud));
    if (!camera) return camera.error();
    reading.camera = *camera;
  }
  SurfaceOptions options = arguments.options;
  if (const std::vector<double>& v = arguments.viewpoint; !v.empty())
    options.viewpoint = Eigen::Vector3d(v[0], v[1], v[2]);
  for (const SurfaceMethodName& known : kSurfaceMethods) {
    if (known.name == arguments.method) options.method = known.method;
  }
  TRIVET_TRY(validate(options));

  Result<Cloud> cloud = read_cloud(arguments.cloud, reading);
  if (!cloud) return cloud.error();
  const Result<Surface> surface = surface_from_points(std::move(*cloud), arguments.cloud, options);
  if (!surface) return surface.error();
  if (!surface->warning.empty()) context.console.warning(surface->warning);
  const Result<void> written = write_ply(arguments.output, surface->mesh);
  if (!written) return written;
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  context.console.line(fmt::format(
      "{}: {}, {} of them used, {} ({}), {} of the edges open, {:.2f} s", arguments.output,
      counted(surface->mesh.points.size(), "vertex", "vertices"), surface->num_used,
      counted(surface->mesh.triangles.size(), "triangle"), method_name(surface->method),
      percent_of_edges(surface->open_share), seconds.count()));
  return {};
}

}  // namespace

void add_mesh(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<MeshArguments>();
  SurfaceOptions& options = arguments->options;
  CLI::App* command = app.add_subcommand("mesh", "Lay a surface of triangles through a scan");
  command
      ->add_option("CLOUD", arguments->cloud,
                   "Scan or cloud (PLY, PCD, OBJ, STL, OFF, XYZ, glTF, NPY) or depth image (PNG, "
                   "TIFF, NPY); "
                   "a whole object needs normals")
      ->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "PLY file to write, in the frame and unit of the input, far from its origin "
                   "with doubles; "
                   "it appears whole or not at all")
      ->required();
  std::string methods = "Where the triangles come from; default: the first that the file allows";
  std::vector<std::string> names;
  for (const SurfaceMethodName& known : kSurfaceMethods) {
    methods += fmt::format("\n{}: {}", known.name, known.sentence);
    names.emplace_back(known.name);
  }
  limit_to(command->add_option("--method", arguments->method, methods), names);
  command->add_option(
      "--camera", arguments->camera,
      "Camera of a depth image: JSON with fx fy cx cy depth_scale, or BOP's scene_camera.json");
  command
      ->add_option("--image-id", arguments->image_id,
                   "Image of scene_camera.json whose camera --camera takes; default: the number "
                   "that is the file's name, as in 000003.png")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--viewpoint", arguments->viewpoint,
                   "Position x,y,z of the sensor in the file's frame; default: the file's, else "
                   "the origin")
      ->delimiter(',')
      ->expected(3);
  command
      ->add_option("--max-jump", options.grid.max_jump,
                   "grid: longest edge, in edges of a surface that faces the sensor there")
      ->capture_default_str();
  command
      ->add_option("--max-grazing", options.grid.max_grazing_deg,
                   "grid: between a triangle's normal and the line of sight [degrees]")
      ->capture_default_str();
  command
      ->add_option("--max-neighbors", options.greedy.max_neighbors,
                   "greedy: the nearest ones of a point that its triangles may have")
      ->capture_default_str();
  command->add_option("--radius", options.greedy.radius,
                      "greedy: longest edge [unit of the file]; default: --mu alone counts");
  command
      ->add_option("--mu", options.greedy.mu,
                   "greedy: longest edge, in spacings of the points there")
      ->capture_default_str();
  command
      ->add_option("--min-angle", options.greedy.min_angle_deg,
                   "greedy: smallest angle of a triangle; narrower ones are left out [degrees]")
      ->capture_default_str();
  command
      ->add_option(
          "--max-angle", options.greedy.max_angle_deg,
          "greedy: between two edges of a point; wider gaps of its fan stay open [degrees]")
      ->capture_default_str();
  command
      ->add_option("--max-normal-angle", options.greedy.max_normal_angle_deg,
                   "greedy: between the normals of a triangle's corners [degrees]")
      ->capture_default_str();
  command->callback([arguments, &context] {
    context.run = [arguments, &context] { return mesh(*arguments, context); };
  });
}

}  // namespace trivet::apps

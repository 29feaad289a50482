// A scan in the body of a request, in any format.
#include "fuzz/targets.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/degenerate_geometry.hpp"
#include "support/geometry_files.hpp"

namespace trivet::fuzz {
namespace {

constexpr std::array<std::string_view, 12> kFormats{"ply", "pcd",    "obj", "stl", "off", "xyz",
                                                    "png", "xyz.gz", "npy", "tif", "glb", "gltf"};

}  // namespace

void read_scan(std::string_view input) {
  if (input.empty() || input[0] < '0' || input[0] >= '0' + static_cast<char>(kFormats.size()))
    return;
  const std::string name =
      "body." + std::string(kFormats[static_cast<std::size_t>(input[0] - '0')]);
  // The allocation has exactly this size, so that sanitizers detect a read beyond it.
  const std::vector<char> body(input.begin() + 1, input.end());
  const ReadOptions options{.camera = test::kCamera, .max_points = 100'000, .max_pixels = 100'000};
  const Result<Cloud> cloud = read_cloud(std::as_bytes(std::span(body)), name, options);
  if (!cloud) {
    require(cloud.error().code == ErrorCode::bad_data,
            "faults are the client's, and no count is believed that the body cannot hold");
    return;
  }
  require(cloud->points.size() <= options.max_points, "no more points than allowed");
  const testing::AssertionResult valid = test::is_valid(*cloud);
  require(valid, valid.message());
}

std::vector<std::string> read_scan_seeds() {
  std::vector<std::string> seeds;
  for (const test::SampleFile& file : test::sample_files()) {
    for (std::size_t f = 0; f < kFormats.size(); ++f) {
      if (file.name.ends_with(kFormats[f]))
        seeds.push_back(static_cast<char>('0' + f) + file.bytes);
    }
  }
  for (const test::DegenerateMesh& mesh : test::degenerate_meshes())
    seeds.push_back('2' + test::obj_file(mesh.cloud));
  return seeds;
}

}  // namespace trivet::fuzz

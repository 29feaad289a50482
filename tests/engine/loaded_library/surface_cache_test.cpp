#include "engine/loaded_library/surface_cache.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <set>

#include "engine/common/parallel.hpp"
#include "support/shapes.hpp"

namespace trivet::engine {
namespace {

Result<kernels::RayScene> make_box() {
  const test::Shape box = test::box({-1, -1, -1}, {1, 1, 1});
  return kernels::RayScene::from_mesh(box.vertices, box.triangles);
}

std::size_t bytes_of_a_box() { return make_box()->memory_bytes(); }

TEST(SurfaceCache, MakesEachOnceForAllThatAskAtOnce) {
  SurfaceCache cache(100 * bytes_of_a_box());
  std::atomic<int> made = 0;
  std::vector<SurfaceCache::Surface> got(200);
  for_each_index(got.size(), [&](std::size_t i) {
    got[i] = *cache.get(static_cast<std::uint32_t>(i % 4), [&] {
      ++made;
      return make_box();
    });
  });
  EXPECT_EQ(made, 4);
  EXPECT_EQ(std::set(got.begin(), got.end()).size(), 4U);
}

TEST(SurfaceCache, ReleasesTheLeastRecentlyUsed) {
  SurfaceCache cache(2 * bytes_of_a_box());
  std::vector<std::uint32_t> made;
  const auto get = [&](std::uint32_t model) {
    return *cache.get(model, [&] {
      made.push_back(model);
      return make_box();
    });
  };
  get(1);
  get(2);
  get(1);
  get(3);  // evicts 2
  get(1);
  EXPECT_EQ(made, (std::vector<std::uint32_t>{1, 2, 3}));
  get(2);
  EXPECT_EQ(made, (std::vector<std::uint32_t>{1, 2, 3, 2}));
}

TEST(SurfaceCache, LeavesWhatIsInUseToItsUsers) {
  SurfaceCache cache(1);
  const SurfaceCache::Surface used = *cache.get(1, make_box);
  for (std::uint32_t model = 2; model < 10; ++model) ASSERT_TRUE(cache.get(model, make_box));
  EXPECT_TRUE(used->intersect({0, 0, -5}, {0, 0, 1}, 0, 10));
  EXPECT_EQ(used.use_count(), 1) << "the cache has let go of it";
}

TEST(SurfaceCache, ReportsWhyThereIsNone) {
  SurfaceCache cache(1);
  const auto none = [] { return Result<kernels::RayScene>(Error{ErrorCode::bad_data, "damaged"}); };
  for (int again = 0; again < 2; ++again) {
    const auto surface = cache.get(7, none);
    ASSERT_FALSE(surface);
    EXPECT_EQ(surface.error().message, "damaged");
  }
}

}  // namespace
}  // namespace trivet::engine

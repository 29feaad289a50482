// The library round trip, its publication, and inputs that the writer refuses.
#include "storage/library/library.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <limits>

#include "storage/library/import_library.hpp"
#include "support/craft_library.hpp"
#include "support/library_file.hpp"
#include "support/random_model.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;
using test::difference;
using test::edit_library;
using test::LibraryTest;
using test::random_basis;
using test::random_model;
using test::read_bytes;

const LibraryHeader kHeader{LengthUnit::millimeter, "trivet test", R"({"step": 0.05})"};

void write(const fs::path& file, std::span<const Model> models) {
  auto writer = LibraryWriter::create(file, kHeader);
  ASSERT_TRUE(writer) << writer.error().message;
  const auto common = writer->add(random_basis(5, test::kRandomComponents));
  ASSERT_TRUE(common) << common.error().message;
  for (const Model& model : models) {
    const auto added = writer->add(model);
    ASSERT_TRUE(added) << added.error().message;
  }
  const auto published = writer->publish();
  ASSERT_TRUE(published) << published.error().message;
}

std::size_t num_files(const fs::path& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST_F(LibraryTest, ReadsBackWhatWasWritten) {
  const std::vector<Model> models{random_model("zebra", 1), random_model("Ant-1.5_b", 2)};
  write(file(), models);
  const auto library = open_library(file());
  ASSERT_TRUE(library) << library.error().message;
  EXPECT_EQ(library->header.unit, kHeader.unit);
  EXPECT_EQ(library->header.producer, kHeader.producer);
  EXPECT_EQ(library->header.parameters, kHeader.parameters);
  EXPECT_EQ(library->version_minor, kLibraryVersionMinor);
  EXPECT_EQ(library->file_bytes, fs::file_size(file()));
  ASSERT_EQ(library->models.size(), 2U);
  EXPECT_EQ(difference(*library->model(0), models[1]), "");  // sorted by name
  EXPECT_EQ(difference(*library->model(1), models[0]), "");
  EXPECT_EQ(difference(library->basis, random_basis(5, test::kRandomComponents)), "");
}

// A table above 4 kB begins on a page and is used in the mapped file, which the model keeps alive.
TEST_F(LibraryTest, KeepsLargeTablesInTheMappedFileAfterTheLibraryAndTheFileAreGone) {
  const Model model = random_model("large", 3,
                                   {.num_ppf_points = 3000,
                                    .num_entries = 100000,
                                    .num_distance_bins = 20,
                                    .num_angle_bins = 15});
  write(file(), {&model, 1});
  Model read;
  {
    auto library = open_library(file());
    ASSERT_TRUE(library) << library.error().message;
    read = *library->model(0);
  }
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(read.ppf.offsets.data()) % 4096, 0U);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(read.ppf.entries.data()) % 4096, 0U);
  fs::remove(file());
  EXPECT_EQ(difference(read, model), "");
}

TEST_F(LibraryTest, HoldsModelsWithoutMeshSymmetryAndTable) {
  Model bare = random_model("bare", 4, {.num_triangles = 0});
  bare.symmetry = {};
  bare.near_symmetries.clear();
  bare.near_axis.reset();
  bare.source.clear();
  bare.ppf = Shared<PpfTableView>();
  write(file(), {&bare, 1});
  const auto library = open_library(file());
  ASSERT_TRUE(library) << library.error().message;
  EXPECT_EQ(difference(*library->model(0), bare), "");
}

TEST_F(LibraryTest, HoldsModelsWithoutFeatures) {
  Model plain = random_model("plain", 4);
  plain.features = {};
  write(file(), {&plain, 1});
  const auto beside = open_library(file());
  ASSERT_TRUE(beside) << beside.error().message;
  EXPECT_EQ(difference(*beside->model(0), plain), "") << "beside a basis";

  auto writer = LibraryWriter::create(file(), kHeader);
  ASSERT_TRUE(writer && writer->add(plain) && writer->publish());
  const auto without = open_library(file());
  ASSERT_TRUE(without) << without.error().message;
  EXPECT_EQ(difference(*without->model(0), plain), "");
  EXPECT_EQ(without->basis.components.size(), 0U);
}

// One file reserves more space for names than a message of an object header can hold, mostly
// unused; another reserves too little.
TEST_F(LibraryTest, IsReadWhateverRoomItHadForNames) {
  for (const NamesToCome names : {NamesToCome{9000, 90000}, NamesToCome{2, 2}}) {
    auto writer = LibraryWriter::create(file(), kHeader, names);
    ASSERT_TRUE(writer && writer->add(random_basis(5, test::kRandomComponents)));
    std::vector<Model> models;
    for (int m = 0; m < 40; ++m) {
      models.push_back(random_model("model_" + std::to_string(100 + m), 1));
      ASSERT_TRUE(writer->add(models.back()));
    }
    ASSERT_TRUE(writer->publish());
    const auto library = verify_library(file());
    ASSERT_TRUE(library) << library.error().message;
    ASSERT_EQ(library->models.size(), models.size());
    for (std::uint32_t m = 0; m < models.size(); ++m)
      EXPECT_EQ(difference(*library->model(m), models[m]), "");
  }
}

TEST_F(LibraryTest, RefusesFeaturesOfAnotherBasisAndASecondBasis) {
  auto writer = LibraryWriter::create(file(), kHeader);
  ASSERT_TRUE(writer);
  const auto none = writer->add(random_model("a", 1));
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("expected features of 0 components, found 7"),
            std::string::npos)
      << none.error().message;
  ASSERT_TRUE(writer->add(random_basis(5, 6)));
  const auto other = writer->add(random_model("a", 1));
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::bad_data);
  EXPECT_FALSE(writer->add(random_basis(5, 6)));
  EXPECT_TRUE(writer->publish());
}

TEST_F(LibraryTest, RefusesToWriteABrokenBasis) {
  auto writer = LibraryWriter::create(file(), kHeader);
  ASSERT_TRUE(writer);
  const auto refuses = [&](const char* what, auto break_it) {
    TriSpinBasis basis = random_basis(1, 4);
    break_it(basis);
    const auto added = writer->add(basis);
    ASSERT_FALSE(added) << what;
    EXPECT_EQ(added.error().code, ErrorCode::bad_data);
    EXPECT_NE(added.error().message.find(what), std::string::npos) << added.error().message;
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  refuses("support", [&](TriSpinBasis& b) { b.support = nan; });
  refuses("code_step", [](TriSpinBasis& b) { b.code_step = 0; });
  refuses("energies: expected 1 to 675", [](TriSpinBasis& b) { b.components.energies.clear(); });
  refuses("mean: expected 675", [](TriSpinBasis& b) { b.components.mean.pop_back(); });
  refuses("mean[3]", [&](TriSpinBasis& b) { b.components.mean[3] = nan; });
  refuses("components: expected 4 rows, found 3",
          [](TriSpinBasis& b) { b.components.components.resize(3 * b.components.dimension); });
  refuses("components[700]", [&](TriSpinBasis& b) { b.components.components[700] = nan; });
  refuses("energies[2]", [&](TriSpinBasis& b) { b.components.energies[2] = nan; });
}

TEST_F(LibraryTest, HoldsNoModelAtAll) {
  write(file(), {});
  const auto library = open_library(file());
  ASSERT_TRUE(library) << library.error().message;
  EXPECT_TRUE(library->models.empty());
}

// HDF5 crashes when it lists a damaged group with dense storage.
TEST_F(LibraryTest, KeepsTheLinksOfGroupsInTheirHeaders) {
  std::vector<Model> models;
  for (std::uint64_t i = 0; i < 20; ++i)
    models.push_back(random_model("model_" + std::to_string(i), 10 + i));
  write(file(), models);
  edit_library(file(), [](hid_t root) {
    for (const char* path :
         {"models", "models/model_0", "models/model_0/ppf", "models/model_0/trisi"}) {
      H5G_info_t info;
      ASSERT_GE(H5Gget_info_by_name(root, path, &info, H5P_DEFAULT), 0);
      EXPECT_EQ(info.storage_type, H5G_STORAGE_TYPE_COMPACT) << path;
    }
  });
}

TEST_F(LibraryTest, HoldsManyModels) {
  std::vector<Model> models;
  for (int i = 0; i < 200; ++i)
    models.push_back(
        random_model("model_" + std::to_string(i), 10 + static_cast<std::uint64_t>(i)));
  write(file(), models);
  const auto library = open_library(file());
  ASSERT_TRUE(library) << library.error().message;
  ASSERT_EQ(library->models.size(), models.size());
  EXPECT_TRUE(std::ranges::is_sorted(library->models, {}, &Model::name));
  for (const Model& model : models) {
    const auto found = std::ranges::find(library->models, model.name, &Model::name);
    ASSERT_NE(found, library->models.end());
    EXPECT_EQ(
        difference(*library->model(static_cast<std::uint32_t>(found - library->models.begin())),
                   model),
        "");
  }
}

TEST_F(LibraryTest, GivesTheSameBytesWhenWrittenTwice) {
  const std::vector<Model> models{random_model("a", 1), random_model("b", 2)};
  write(file(), models);
  const auto first = read_bytes(file());
  ::sleep(1);  // a time stamp in seconds would differ
  write(file(), models);
  EXPECT_EQ(read_bytes(file()), first);
}

TEST_F(LibraryTest, LeavesNoFileWithoutPublish) {
  {
    auto writer = LibraryWriter::create(file(), kHeader);
    ASSERT_TRUE(writer && writer->add(random_basis(5, test::kRandomComponents)) &&
                writer->add(random_model("a", 1)));
    EXPECT_FALSE(fs::exists(file()));
    EXPECT_EQ(num_files(folder()), 1U);
  }
  EXPECT_EQ(num_files(folder()), 0U);
}

TEST_F(LibraryTest, KeepsTheOldLibraryWithoutPublish) {
  const Model old = random_model("old", 1);
  write(file(), {&old, 1});
  const auto before = read_bytes(file());
  {
    auto writer = LibraryWriter::create(file(), kHeader);
    ASSERT_TRUE(writer && writer->add(random_basis(5, test::kRandomComponents)) &&
                writer->add(random_model("new", 2)));
  }
  EXPECT_EQ(read_bytes(file()), before);
  EXPECT_EQ(num_files(folder()), 1U);
}

TEST_F(LibraryTest, PublishesOverAnOpenedLibraryWithoutDisturbingIt) {
  const Model old = random_model("old", 1), fresh = random_model("new", 2);
  write(file(), {&old, 1});
  const auto library = open_library(file());
  write(file(), {&fresh, 1});
  ASSERT_TRUE(library);
  EXPECT_EQ(difference(*library->model(0), old), "");
  const auto reopened = open_library(file());
  ASSERT_TRUE(reopened);
  EXPECT_EQ(difference(*reopened->model(0), fresh), "");
}

TEST_F(LibraryTest, RefusesToGoOnAfterPublish) {
  auto writer = LibraryWriter::create(file(), kHeader);
  ASSERT_TRUE(writer && writer->publish());
  EXPECT_FALSE(writer->add(random_model("a", 1)));
  EXPECT_FALSE(writer->publish());
  EXPECT_TRUE(open_library(file()));
}

TEST_F(LibraryTest, RefusesBadAndRepeatedNamesAndStaysUsable) {
  auto writer = LibraryWriter::create(file(), kHeader);
  ASSERT_TRUE(writer && writer->add(random_basis(5, test::kRandomComponents)));
  const std::string long_name(129, 'a');
  for (const std::string& name :
       {std::string(), std::string("../x"), std::string("/x"), std::string("a/b"),
        std::string("a..b"), std::string("."), std::string("-x"), std::string("a b"),
        std::string("a\0b", 3), std::string("\xc3"),
        std::string("a\xe2\x80\xae"
                    "b"),
        std::string("%2e%2e"), long_name}) {
    const auto added = writer->add(random_model(name, 1));
    ASSERT_FALSE(added) << name;
    EXPECT_EQ(added.error().code, ErrorCode::bad_data);
  }
  ASSERT_TRUE(writer->add(random_model(long_name.substr(1), 1)));
  const auto twice = writer->add(random_model(long_name.substr(1), 2));
  ASSERT_FALSE(twice);
  EXPECT_EQ(twice.error().code, ErrorCode::bad_data);
  ASSERT_TRUE(writer->publish());
  EXPECT_TRUE(open_library(file()));
}

Points with_row(PointsView rows, std::size_t i, const Eigen::Vector3f& row) {
  Points changed(rows);
  changed.set(i, row);
  return changed;
}

Points first(PointsView rows, std::size_t count) { return Points(rows.slice(0, count)); }

template <class T>
Column<T> all_but_one(std::span<const T> rows) {
  return {rows.begin(), rows.end() - 1};
}

TEST_F(LibraryTest, RefusesToWriteABrokenModel) {
  auto writer = LibraryWriter::create(file(), kHeader);
  ASSERT_TRUE(writer && writer->add(random_basis(5, test::kRandomComponents)));
  const auto refuses = [&](const char* what, auto break_it) {
    Model model = random_model("a", 1);
    break_it(model);
    const auto added = writer->add(model);
    ASSERT_FALSE(added) << what;
    EXPECT_EQ(added.error().code, ErrorCode::bad_data);
    EXPECT_NE(added.error().message.find(what), std::string::npos) << added.error().message;
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  refuses("diameter", [&](Model& m) { m.diameter = nan; });
  refuses("center", [&](Model& m) { m.center.x() = nan; });
  refuses("vertices[3]", [&](Model& m) { m.vertices = with_row(m.vertices, 3, {0, nan, 0}); });
  refuses("triangles[2]", [](Model& m) {
    {
      Triangles t(m.triangles);
      t.c[2] = 50;
      m.triangles = std::move(t);
    }
  });
  refuses("sample_normals", [](Model& m) { m.sample_normals = first(m.sample_normals, 3); });
  refuses("sample_normals[1]", [](Model& m) {
    m.sample_normals = with_row(m.sample_normals, 1, {0, 0, 0});
  });
  refuses("sample_views", [](Model& m) { m.sample_views = all_but_one(m.sample_views); });
  refuses("sample_views", [](Model& m) {
    m.sample_views = std::vector<ViewMask>(m.sample_views.size(), ViewMask{});
  });
  refuses("symmetry_poses[0]", [](Model& m) { m.symmetry.poses[0].linear() *= 2; });
  refuses("symmetry axis", [](Model& m) { m.symmetry.axis->direction *= 2; });
  refuses("near_symmetries[1]", [](Model& m) { m.near_symmetries[1].linear() *= -1; });
  refuses("near_symmetries: expected at most 16",
          [](Model& m) { m.near_symmetries.resize(kMaxNearSymmetries + 1, Pose::Identity()); });
  refuses("ppf/normals", [](Model& m) { m.ppf_normals = first(m.ppf_normals, 3); });
  refuses("ppf@distance_step", [](Model& m) { m.ppf.quantization.distance_step = 0; });
  refuses("ppf@num_angle_bins", [](Model& m) { m.ppf.quantization.num_angle_bins = 65536; });
  refuses("ppf/offsets", [](Model& m) { m.ppf.quantization.num_angle_bins = 4; });
  refuses("ppf/entries", [](Model& m) { m.ppf.entries = m.ppf.entries.first(3); });
  refuses("trisi@resolution", [&](Model& m) { m.features[0].resolution = nan; });
  refuses("trisi/keypoints[2]", [&](Model& m) {
    m.features[0].keypoints = with_row(m.features[0].keypoints, 2, {nan, 0, 0});
  });
  refuses("trisi/frames: expected 20 rows, found 19",
          [](Model& m) { m.features[0].frames = all_but_one(m.features[0].frames); });
  refuses("trisi/frames[4]", [](Model& m) {
    {
      Column<FrameRows> frames(m.features[0].frames.begin(), m.features[0].frames.end());
      frames[4][0] += 0.1F;
      m.features[0].frames = std::move(frames);
    }
  });
  refuses("trisi/features",
          [](Model& m) { m.features[0].codes = all_but_one(m.features[0].codes); });
  refuses("reference", [](Model& m) {
    m.ppf_points = first(m.ppf_points, 20), m.ppf_normals = first(m.ppf_normals, 20);
  });
}

TEST_F(LibraryTest, ExplainsWhereItCannotCreate) {
  const auto missing = LibraryWriter::create(folder() / "no" / "lib.h5", kHeader);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::cannot_create);
  const auto directory = LibraryWriter::create(folder(), kHeader);
  ASSERT_FALSE(directory);
  EXPECT_EQ(directory.error().code, ErrorCode::cannot_create);
}

// Simulates a full disk: writes beyond a size limit fail. Runs in a child process, which must also
// exit cleanly.
int write_with_limit(const fs::path& file, rlim_t limit, const Model& model) {
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit bound{limit, limit};
  ::setrlimit(RLIMIT_FSIZE, &bound);
  auto writer = LibraryWriter::create(file, kHeader);
  Result<void> done;
  if (!writer) done = writer.error();
  if (done) done = writer->add(random_basis(5, test::kRandomComponents));
  if (done) done = writer->add(model);
  if (done) done = writer->publish();
  if (done) return 0;
  return done.error().code == ErrorCode::no_space && !fs::exists(file) ? 74 : 1;
}

TEST_F(LibraryTest, SaysSoWhenTheDiskIsFullAndExitsWithoutACrash) {
  const Model model = random_model(
      "large", 3, {.num_entries = 50000, .num_distance_bins = 20, .num_angle_bins = 10});
  write(file(), {&model, 1});
  const auto needed = fs::file_size(file());
  fs::remove(file());
  for (const rlim_t limit : {rlim_t{0}, rlim_t{100}, rlim_t{3000}, rlim_t{10000}, rlim_t{100000},
                             rlim_t{needed - 1}, rlim_t{needed}}) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) std::exit(write_with_limit(file(), limit, model));
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFEXITED(status)) << "crashed with a limit of " << limit << " bytes";
    EXPECT_EQ(WEXITSTATUS(status), limit < needed ? 74 : 0) << "limit " << limit;
    EXPECT_EQ(num_files(folder()), limit < needed ? 0U : 1U) << "limit " << limit;
  }
}

TEST_F(LibraryTest, OfOtherProgramsIsImportedOnlyWithParametersInJson) {
  for (const auto& [parameters, good] : {std::pair{"{\"step\": 2}", true}, {"step 2", false}}) {
    auto writer = LibraryWriter::create(file(), {LengthUnit::meter, "another program", parameters});
    ASSERT_TRUE(writer) << writer.error().message;
    ASSERT_TRUE(writer->publish());
    const auto read = read_repacked_library(file());
    EXPECT_EQ(bool(read), good) << parameters;
    if (read) continue;
    EXPECT_EQ(read.error().code, ErrorCode::bad_data);
    EXPECT_NE(read.error().message.find("/parameters: expected JSON"), std::string::npos)
        << read.error().message;
  }
}

}  // namespace
}  // namespace trivet

// Files of others, and libraries that were changed and have right checksums, are refused by name or read
// as what they say.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "storage/library/library.hpp"
#include "support/craft_library.hpp"
#include "support/damaged_library.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;
using hdf5::Handle;
using test::difference;
using test::edit_library;
using test::LibraryDamageTest;
using test::read_bytes;
using test::replace_attribute;
using test::replace_data;
using test::replace_dataset;
using test::seal_library;

const std::string kVertices = "models/a/vertices";
constexpr hsize_t kVerticesShape[] = {3, 50};

TEST_F(LibraryDamageTest, FindsADirectoryThatSaysSomethingElseThanTheGroups) {
  const float diameter = 7;
  edit_library(file(), [&](hid_t root) {
    replace_attribute(root, "models/a", "diameter", H5T_NATIVE_FLOAT, &diameter);
  });
  const auto opened = open_library(file());
  ASSERT_TRUE(opened) << "the directory counts: " << opened.error().message;
  EXPECT_EQ(opened->models[0].diameter, models_[0].diameter);
  expect_refused("@checksum");
}

TEST_F(LibraryDamageTest, ReadsARewrittenFileByItsGroups) {
  const Model& model = models_[0];
  edit_library(file(), [&](hid_t root) {  // a directory whose stated address is wrong
    const std::uint64_t offset = 8;
    replace_attribute(root, "directory", "offset", H5T_NATIVE_UINT64, &offset);
    const float diameter = 7;
    replace_attribute(root, "models/a", "diameter", H5T_NATIVE_FLOAT, &diameter);
  });
  const auto tree = open_library(file());
  ASSERT_FALSE(tree) << "its checksums count";
  EXPECT_NE(tree.error().message.find("@checksum"), std::string::npos);
  seal_library(file());
  const auto library = open_library(file());
  ASSERT_TRUE(library) << library.error().message;
  EXPECT_EQ(library->models[0].diameter, 7);
  Model read = *library->model(0);
  read.diameter = model.diameter;
  EXPECT_EQ(difference(read, model), "");
}

TEST_F(LibraryDamageTest, RefusesWhatIsNoLibrary) {
  write_file({});
  expect_refused("another kind of file");
  const std::string text = "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n";
  write_file(text);
  expect_refused("found a PLY file");

  fs::remove(file());
  expect_refused("", {ErrorCode::missing_input});
  fs::create_directory(file());
  expect_refused("regular file");
  fs::remove(file());
  ASSERT_EQ(::mkfifo(file().c_str(), 0600), 0);
  expect_refused("regular file");
}

TEST_F(LibraryDamageTest, RefusesOtherHdf5Files) {
  hdf5::start();
  fs::remove(file());
  { const Handle old(H5Fcreate(file().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)); }
  expect_refused("superblock");  // a superblock of version 0 has no checksums
  {
    const Handle access = hdf5::file_access();
    const Handle empty(H5Fcreate(file().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()));
  }
  expect_refused("no model library");
}

TEST_F(LibraryDamageTest, RefusesAnotherMajorVersionAndNamesItsWriter) {
  const std::uint32_t version = kLibraryVersionMajor + 1;
  edit_library(file(), [&](hid_t root) {
    replace_attribute(root, "/", "format_version_major", H5T_NATIVE_UINT32, &version);
  });
  expect_refused("found 2, written by trivet test");
}

TEST_F(LibraryDamageTest, ReadsANewerMinorVersionAndIgnoresItsAdditions) {
  const std::uint32_t version = kLibraryVersionMinor + 1;
  const float value = 1;
  edit_library(file(), [&](hid_t root) {
    replace_attribute(root, "/", "format_version_minor", H5T_NATIVE_UINT32, &version);
    const Handle group(H5Gcreate2(root, "models/a/extra", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    const Handle space(H5Screate(H5S_SCALAR));
    const Handle data(H5Dcreate2(group.get(), "value", H5T_IEEE_F32LE, space.get(), H5P_DEFAULT,
                                 H5P_DEFAULT, H5P_DEFAULT));
    H5Dwrite(data.get(), H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value);
  });
  seal_library(file());
  const auto library = open_library(file());
  ASSERT_TRUE(library) << library.error().message;
  expect_refused_or_equal("newer minor version");
}

TEST_F(LibraryDamageTest, ReadsOlderMinorVersionsWithoutWhatCameLaterAndNotWithIt) {
  std::vector<Model> expected = models_;
  const auto expect_older = [&](std::uint32_t version, const std::string& dataset) {
    edit_library(file(), [&](hid_t root) {
      replace_attribute(root, "/", "format_version_minor", H5T_NATIVE_UINT32, &version);
    });
    seal_library(file());
    expect_refused("/models/a/" + dataset);
    edit_library(file(), [&](hid_t root) {
      for (const char* model : {"models/a/", "models/b/"})
        ASSERT_GE(H5Ldelete(root, (model + dataset).c_str(), H5P_DEFAULT), 0);
    });
    seal_library(file());
    const auto library = open_library(file());
    ASSERT_TRUE(library) << library.error().message;
    EXPECT_EQ(library->version_minor, version);
    for (std::uint32_t i = 0; i < expected.size(); ++i)
      EXPECT_EQ(difference(*library->model(i), expected[i]), "");
  };
  edit_library(file(), [](hid_t root) {
    const std::uint32_t version = 2;
    replace_attribute(root, "/", "format_version_minor", H5T_NATIVE_UINT32, &version);
  });
  seal_library(file());
  expect_refused("/trisi: the format has no such group");
  edit_library(file(), [](hid_t root) {
    for (const char* const name : {"trisi", "models/a/trisi_2x", "models/a/trisi_4x",
                                   "models/b/trisi_2x", "models/b/trisi_4x"})
      ASSERT_GE(H5Ldelete(root, name, H5P_DEFAULT), 0);
  });
  for (Model& model : expected) {
    model.features = {};
    model.fingerprint.clear();
  }
  expect_older(2, "trisi");
  for (Model& model : expected) model.near_axis.reset();
  expect_older(1, "near_axis");
  for (Model& model : expected) model.near_symmetries.clear();
  expect_older(0, "near_symmetries");
}

TEST_F(LibraryDamageTest, RefusesSoftAndExternalLinks) {
  const auto whole = read_bytes(file());
  fs::copy_file(file(), folder() / "other.h5");
  const auto replace_link = [&](auto create) {
    write_file(whole);
    edit_library(file(), [&](hid_t root) {
      ASSERT_GE(H5Ldelete(root, kVertices.c_str(), H5P_DEFAULT), 0);
      ASSERT_GE(create(root), 0);
    });
    expect_refused("soft or external link");
  };
  replace_link([](hid_t root) {
    return H5Lcreate_soft("/models/b/vertices", root, kVertices.c_str(), H5P_DEFAULT, H5P_DEFAULT);
  });
  replace_link([&](hid_t root) {
    return H5Lcreate_external((folder() / "other.h5").c_str(), kVertices.c_str(), root,
                              kVertices.c_str(), H5P_DEFAULT, H5P_DEFAULT);
  });
}

TEST_F(LibraryDamageTest, RefusesAnObjectThatIsLinkedTwice) {
  const auto whole = read_bytes(file());
  for (const char* const second : {"models/a/loop", "models/c"}) {
    write_file(whole);
    edit_library(file(), [&](hid_t root) {
      ASSERT_GE(H5Lcreate_hard(root, "models/a", root, second, H5P_DEFAULT, H5P_DEFAULT), 0);
    });
    expect_refused("second link");
  }
}

TEST_F(LibraryDamageTest, RefusesDataOutsideTheFileOrBehindFilters) {
  const auto whole = read_bytes(file());
  const auto replace = [&](const std::string& text, auto set) {
    write_file(whole);
    edit_library(file(), [&](hid_t root) {
      const Handle creation(H5Pcreate(H5P_DATASET_CREATE));
      ASSERT_GE(set(creation.get()), 0);
      replace_dataset(root, kVertices, H5T_IEEE_F32LE, kVerticesShape, creation.get());
    });
    expect_refused(text);
  };
  replace("external storage", [](hid_t p) { return H5Pset_external(p, "/etc/hostname", 0, 600); });
  replace("contiguous", [](hid_t p) { return H5Pset_chunk(p, 2, kVerticesShape); });
  replace("contiguous", [](hid_t p) {
    return std::min(H5Pset_chunk(p, 2, kVerticesShape), H5Pset_deflate(p, 9));
  });
  replace("contiguous", [](hid_t p) { return H5Pset_layout(p, H5D_COMPACT); });
  replace("contiguous", [&](hid_t p) {
    const Handle space(H5Screate_simple(2, kVerticesShape, nullptr));
    return H5Pset_virtual(p, space.get(), (folder() / "other.h5").c_str(), "/x", space.get());
  });
}

TEST_F(LibraryDamageTest, RefusesOtherTypesAndShapes) {
  const auto whole = read_bytes(file());
  const auto replace = [&](const std::string& text, hid_t type, std::span<const hsize_t> shape) {
    write_file(whole);
    edit_library(file(), [&](hid_t root) {
      const Handle creation(H5Pcreate(H5P_DATASET_CREATE));
      ASSERT_GE(H5Pset_alloc_time(creation.get(), H5D_ALLOC_TIME_LATE), 0);
      replace_dataset(root, kVertices, type, shape, creation.get());
      if (text ==
          "expected float32") {  // refused by the reader's table, not by the structure check
        const Handle dataset(H5Dopen2(root, kVertices.c_str(), H5P_DEFAULT));
        const std::vector<char> zeros(4096);
        ASSERT_GE(H5Dwrite(dataset.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, zeros.data()), 0);
      }
    });
    if (text == "expected float32") seal_library(file());
    expect_refused(text);
  };
  replace("another type", H5T_IEEE_F64LE, kVerticesShape);
  replace("another type", H5T_IEEE_F32BE, kVerticesShape);
  replace("another type", H5T_STD_I32LE, kVerticesShape);
  replace("another type", H5T_STD_REF_OBJ, kVerticesShape);
  replace("expected float32", H5T_STD_U32LE, kVerticesShape);
  replace("expected float32", H5T_IEEE_F32LE, std::array<hsize_t, 2>{2, 75});
  replace("expected float32", H5T_IEEE_F32LE, std::array<hsize_t, 1>{150});
  replace("at most 4 dimensions", H5T_IEEE_F32LE, std::array<hsize_t, 5>{1, 1, 1, 1, 1});
  replace("more bytes than", H5T_IEEE_F32LE, std::array<hsize_t, 2>{3, hsize_t{1} << 59});
  replace("more bytes than", H5T_IEEE_F32LE, std::array<hsize_t, 2>{3, 1'000'000});
  replace("to lie elsewhere", H5T_IEEE_F32LE,
          kVerticesShape);  // never written, so it has no address
}

TEST_F(LibraryDamageTest, RefusesUnknownAndMissingObjects) {
  const auto whole = read_bytes(file());
  const auto change = [&](const std::string& text, auto edit) {
    write_file(whole);
    edit_library(file(), [&](hid_t root) { ASSERT_GE(edit(root), 0); });
    seal_library(file());
    expect_refused(text);
  };
  const auto group = [](hid_t root, const char* path) {
    const Handle made(H5Gcreate2(root, path, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    return made ? 0 : -1;
  };
  const auto remove = [](hid_t root, const char* path) {
    return H5Ldelete(root, path, H5P_DEFAULT);
  };
  change("/models/a/extra", [&](hid_t root) { return group(root, "models/a/extra"); });
  change("/extra", [&](hid_t root) { return group(root, "extra"); });
  change("/models/a/ppf/copy", [](hid_t root) {
    return H5Ocopy(root, kVertices.c_str(), root, "models/a/ppf/copy", H5P_DEFAULT, H5P_DEFAULT);
  });
  change("expected 2 groups", [&](hid_t root) { return group(root, "models/c"); });
  change("expected 2 groups", [&](hid_t root) { return remove(root, "models/a"); });
  change("/models/a/vertices", [&](hid_t root) { return remove(root, kVertices.c_str()); });
  change("/models/a/near_symmetries",
         [&](hid_t root) { return remove(root, "models/a/near_symmetries"); });
  change("/models/a/ppf", [&](hid_t root) { return remove(root, "models/a/ppf"); });
  change("/models", [&](hid_t root) { return remove(root, "models"); });
  change("/models/a/trisi: expected this group",
         [&](hid_t root) { return remove(root, "models/a/trisi"); });
  change("/models/a/trisi: expected the group /trisi beside it",
         [&](hid_t root) { return remove(root, "trisi"); });
  change("/trisi/mean", [&](hid_t root) { return remove(root, "trisi/mean"); });
  change("/models/a@diameter",
         [](hid_t root) { return H5Adelete_by_name(root, "models/a", "diameter", H5P_DEFAULT); });
  change("model name", [](hid_t root) {
    return H5Lmove(root, "models/a", root, "models/..x", H5P_DEFAULT, H5P_DEFAULT);
  });
}

// Their squares and cubes are no floats, and rays from there end a process in Embree.
TEST_F(LibraryDamageTest, RefusesLengthsThatCannotBeComputedWith) {
  const auto whole = read_bytes(file());
  for (const float length : {3.4e38F, 1e19F, 1e13F, 1e-13F, 1e-45F, 0.0F, -1.0F}) {
    for (const auto& [object, name] : {std::pair("models/a", "diameter"),
                                       {"models/a/trisi", "resolution"},
                                       {"models/a/ppf", "distance_step"},
                                       {"trisi", "support"}}) {
      write_file(whole);
      edit_library(file(), [&, object = object, name = name](hid_t root) {
        replace_attribute(root, object, name, H5T_NATIVE_FLOAT, &length);
      });
      seal_library(file());
      expect_refused(fmt::format("{}: expected a", name));
    }
  }
  write_file(whole);
  edit_library(file(), [](hid_t root) {
    const std::vector<float> far(3 * 50, 1e13F);
    replace_data(root, kVertices, std::as_bytes(std::span(far)));
  });
  seal_library(file());
  expect_refused("vertices[0]: expected coordinates of at most 1e12");
}

TEST_F(LibraryDamageTest, RefusesFeaturesWithoutTheirComponentsBesideADirectory) {
  edit_library(file(), [](hid_t root) { ASSERT_GE(H5Ldelete(root, "trisi", H5P_DEFAULT), 0); });
  test::seal_beside_directory(file());
  const auto library = open_library(file());
  ASSERT_FALSE(library);
  EXPECT_NE(library.error().message.find("/trisi: expected the components"), std::string::npos)
      << library.error().message;
}

TEST_F(LibraryDamageTest, RefusesChangedNamesAndAttributesByTheChecksumOfTheFile) {
  const auto whole = read_bytes(file());
  edit_library(file(), [](hid_t root) {
    ASSERT_GE(H5Lmove(root, "models/a", root, "models/c", H5P_DEFAULT, H5P_DEFAULT), 0);
  });
  expect_refused("@checksum");
  write_file(whole);
  const float diameter = 7;
  edit_library(file(), [&](hid_t root) {
    replace_attribute(root, "models/a", "diameter", H5T_NATIVE_FLOAT, &diameter);
  });
  expect_refused("@checksum");
}

TEST_F(LibraryDamageTest, RefusesAttributesOfVariableLength) {
  edit_library(file(), [](hid_t root) {
    const Handle type(H5Tcopy(H5T_C_S1));
    H5Tset_size(type.get(), H5T_VARIABLE);
    const Handle space(H5Screate(H5S_SCALAR));
    const Handle made(H5Acreate2(root, "note", type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT));
    ASSERT_TRUE(made);
  });
  expect_refused("@note");
}

// Each value is set with valid checksums, so only the check of the content can detect it.
TEST_F(LibraryDamageTest, RefusesContentThatRecognitionCouldNotUse) {
  const auto whole = read_bytes(file());
  const Model& model = models_[0];
  const auto reseal = [&](const std::string& text, auto edit) {
    write_file(whole);
    edit_library(file(), edit);
    seal_library(file());
    expect_refused(text);
  };
  const auto data = [](const std::string& path, const auto& values) {
    return [path, bytes = std::as_bytes(std::span(values))](hid_t root) {
      replace_data(root, path, bytes);
    };
  };

  std::vector<std::uint32_t> offsets(model.ppf.offsets.begin(), model.ppf.offsets.end());
  offsets[100] = offsets[99] - 1;
  reseal("ppf/offsets[100]", data("models/a/ppf/offsets", offsets));
  offsets.assign(model.ppf.offsets.begin(), model.ppf.offsets.end());
  offsets[0] = 1;
  reseal("ppf/offsets[0]", data("models/a/ppf/offsets", offsets));
  offsets[0] = 0;
  offsets.back() += 1;
  reseal("ppf/entries", data("models/a/ppf/offsets", offsets));

  std::vector<PpfEntry> entries(model.ppf.entries.begin(), model.ppf.entries.end());
  entries[7].reference = 30;
  reseal("ppf/entries[7]: expected a reference below 30, found 30",
         data("models/a/ppf/entries", entries));
  entries.assign(model.ppf.entries.begin(), model.ppf.entries.end());
  const auto fuller = std::ranges::adjacent_find(
      model.ppf.offsets, [](std::uint32_t a, std::uint32_t b) { return b > a + 1; });
  ASSERT_NE(fuller, model.ppf.offsets.end());
  entries[*fuller] = {29, 9};
  entries[*fuller + 1] = {29, 8};
  reseal(fmt::format("ppf/entries[{}]: expected cell {} sorted by reference, then angle",
                     *fuller + 1, fuller - model.ppf.offsets.begin()),
         data("models/a/ppf/entries", entries));

  std::vector<std::uint32_t> triangles(3 * model.triangles.size(), 0);
  triangles[81] = 50;
  reseal("triangles[1]: expected an index below 50, found 50",
         data("models/a/triangles", triangles));

  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> vertices(150, 0);
  vertices[149] = nan;
  reseal("vertices[49]", data(kVertices, vertices));
  reseal("ppf/normals[0]", data("models/a/ppf/normals", std::vector<float>(90, 0)));
  reseal("sample_normals[0]", data("models/a/sample_normals", std::vector<float>(120, 1)));
  reseal("symmetry_poses[0]", data("models/a/symmetry_poses", std::vector<float>(48, 1)));
  reseal("near_axis: expected a unit direction",
         data("models/a/near_axis", std::vector<float>(6, 2)));
  reseal("trisi/frames[0]", data("models/a/trisi/frames", std::vector<float>(180, 1)));
  std::vector<float> mean(675, 0);
  mean[9] = nan;
  reseal("trisi/mean[9]", data("trisi/mean", mean));
  reseal("near_symmetries[0]", data("models/a/near_symmetries", std::vector<float>(32, 1)));

  const auto number = [](const char* object, const char* name, hid_t type, auto value) {
    return [=](hid_t root) { replace_attribute(root, object, name, type, &value); };
  };
  reseal("diameter", number("models/a", "diameter", H5T_NATIVE_FLOAT, nan));
  reseal("distance_step", number("models/a/ppf", "distance_step", H5T_NATIVE_FLOAT, -1.0F));
  reseal("num_angle_bins",
         number("models/a/ppf", "num_angle_bins", H5T_NATIVE_UINT32, 0x80000000U));
  reseal("ppf/offsets", number("models/a/ppf", "num_distance_bins", H5T_NATIVE_UINT32, 7U));
  reseal("trisi/support", number("trisi", "support", H5T_NATIVE_FLOAT, nan));
  reseal("trisi/code_step", number("trisi", "code_step", H5T_NATIVE_FLOAT, 0.0F));
  reseal("resolution", number("models/a/trisi", "resolution", H5T_NATIVE_FLOAT, -1.0F));
}

}  // namespace
}  // namespace trivet

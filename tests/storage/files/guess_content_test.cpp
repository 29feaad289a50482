// A file whose content is recognized is refused with the name of its format, whatever its
// extension.
#include "storage/files/guess_content.hpp"

#include <gtest/gtest.h>

#include <string>

#include "storage/files/json_file.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using namespace std::string_literals;

std::string what(const std::string& bytes) {
  return std::string(formats::guess_content(std::as_bytes(std::span(bytes))).what);
}

std::string utf16(std::string_view text, bool big_endian, bool with_mark) {
  std::string out = !with_mark ? ""s : big_endian ? "\xFE\xFF"s : "\xFF\xFE"s;
  for (const char c : text) out += big_endian ? std::string{'\0', c} : std::string{c, '\0'};
  return out;
}

const std::string kPage = "\n<!DOCTYPE html>\n<html><body>Sign in</body></html>\n";
const std::string kPointer =
    "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n";

TEST(GuessContent, RecognizesFrequentWrongInputs) {
  EXPECT_EQ(what(kPage), "an HTML page");
  EXPECT_EQ(what("\xEF\xBB\xBF<HTML>"), "an HTML page");
  EXPECT_EQ(what(kPointer), "a pointer of Git LFS");
  EXPECT_EQ(what("\x1F\x8B\x08"), "a gzip archive");
  EXPECT_EQ(what("PK\x03\x04"), "a ZIP archive");
  EXPECT_EQ(what("ply\r\nformat"), "a PLY file");
  EXPECT_EQ(what("{\n  \"fx\": 1}"), "a JSON document");
  EXPECT_EQ(what(std::string(1000, '\0')), "nothing but zero bytes");
  EXPECT_EQ(what(" \n\t\r\n"), "nothing but blanks");
  for (const bool big : {false, true}) {
    for (const bool mark : {false, true})
      EXPECT_EQ(what(utf16("1.5 2.5 3.5\r\n", big, mark)), "text in UTF-16");
  }
}

TEST(GuessContent, SaysNothingOfWhatMayBeGeometry) {
  for (const auto& text : {""s, "1 2 3\n"s, "v 0 0 0\n"s, "\x01\x02\x03"s, "1"s, "x,y,z\n1,2,3\n"s})
    EXPECT_EQ(what(text), "") << text;
}

TEST(GuessContent, IsReportedByEveryReader) {
  const test::TempDir folder;
  for (const std::string extension :
       {".ply", ".pcd", ".obj", ".stl", ".off", ".xyz", ".txt", ".asc", ".csv", ".pts", ".png"}) {
    const auto refused = [&](const std::string& bytes, std::string_view text) {
      return test::is_refused(
          read_cloud(folder.write("file" + extension, bytes), test::kReadOptions), text);
    };
    EXPECT_TRUE(refused(kPage, "expected a " + extension + " file, found an HTML page"));
    EXPECT_TRUE(refused(kPointer, "found a pointer of Git LFS; fetch the file itself"));
    EXPECT_TRUE(refused(utf16("1.5 2.5 3.5\r\n", false, true), "found text in UTF-16; save it as"));
    EXPECT_TRUE(refused(std::string(300, '\0'), "found nothing but zero bytes"));
    EXPECT_TRUE(refused(" \n \n", "found nothing but blanks"));
  }
}

TEST(GuessContent, IsReportedForJsonFiles) {
  const test::TempDir folder;
  const auto read = with_json(folder.write("camera.json", kPage), [](const JsonNode&) {});
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("expected JSON, found an HTML page"), std::string::npos);
}

TEST(JsonNode, NamesTheMembersThatAreThereInsteadOfTheOneThatIsNot) {
  const test::TempDir folder;
  const auto refusal = [&](const std::string& text) {
    const auto camera = read_camera(folder.write("camera.json", text));
    return camera ? "" : camera.error().message;
  };
  EXPECT_NE(refusal(R"({"fx": 500, "fy": 500})").find("expected \"cx\", found \"fx\", \"fy\""),
            std::string::npos);
  EXPECT_NE(refusal(R"({"fx": [1, 2]})").find("fx: expected a number, found an array of 2"),
            std::string::npos);
}

}  // namespace
}  // namespace trivet

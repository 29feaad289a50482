#include "storage/files/text.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

const std::string kMark = "\xEF\xBB\xBF";

TEST(TextCursor, EndsLinesAsTheFirstOneEnds) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    const std::string text = "a b" + end + end + "c" + end;  // a cursor only refers to the text
    formats::TextCursor cursor(text);
    EXPECT_EQ(cursor.rest_of_line(), "a b");
    EXPECT_EQ(cursor.word(), "a");
    EXPECT_EQ(cursor.rest_of_line(), " b");
    EXPECT_EQ(cursor.next_word(), "b");
    EXPECT_EQ(cursor.word(), "");
    EXPECT_EQ(cursor.next_word(), "c");
    EXPECT_EQ(cursor.line(), 3U);
    EXPECT_EQ(cursor.next_word(), "");
  }
}

TEST(TextCursor, SkipsAByteOrderMark) {
  const std::string text = kMark + "one two";
  formats::TextCursor cursor(text);
  EXPECT_EQ(cursor.word(), "one");
  EXPECT_EQ(cursor.position(), 6U);
}

/// The text with other line endings.
std::string ended(const std::string& text, const std::string& end) {
  std::string out;
  for (const char c : text) out += c == '\n' ? end : std::string(1, c);
  return out;
}

TEST(TextFiles, GiveTheSameCloudWithAnyLineEndsAndAByteOrderMark) {
  const test::TempDir folder;
  for (const auto& file : test::sample_files()) {
    if (file.bytes.find('\0') != std::string::npos) continue;  // skips binary files
    const auto plain = read_cloud(folder.write(file.name, file.bytes));
    ASSERT_TRUE(plain) << plain.error().message;
    for (const std::string& bytes : {ended(file.bytes, "\r\n"), ended(file.bytes, "\r"),
                                     kMark + file.bytes, kMark + ended(file.bytes, "\r")}) {
      const auto cloud = read_cloud(folder.write(file.name, bytes));
      ASSERT_TRUE(cloud) << cloud.error().message;
      EXPECT_EQ(encode_ply(*cloud), encode_ply(*plain)) << file.name;
    }
  }
}

}  // namespace
}  // namespace trivet

#include "storage/common/valid_text.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "storage/files/json_text.hpp"
#include "support/random.hpp"

namespace trivet {
namespace {

using test::Random;

using namespace std::string_literals;

const std::string kReplaced = "\xEF\xBF\xBD";

struct BytesCase {
  std::string what, bytes, valid, printable;
};

std::vector<BytesCase> bytes_cases() {
  const std::string r = kReplaced;
  return {
      {"nothing", "", "", ""},
      {"ASCII", "a b~", "a b~", "a b~"},
      {"two bytes", "Geh\xC3\xA4use", "Geh\xC3\xA4use", "Geh\xC3\xA4use"},
      {"Latin-1", "Geh\xE4use.ply", "Geh" + r + "use.ply", "Geh" + r + "use.ply"},
      {"three bytes", "\xE6\xAD\xAF", "\xE6\xAD\xAF", "\xE6\xAD\xAF"},
      {"four bytes", "\xF0\x9F\x94\xA9", "\xF0\x9F\x94\xA9", "\xF0\x9F\x94\xA9"},
      {"the last code point", "\xF4\x8F\xBF\xBF", "\xF4\x8F\xBF\xBF", "\xF4\x8F\xBF\xBF"},
      {"beyond the last", "\xF4\x90\x80\x80", r + r + r + r, r + r + r + r},
      {"overlong of two", "\xC0\xAF", r + r, r + r},
      {"overlong NUL", "\xC0\x80", r + r, r + r},
      {"overlong of three", "\xE0\x9F\xBF", r + r + r, r + r + r},
      {"overlong of four", "\xF0\x8F\xBF\xBF", r + r + r + r, r + r + r + r},
      {"a surrogate", "\xED\xA0\x80", r + r + r, r + r + r},
      {"before the surrogates", "\xED\x9F\xBF", "\xED\x9F\xBF", "\xED\x9F\xBF"},
      {"no lead byte", "\xF8\x88\xFE\xFF", r + r + r + r, r + r + r + r},
      {"a lonely continuation", "a\x80z", "a" + r + "z", "a" + r + "z"},
      // The longest invalid prefix of a character becomes one replacement.
      {"cut off in four", "\xF0\x9F\x94", r, r},
      {"cut off in three", "x\xE6\xAD", "x" + r, "x" + r},
      {"cut off by another", "\xE6\xAD\x41", r + "A", r + "A"},
      {"cut off by a lead byte", "\xE6\xC3\xA4", r + "\xC3\xA4", r + "\xC3\xA4"},
      {"C0", "\0\a\b\x1B[2J\x1F"s, "\0\a\b\x1B[2J\x1F"s, R"(\u0000\u0007\u0008\u001B[2J\u001F)"},
      {"lines", "a\r\n\tb", "a\r\n\tb", R"(a\r\n\tb)"},
      {"DEL", "\x7F", "\x7F", R"(\u007F)"},
      {"C1", "\xC2\x80\xC2\x9B\x31m\xC2\x9F\xC2\xA0", "\xC2\x80\xC2\x9B\x31m\xC2\x9F\xC2\xA0",
       "\\u0080\\u009B1m\\u009F\xC2\xA0"},
      {"breaks", "\xE2\x80\xA8\xE2\x80\xA9", "\xE2\x80\xA8\xE2\x80\xA9", R"(\u2028\u2029)"},
      {"marks that reorder", "\xE2\x80\xAEyl\xE2\x81\xA6\xD8\x9C",
       "\xE2\x80\xAEyl\xE2\x81\xA6\xD8\x9C", R"(\u202Eyl\u2066\u061C)"},
      {"a backslash", "a\\n", "a\\n", "a\\n"},
  };
}

TEST(ValidText, TurnsAnyBytesIntoTextAsTheUnicodeStandardRecommends) {
  for (const BytesCase& c : bytes_cases()) {
    EXPECT_EQ(valid_utf8(c.bytes), c.valid) << c.what;
    EXPECT_EQ(printable(c.bytes), c.printable) << c.what;
    EXPECT_EQ(is_utf8(c.bytes), c.valid == c.bytes) << c.what;
  }
  EXPECT_EQ(printable_lines("a\r\n\x1B\tb\n\xFF"), "a\\r\n\\u001B\tb\n" + kReplaced);
}

/// Random bytes, many of which are the bounds of the ranges in UTF-8.
std::string random_bytes(Random& random, std::size_t n) {
  static constexpr unsigned char kBytes[] = {0,    0x1B, 'a',  0x7F, 0x80, 0x8F, 0x90, 0x9F,
                                             0xA0, 0xBF, 0xC0, 0xC1, 0xC2, 0xDF, 0xE0, 0xE1,
                                             0xED, 0xEF, 0xF0, 0xF1, 0xF3, 0xF4, 0xF5, 0xFF};
  std::string bytes;
  for (std::size_t i = 0; i < n; ++i)
    bytes += static_cast<char>(kBytes[random.below(std::size(kBytes))]);
  return bytes;
}

TEST(ValidText, PassesStrictJson) {
  Random random;
  for (int i = 0; i < 20'000; ++i) {
    const std::string bytes = random_bytes(random, random.below(12));
    const std::string valid = valid_utf8(bytes), shown = printable(bytes);
    EXPECT_NO_THROW(nlohmann::json(valid).dump());
    EXPECT_NO_THROW(nlohmann::json(shown).dump());
    EXPECT_TRUE(is_utf8(valid));
    EXPECT_EQ(valid_utf8(valid), valid);
    EXPECT_EQ(shown.find_first_of("\x1B\x7F\n\a"), shown.npos);
  }
}

TEST(JsonText, AcceptsAnyBytesAndNeverActsOnATerminal) {
  Random random;
  for (int i = 0; i < 20'000; ++i) {
    const std::string bytes = random_bytes(random, random.below(12));
    const std::string text = json_text(nlohmann::json{{bytes, bytes}});
    const nlohmann::json read = nlohmann::json::parse(text);
    EXPECT_EQ(read.begin().key(), valid_utf8(bytes)) << text;
    EXPECT_EQ(read.begin().value(), valid_utf8(bytes)) << text;
    EXPECT_EQ(text, printable(text));
  }
}

TEST(JsonText, WritesTheDocumentAsItIs) {
  const nlohmann::ordered_json document{{"b", 1.5}, {"a", {1, "\xC3\xA4\xC2\xA9"}}};
  EXPECT_EQ(json_text(document), "{\"b\":1.5,\"a\":[1,\"\xC3\xA4\xC2\xA9\"]}");
  EXPECT_EQ(json_text(document, 1), document.dump(1));
  EXPECT_EQ(json_text(document, 0), document.dump(0));
}

}  // namespace
}  // namespace trivet

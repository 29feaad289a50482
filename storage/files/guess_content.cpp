#include "storage/files/guess_content.hpp"

#include <algorithm>

namespace trivet::formats {
namespace {

using namespace std::string_view_literals;

constexpr std::size_t kHeadBytes = 512;

struct Signature {
  std::string_view begin;
  ContentGuess content;
};

/// First bytes of files of a kind.
constexpr Signature kSignatures[] = {
    {"version https://git-lfs.github.com/spec/"sv,
     {"a pointer of Git LFS", "fetch the file itself with git lfs pull", {}}},
    {"\x1F\x8B"sv, {"a gzip archive", "unpack it", ".gz"}},
    {"PK\x03\x04"sv, {"a ZIP archive", "unpack it", ".zip"}},
    {"7z\xBC\xAF\x27\x1C"sv, {"a 7-Zip archive", "unpack it", ".7z"}},
    {"\x28\xB5\x2F\xFD"sv, {"a Zstandard archive", "unpack it", ".zst"}},
    {"%PDF-"sv, {"a PDF document", {}, ".pdf"}},
    {"\xFF\xD8\xFF"sv, {"a JPEG picture", {}, ".jpg"}},
    {"\x89PNG\r\n\x1A\n"sv, {"a PNG picture", "give it the extension .png", ".png"}},
    {"II*\0"sv, {"a TIFF picture", "give it the extension .tif", ".tif"}},
    {"MM\0*"sv, {"a TIFF picture", "give it the extension .tif", ".tif"}},
    {"\x89HDF\r\n\x1A\n"sv, {"an HDF5 file", {}, ".h5"}},
    {"glTF"sv, {"a binary glTF file", "give it the extension .glb", ".glb"}},
    {"\x93NUMPY"sv, {"a NumPy array", "give it the extension .npy", ".npy"}},
    {"ISO-10303-21;"sv, {"a STEP file", {}, ".step"}},
    {"ply\n"sv, {"a PLY file", "give it the extension .ply", ".ply"}},
    {"ply\r"sv, {"a PLY file", "give it the extension .ply", ".ply"}},
    {"# .PCD"sv, {"a PCD file", "give it the extension .pcd", ".pcd"}},
    {"OFF\n"sv, {"an OFF file", "give it the extension .off", ".off"}},
    {"OFF\r"sv, {"an OFF file", "give it the extension .off", ".off"}},
    {"solid "sv, {"an STL file", "give it the extension .stl", ".stl"}},
};

bool is_blank(char c) noexcept { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// Whether text begins with `lower`, ignoring case. `lower` is in lower case.
bool begins(std::string_view text, std::string_view lower) noexcept {
  return text.size() >= lower.size() &&
         std::equal(lower.begin(), lower.end(), text.begin(), [](char expected, char c) {
           return expected == (c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c);
         });
}

/// UTF-16 text has a byte-order mark or, for Latin letters, a zero in each pair of bytes.
bool is_utf16(std::string_view head) noexcept {
  if (head.starts_with("\xFF\xFE"sv) || head.starts_with("\xFE\xFF"sv)) return true;
  constexpr std::size_t kPairs = 8;
  if (head.size() < 2 * kPairs) return false;
  const auto is_text = [](char c) { return is_blank(c) || (c > ' ' && c <= '~'); };
  for (const std::size_t zero : {0U, 1U}) {
    std::size_t pair = 0;
    while (pair < kPairs && head[2 * pair + zero] == 0 && is_text(head[2 * pair + 1 - zero]))
      ++pair;
    if (pair == kPairs) return true;
  }
  return false;
}

}  // namespace

ContentGuess guess_content(std::span<const std::byte> bytes) noexcept {
  const std::string_view all(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::string_view head = all.substr(0, kHeadBytes);
  if (bytes.empty()) return {};
  for (const Signature& signature : kSignatures) {
    if (head.starts_with(signature.begin)) return signature.content;
  }
  if (is_utf16(head)) return {"text in UTF-16", "save it as UTF-8 or ASCII", {}};
  if (all.find_first_not_of('\0') == all.npos)
    return {"nothing but zero bytes", "the copy or download broke off; make it again", {}};
  if (std::all_of(all.begin(), all.end(), is_blank)) return {"nothing but blanks", {}, {}};

  const std::size_t mark = head.starts_with("\xEF\xBB\xBF"sv) ? 3 : 0;
  const auto* const first = std::find_if_not(head.begin() + mark, head.end(), is_blank);
  const std::string_view text = head.substr(static_cast<std::size_t>(first - head.begin()));
  if (begins(text, "<!doctype html") || begins(text, "<html"))
    return {"an HTML page", "download the file itself, not the page that shows it", {}};
  if (begins(text, "<?xml")) return {"an XML document", {}, ".xml"};
  if (begins(text, "{\"") || begins(text, "{\n") || begins(text, "{\r"))
    return {"a JSON document", {}, ".json"};
  if (begins(text, "ncols ")) return {"an ESRI grid of heights", "export points x y z", {}};
  return {};
}

}  // namespace trivet::formats

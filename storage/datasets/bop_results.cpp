#include "storage/datasets/bop_results.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "storage/datasets/bop.hpp"
#include "storage/files/file.hpp"
#include "storage/files/input.hpp"
#include "storage/files/text.hpp"

namespace trivet {
namespace {

constexpr std::string_view kHeader = "scene_id,im_id,obj_id,score,R,t,time";
constexpr std::uint64_t kMaxBytes = 1ULL << 30;
constexpr double kMaxNumber = 1e9;

/// Fault of a line.
struct Fault {
  std::string message;
};

int parse_id(std::string_view field, const char* name) {
  const auto id = parse_integer(field);
  if (!id || *id < 0 || *id > kMaxBopId)
    throw Fault{fmt::format("expected a number as {}, found {}", name, formats::quote(field))};
  return static_cast<int>(*id);
}

template <std::size_t count>
std::array<double, count> parse_numbers(std::string_view field, const char* name) {
  std::array<double, count> numbers{};
  formats::TextCursor cursor(field);
  for (double& number : numbers) {
    const auto value = parse_number(cursor.word());
    if (!value || !(std::abs(*value) <= kMaxNumber)) {
      throw Fault{fmt::format("expected {} numbers of at most 1e9 as {}, found {}", count, name,
                              formats::quote(field))};
    }
    number = *value;
  }
  if (const auto more = cursor.word(); !more.empty()) {
    throw Fault{
        fmt::format("expected {} numbers as {}, found {} too", count, name, formats::quote(more))};
  }
  return numbers;
}

/// Within 0.01 of a rotation: to first order, an error E of R shows as E R^T + R E^T in R R^T.
bool is_rotation(const Eigen::Matrix3d& R) {
  const Eigen::Matrix3d excess = R * R.transpose() - Eigen::Matrix3d::Identity();
  return excess.cwiseAbs().maxCoeff() <= 0.02 && R.determinant() > 0;
}

BopResult parse_line(std::string_view line) {
  std::array<std::string_view, 7> fields;
  if (std::count(line.begin(), line.end(), ',') != 6)
    throw Fault{fmt::format("expected seven fields, {}, found {}", kHeader, formats::quote(line))};
  for (std::string_view& field : fields) {
    field = line.substr(0, line.find(','));
    line.remove_prefix(std::min(field.size() + 1, line.size()));
  }

  BopResult result;
  result.scene_id = parse_id(fields[0], "scene_id");
  result.image_id = parse_id(fields[1], "im_id");
  result.object_id = parse_id(fields[2], "obj_id");
  result.score = parse_numbers<1>(fields[3], "score")[0];
  const auto R = parse_numbers<9>(fields[4], "R");
  result.R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data());
  if (!is_rotation(result.R))
    throw Fault{fmt::format("expected a rotation as R, found {}", formats::quote(fields[4]))};
  result.t_mm = Eigen::Map<const Eigen::Vector3d>(parse_numbers<3>(fields[5], "t").data());
  result.seconds = parse_numbers<1>(fields[6], "time")[0];
  if (!(result.seconds >= 0 || result.seconds == -1)) {
    throw Fault{fmt::format("expected seconds or -1 as time, found {}", formats::quote(fields[6]))};
  }
  return result;
}

/// Times of the images; all lines of an image must agree.
class ImageTimes {
 public:
  void check(const BopResult& result) {
    const auto [known, is_new] =
        seconds_.emplace(std::pair(result.scene_id, result.image_id), result.seconds);
    if (!is_new && !(std::abs(known->second - result.seconds) <= 0.001)) {
      throw Fault{fmt::format("expected the time {} as in the lines above of this image, found {}",
                              known->second, result.seconds)};
    }
  }

 private:
  std::map<std::pair<int, int>, double> seconds_;
};

}  // namespace

bool is_bop_result_name(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  const std::string_view stem = std::string_view(name).substr(0, name.find('.'));
  const std::size_t method = stem.find('_');
  if (method == 0 || method == std::string_view::npos) return false;
  std::string_view data = stem.substr(method + 1);
  data = data.substr(0, data.find('_'));
  const std::size_t dash = data.find('-');
  return dash != 0 && dash != std::string_view::npos && dash + 1 < data.size() &&
         data[dash + 1] != '-';
}

Result<void> write_bop_results(const std::filesystem::path& file,
                               std::span<const BopResult> results) {
  std::string text = fmt::format("{}\n", kHeader);
  auto out = std::back_inserter(text);
  for (const BopResult& result : results) {
    const auto& R = result.R;
    const auto& t = result.t_mm;
    fmt::format_to(out, "{},{},{},{},{} {} {} {} {} {} {} {} {},{} {} {},{}\n", result.scene_id,
                   result.image_id, result.object_id, result.score, R(0, 0), R(0, 1), R(0, 2),
                   R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2), t.x(), t.y(), t.z(),
                   result.seconds);
  }
  return publish_file(file, std::as_bytes(std::span(text)));
}

Result<std::vector<BopResult>> read_bop_results(const std::filesystem::path& file) {
  TRIVET_TRY_ASSIGN(const auto read, read_text_file(file, kMaxBytes));
  std::string_view text = read;
  std::vector<BopResult> results;
  ImageTimes times;
  std::size_t line_number = 0;
  try {
    while (!text.empty()) {
      ++line_number;
      std::string_view line = text.substr(0, text.find('\n'));
      text.remove_prefix(std::min(line.size() + 1, text.size()));
      if (line.ends_with('\r')) line.remove_suffix(1);
      if (line_number == 1) {
        if (line != kHeader)
          throw Fault{
              fmt::format("expected the header {}, found {}", kHeader, formats::quote(line))};
      } else if (!line.empty()) {
        results.push_back(parse_line(line));
        times.check(results.back());
      }
    }
    if (line_number == 0)
      throw Fault{fmt::format("expected the header {}, found nothing", kHeader)};
    return results;
  } catch (const Fault& fault) {
    return Error{ErrorCode::bad_data,
                 fmt::format("{}, line {}: {}", file.string(), line_number, fault.message)};
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::no_memory, fmt::format("{}: {}", file.string(), kOutOfMemory)};
  }
}

}  // namespace trivet

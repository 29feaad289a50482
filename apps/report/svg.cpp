#include "apps/report/svg.hpp"

#include <fmt/format.h>

#include "apps/report/html.hpp"

namespace trivet::apps {

std::string svg_start(double width, double height, std::string_view label) {
  return fmt::format(
      "<svg class=\"chart\" viewBox=\"0 0 {} {:.0f}\" role=\"img\" aria-label=\"{}\">", width,
      height, escape_html(label));
}

std::string svg_text(std::string_view style, double x, double y, std::string_view text) {
  return fmt::format("<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", style, x, y,
                     escape_html(text));
}

std::string svg_upward_name(double x, double y, std::string_view text) {
  return fmt::format(
      "<text class=\"mid name\" transform=\"translate({} {:.1f}) rotate(-90)\">{}</text>", x, y,
      escape_html(text));
}

std::string svg_dot(std::string_view style, double radius, double x, double y,
                    std::string_view title) {
  return fmt::format(
      "<circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"><title>{}</title></circle>", style,
      x, y, radius, escape_html(title));
}

}  // namespace trivet::apps

/// The pieces that charts are made of, as SVG within a page. Texts are plain.
#pragma once

#include <string>
#include <string_view>

namespace trivet::apps {

/// Opens a chart of this size, which "</svg>" ends.
std::string svg_start(double width, double height, std::string_view label);

/// Centered about x, or as `style` has it, on the line y.
std::string svg_text(std::string_view style, double x, double y, std::string_view text);

/// The name of a vertical axis, upward and centered about y.
std::string svg_upward_name(double x, double y, std::string_view text);

std::string svg_dot(std::string_view style, double radius, double x, double y,
                    std::string_view title);

}  // namespace trivet::apps

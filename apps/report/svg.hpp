/// The elements of charts, as inline SVG. Texts are plain.
#pragma once

#include <string>
#include <string_view>

namespace trivet::apps {

/// Begins a chart of this size, which "</svg>" ends.
std::string svg_start(double width, double height, std::string_view label);

/// A text on the line y, centered about x or aligned as defined by `style`.
std::string svg_text(std::string_view style, double x, double y, std::string_view text);

/// The name of a vertical axis, upward and centered about y.
std::string svg_upward_name(double x, double y, std::string_view text);

std::string svg_dot(std::string_view style, double radius, double x, double y,
                    std::string_view title);

}  // namespace trivet::apps

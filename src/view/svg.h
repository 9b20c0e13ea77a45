#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>

namespace retarget {

/// Escapes text for an XML element or attribute: `<`, `>`, `&` and quotes become entities,
/// characters that are invalid in XML or control a terminal become `?`, invalid UTF-8 becomes
/// U+FFFD.
[[nodiscard]] std::string xml_text(std::string_view text);

/// Assembles an SVG drawing. Coordinates in pixels, x right, y down, rounded to a tenth of a pixel.
class SvgWriter {
 public:
  /// Draws a line with round ends; a line of zero length is a disc.
  void stroke(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double width,
              std::string_view colour);
  /// Fills a convex area.
  /// @param corners    in order, as columns.
  /// @param rim        width of an outline with round corners in the same colour; 0: none.
  void area(const Eigen::Matrix2Xd& corners, std::string_view colour, double rim);
  /// @param text  any text; it is escaped.
  void label(const Eigen::Vector2d& middle, std::string_view text);

  /// Returns the whole file; `title` may be empty.
  [[nodiscard]] std::string finish(const Eigen::Vector2d& size, std::string_view title) const;

 private:
  std::string text_;
};

}  // namespace retarget

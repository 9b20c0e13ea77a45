#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>

namespace retarget {

/// A text as the content of an XML element or attribute: `<`, `>`, `&` and quotes as entities, what
/// XML does not take or a terminal would obey as `?`, bytes that are no UTF-8 as U+FFFD.
[[nodiscard]] std::string xml_text(std::string_view text);

/// Puts the parts of a drawing together. Pixels, x to the right, y down, a tenth of a pixel kept.
class SvgWriter {
 public:
  /// A line with round ends; of no length it is a disc.
  void stroke(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double width,
              std::string_view colour);
  /// @param corners    of a convex area, in order, as columns.
  /// @param rim        width of a line around it with round corners, in the same colour; 0: none.
  void area(const Eigen::Matrix2Xd& corners, std::string_view colour, double rim);
  /// @param text  any: it is made XML.
  void label(const Eigen::Vector2d& middle, std::string_view text);

  /// The whole file; `title` may be empty.
  [[nodiscard]] std::string finish(const Eigen::Vector2d& size, std::string_view title) const;

 private:
  std::string text_;
};

}  // namespace retarget

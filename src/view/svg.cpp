#include "view/svg.h"

#include <fmt/format.h>

#include "retarget/text.h"

namespace retarget {
namespace {

std::string place(const Eigen::Vector2d& point) {
  return number_text(point.x(), 1) + ' ' + number_text(point.y(), 1);
}

}  // namespace

std::string xml_text(std::string_view text) {
  std::string result;
  const std::string valid = valid_utf8(printable(text));
  for (std::size_t at = 0; at < valid.size(); ++at) {
    switch (valid[at]) {
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '&':
        result += "&amp;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\xEF':
        // U+FFFE and U+FFFF are valid in Unicode but not in XML.
        if (valid.compare(at, 3, "\xEF\xBF\xBE") == 0 ||
            valid.compare(at, 3, "\xEF\xBF\xBF") == 0) {
          result += '?';
          at += 2;
          break;
        }
        [[fallthrough]];
      default:
        result += valid[at];
    }
  }
  return result;
}

void SvgWriter::stroke(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double width,
                       std::string_view colour) {
  text_ += fmt::format("<path d=\"M{}L{}\" stroke=\"{}\" stroke-width=\"{}\"/>\n", place(from),
                       place(to), colour, number_text(width, 1));
}

void SvgWriter::area(const Eigen::Matrix2Xd& corners, std::string_view colour, double rim) {
  std::string outline;
  for (const auto& corner : corners.colwise()) {
    outline += outline.empty() ? 'M' : 'L';
    outline += place(corner);
  }
  text_ += fmt::format("<path d=\"{}Z\" fill=\"{}\"", outline, colour);
  if (rim > 0.0) {
    text_ += fmt::format(" stroke=\"{}\" stroke-width=\"{}\"", colour, number_text(rim, 1));
  }
  text_ += "/>\n";
}

void SvgWriter::label(const Eigen::Vector2d& middle, std::string_view text) {
  text_ += fmt::format("<text x=\"{}\" y=\"{}\">{}</text>\n", number_text(middle.x(), 1),
                       number_text(middle.y(), 1), xml_text(text));
}

std::string SvgWriter::finish(const Eigen::Vector2d& size, std::string_view title) const {
  const std::string width = number_text(size.x(), 0), height = number_text(size.y(), 0);
  std::string result = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
      "viewBox=\"0 0 {0} {1}\">\n",
      width, height);
  if (!title.empty()) result += "<title>" + xml_text(title) + "</title>\n";
  return result +
         "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
         "<g fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\" "
         "font-family=\"sans-serif\" font-size=\"12\" text-anchor=\"middle\">\n" +
         text_ + "</g>\n</svg>\n";
}

}  // namespace retarget

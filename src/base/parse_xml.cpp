#include "base/parse_xml.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <utility>

namespace retarget {
namespace {

// Begin and end of markup other than elements, as tinyxml2 distinguishes them.
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kOthers = {
    {{"<?", "?>"}, {"<!--", "-->"}, {"<![CDATA[", "]]>"}, {"<!", ">"}}};

// Position after the next `what`; the end of the text if there is none.
std::size_t behind(std::string_view text, std::string_view what, std::size_t from) {
  const std::size_t at = text.find(what, from);
  return at == std::string_view::npos ? text.size() : at + what.size();
}

// The end of a tag and the number of its quoted values.
struct Tag {
  std::size_t end = 0;
  int values = 0;
};
Tag tag_at(std::string_view text, std::size_t from) {
  Tag tag{from, 0};
  while (tag.end < text.size() && text[tag.end] != '>') {
    const char letter = text[tag.end];
    if (letter != '"' && letter != '\'') {
      ++tag.end;
      continue;
    }
    tag.end = behind(text, std::string_view(&letter, 1), tag.end + 1);
    ++tag.values;
  }
  return tag;
}

// Start of the first element with too many attributes.
std::optional<std::size_t> find_overlong_element(std::string_view text) {
  std::size_t at = text.find('<');
  while (at != std::string_view::npos) {
    const std::string_view rest = text.substr(at);
    const auto* other = std::ranges::find_if(
        kOthers, [&](const auto& kind) { return rest.starts_with(kind.first); });
    if (other != kOthers.end()) {
      at = behind(text, other->second, at + other->first.size());
    } else {
      const Tag tag = tag_at(text, at + 1);
      if (tag.values > kMaxXmlAttributes) return at;
      at = tag.end;
    }
    at = text.find('<', at);
  }
  return std::nullopt;
}

Failure xml_failure(std::string message, std::size_t line) {
  return failure({ErrorKind::kInput, {{}, line, 0}, std::move(message), {}, {}});
}

}  // namespace

Result<void> parse_xml(std::string_view text, tinyxml2::XMLDocument& document) {
  if (const auto at = find_overlong_element(text)) {
    const auto lines = std::ranges::count(text.substr(0, *at), '\n');
    return xml_failure(fmt::format("an element has more than {} attributes", kMaxXmlAttributes),
                       static_cast<std::size_t>(lines) + 1);
  }
  if (document.Parse(text.data(), text.size()) == tinyxml2::XML_SUCCESS) return {};
  return xml_failure(tinyxml2::XMLDocument::ErrorIDToName(document.ErrorID()),
                     static_cast<std::size_t>(std::max(document.ErrorLineNum(), 0)));
}

std::string attribute_of(const tinyxml2::XMLElement* element, const char* name) {
  const char* text = element == nullptr ? nullptr : element->Attribute(name);
  return text == nullptr ? std::string() : text;
}

}  // namespace retarget

#pragma once

#include <tinyxml2.h>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"

namespace retarget {

/// Maximum number of attributes of an element. Elements of models, meshes and motions have up to
/// 60.
inline constexpr int kMaxXmlAttributes = 100;

/// Parses XML in linear time. tinyxml2 compares each attribute of an element with all others, so
/// elements with more than kMaxXmlAttributes attributes are rejected. Errors (kInput, with the
/// line; callers add the file): such an element, or malformed XML; `document` then holds the
/// details.
[[nodiscard]] Result<void> parse_xml(std::string_view text, tinyxml2::XMLDocument& document);

/// The children of an element in document order.
/// @param name  name of the children; null: all.
template <typename Element>
[[nodiscard]] std::vector<Element*> children_of(Element& parent, const char* name = nullptr) {
  std::vector<Element*> children;
  for (auto* child = parent.FirstChildElement(name); child != nullptr;
       child = child->NextSiblingElement(name)) {
    children.push_back(child);
  }
  return children;
}

/// The value of an attribute; empty without the element or the attribute.
[[nodiscard]] std::string attribute_of(const tinyxml2::XMLElement* element, const char* name);

}  // namespace retarget

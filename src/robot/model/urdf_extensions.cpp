#include "robot/model/urdf_extensions.h"

#include <algorithm>
#include <string_view>

#include "base/parse_xml.h"
#include "retarget/file.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using tinyxml2::XMLElement;

bool is_link_or_joint(const XMLElement& element) {
  const std::string_view name = element.Name();
  return name == "link" || name == "joint";
}

bool holds_links(const XMLElement& element) {
  for (const auto* child = element.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    if (is_link_or_joint(*child) || holds_links(*child)) return true;
  }
  return false;
}

void collect_xacro(const XMLElement& element, std::vector<std::string>& names) {
  for (const auto* child = element.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    if (!is_xacro(*child)) {
      collect_xacro(*child, names);
    } else if (std::ranges::find(names, child->Name()) == names.end()) {
      names.emplace_back(child->Name());
    }
  }
}

}  // namespace

bool is_extension_of_urdf(const XMLElement& element) {
  const XMLElement* top = element.GetDocument()->RootElement();
  if (element.Parent() != top || lower_case(top->Name()) != "robot") return false;
  const std::string name = lower_case(element.Name());
  return name == "gazebo" || name == "transmission" || name == "ros2_control" || name == "sensor";
}

bool is_xacro(const XMLElement& element) {
  return std::string_view(element.Name()).starts_with("xacro:");
}

bool is_xacro_template(const XMLElement& element) {
  if (is_xacro(element)) {
    const std::string_view name = element.Name();
    if (name == "xacro:include" || name == "xacro:macro" || holds_links(element)) return true;
  }
  for (const auto* child = element.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    if (is_xacro_template(*child)) return true;
  }
  return false;
}

std::vector<std::string> xacro_leftovers(const std::string& path) {
  tinyxml2::XMLDocument document;
  std::vector<std::string> names;
  const auto text = read_file(path, ErrorKind::kConfig);
  if (!text || text->view().find("<xacro:") == std::string_view::npos) return names;
  if (parse_xml(text->view(), document) && document.RootElement() != nullptr) {
    collect_xacro(*document.RootElement(), names);
  }
  return names;
}

}  // namespace retarget

#include "robot/model/urdf_extras.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <system_error>
#include <utility>

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
  for (const auto* child : children_of(element)) {
    if (is_link_or_joint(*child) || holds_links(*child)) return true;
  }
  return false;
}

void collect_xacro(const XMLElement& element, std::vector<std::string>& names) {
  for (const auto* child : children_of(element)) {
    if (!is_xacro(*child)) {
      collect_xacro(*child, names);
    } else if (std::ranges::find(names, child->Name()) == names.end()) {
      names.emplace_back(child->Name());
    }
  }
}

}  // namespace

bool is_urdf(const XMLElement& root) {
  return lower_case(root.Name()) == "robot";
}

UrdfFacts urdf_facts(const std::string& path) {
  UrdfFacts facts;
  const auto text = read_file(path, ErrorKind::kConfig);
  tinyxml2::XMLDocument document;
  if (!text || !parse_xml(text->view(), document)) return facts;
  facts.is_urdf = document.RootElement() != nullptr && is_urdf(*document.RootElement());
  const XMLElement* robot = document.FirstChildElement("robot");
  if (robot == nullptr) return facts;
  for (const auto* joint : children_of(*robot, "joint")) {
    const char* name = joint->Attribute("name");
    if (name == nullptr) continue;
    const std::string velocity = attribute_of(joint->FirstChildElement("limit"), "velocity");
    double speed = 0.0;
    const char* const end = velocity.data() + velocity.size();
    const bool is_number = std::from_chars(velocity.data(), end, speed).ec == std::errc();
    if (is_number && std::isfinite(speed) && speed > 0.0) facts.speeds[name] = speed;
    const auto* mimic = joint->FirstChildElement("mimic");
    const char* leader = mimic == nullptr ? nullptr : mimic->Attribute("joint");
    if (leader == nullptr) continue;
    JointCoupling coupling{leader, mimic->DoubleAttribute("multiplier", 1.0),
                           mimic->DoubleAttribute("offset", 0.0)};
    if (!std::isfinite(coupling.ratio) || !std::isfinite(coupling.offset)) continue;
    facts.couplings[name] = std::move(coupling);
  }
  return facts;
}

bool is_extension_of_urdf(const XMLElement& element) {
  const XMLElement* top = element.GetDocument()->RootElement();
  if (element.Parent() != top || !is_urdf(*top)) return false;
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
  for (const auto* child : children_of(element)) {
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

namespace {

bool is_material(std::string_view text) {
  constexpr std::string_view kStart = "<material";
  constexpr std::string_view kAfterName = " \t\r\n/>";
  return text.starts_with(kStart) && text.size() > kStart.size() &&
         kAfterName.find(text[kStart.size()]) != std::string_view::npos;
}

}  // namespace

std::string without_materials(std::string text) {
  constexpr std::size_t kNone = std::string::npos;
  std::size_t at = text.find('<');
  while (at != kNone) {
    const std::string_view rest = std::string_view(text).substr(at);
    std::size_t end = at;
    if (rest.starts_with("<!--")) {
      end = text.find("-->", at);
    } else if (is_material(rest)) {
      end = text.find('>', at);
      const bool has_content = end != kNone && text[end - 1] != '/';
      if (has_content) end = text.find("</material", end);
      if (has_content && end != kNone) end = text.find('>', end);
      if (end == kNone) break;
      std::replace_if(
          text.begin() + static_cast<std::ptrdiff_t>(at),
          text.begin() + static_cast<std::ptrdiff_t>(end + 1), [](char c) { return c != '\n'; },
          ' ');
    }
    if (end == kNone) break;
    at = text.find('<', end + 1);
  }
  return text;
}

}  // namespace retarget

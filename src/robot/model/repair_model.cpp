#include "robot/model/repair_model.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <sstream>
#include <string_view>
#include <utility>

#include "base/parse_xml.h"
#include "retarget/file.h"
#include "retarget/text.h"
#include "robot/model/mujoco_messages.h"
#include "robot/model/urdf_extras.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

// Parts of an MJCF that do not affect its kinematics and that nothing else refers to.
constexpr std::array<std::string_view, 7> kSections = {
    "sensor", "actuator", "keyframe", "visual", "statistic", "camera", "light"};
constexpr std::array<std::string_view, 9> kActuatorDefaults = {
    "motor",    "position", "velocity", "intvelocity", "damper",
    "cylinder", "muscle",   "adhesion", "general"};
constexpr int kMaxIncludeDepth = 16;

template <std::size_t kCount>
bool is_one_of(std::string_view name, const std::array<std::string_view, kCount>& names) {
  return std::ranges::find(names, name) != names.end();
}

bool is_named(const XMLElement& element, std::string_view name) {
  return element.Name() == name;
}

// Calls `visit` for the elements below `root`, parents first, and deletes those for which it
// returns false. check_model bounds the depth.
void visit_elements(XMLElement& root, const std::function<bool(XMLElement&)>& visit) {
  for (XMLElement* each : children_of(root)) {
    if (visit(*each)) {
      visit_elements(*each, visit);
    } else {
      root.DeleteChild(each);
    }
  }
}

bool parse_file(const std::string& path, tinyxml2::XMLDocument& document) {
  const auto text = read_file(path, ErrorKind::kConfig);
  return text && parse_xml(text->view(), document) && document.RootElement() != nullptr;
}

// Replaces <include> elements with the contents of their files. Returns false if a file cannot be
// read.
bool expand_includes(XMLElement& element, const fs::path& root, const fs::path& folder, int depth) {
  for (XMLElement* each : children_of(element)) {
    if (!is_named(*each, "include")) {
      if (!expand_includes(*each, root, folder, depth)) return false;
      continue;
    }
    const std::string name = attribute_of(each, "file");
    const fs::path file = is_file(root / name) ? root / name : folder / name;
    tinyxml2::XMLDocument included;
    if (depth >= kMaxIncludeDepth || !parse_file(file.string(), included)) return false;
    if (!expand_includes(*included.RootElement(), root, file.parent_path(), depth + 1))
      return false;
    tinyxml2::XMLNode* last = each;
    for (const auto* child = included.RootElement()->FirstChild(); child != nullptr;
         child = child->NextSibling()) {
      last = element.InsertAfterChild(last, child->DeepClone(element.GetDocument()));
    }
    element.DeleteChild(each);
  }
  return true;
}

// Returns the first part of a message between `before` and `after`.
std::string between(const std::string& text, std::string_view before, std::string_view after) {
  const std::size_t start = text.find(before);
  if (start == std::string::npos) return {};
  const std::size_t from = start + before.size();
  const std::size_t end = text.find(after, from);
  return end == std::string::npos ? std::string() : text.substr(from, end - from);
}

// Whether a body is only a coordinate frame: it has neither joints nor an inertia.
bool is_only_frame(const XMLElement& body) {
  return std::ranges::none_of(std::array{"joint", "freejoint", "inertial", "geom"},
                              [&](const char* kind) { return body.FirstChildElement(kind); });
}

bool holds_free_joint(const XMLElement& body) {
  if (body.FirstChildElement("freejoint") != nullptr) return true;
  for (const auto* joint : children_of(body, "joint")) {
    if (attribute_of(joint, "type") == "free") return true;
  }
  for (const auto* child : children_of(body, "body")) {
    if (holds_free_joint(*child)) return true;
  }
  return false;
}

// Turns a body into a frame, which keeps only the pose of the body.
void make_frame(XMLElement& body) {
  body.SetName("frame");
  constexpr std::array<std::string_view, 8> kKept = {"name",      "childclass", "pos",   "quat",
                                                     "axisangle", "xyaxes",     "zaxis", "euler"};
  for (const auto* attribute = body.FirstAttribute(); attribute != nullptr;) {
    const std::string name = attribute->Name();
    attribute = attribute->Next();
    if (!is_one_of(name, kKept)) body.DeleteAttribute(name.c_str());
  }
}

// Whether a link has no mass.
bool is_massless(const XMLElement& link) {
  const auto* inertial = link.FirstChildElement("inertial");
  const auto* mass = inertial == nullptr ? nullptr : inertial->FirstChildElement("mass");
  return mass == nullptr || mass->DoubleAttribute("value") == 0.0;
}

bool is_at_origin(const XMLElement& joint) {
  const auto* origin = joint.FirstChildElement("origin");
  if (origin == nullptr) return true;
  std::istringstream numbers(attribute_of(origin, "xyz") + " " + attribute_of(origin, "rpy"));
  double number = 0.0;
  while (numbers >> number) {
    if (number != 0.0) return false;
  }
  return true;
}

XMLElement* joint_from(XMLElement& robot, const char* end, const std::string& link) {
  for (auto* joint : children_of(robot, "joint")) {
    const auto* named = joint->FirstChildElement(end);
    if (named != nullptr && attribute_of(named, "link") == link) return joint;
  }
  return nullptr;
}

// Whether a joint's origin does not tilt its child.
bool keeps_upright(const XMLElement& joint) {
  std::istringstream numbers(attribute_of(joint.FirstChildElement("origin"), "rpy"));
  double roll = 0.0, pitch = 0.0;
  return !(numbers >> roll >> pitch) || (roll == 0.0 && pitch == 0.0);
}

// The first link without a joint above it; null: none.
XMLElement* root_link(XMLElement& robot) {
  for (XMLElement* link : children_of(robot, "link")) {
    if (joint_from(robot, "child", attribute_of(link, "name")) == nullptr) return link;
  }
  return nullptr;
}

// The only joint below a link; null if there is none, or several.
XMLElement* only_joint_below(XMLElement& robot, const std::string& link) {
  XMLElement* only = nullptr;
  for (XMLElement* joint : children_of(robot, "joint")) {
    const auto* parent = joint->FirstChildElement("parent");
    if (parent == nullptr || attribute_of(parent, "link") != link) continue;
    if (only != nullptr) return nullptr;
    only = joint;
  }
  return only;
}

XMLElement* child_with(XMLElement& robot, const char* kind, const char* attribute,
                       const std::string& value) {
  for (XMLElement* child : children_of(robot, kind)) {
    if (attribute_of(child, attribute) == value) return child;
  }
  return nullptr;
}

}  // namespace

bool ModelRepair::load() {
  if (document_.RootElement() != nullptr) return true;
  if (!parse_file(path_, document_)) return false;
  const fs::path folder = fs::path(path_).parent_path();
  return expand_includes(*document_.RootElement(), folder, folder, 0);
}

// Removes unknown attributes of sites, which equalities may refer to.
bool ModelRepair::drop_attribute(const std::string& complaint) {
  const std::string name = between(complaint, "unrecognized attribute: '", "'");
  if (name.empty() || between(complaint, "Element '", "'") != "site") return false;
  bool dropped = false;
  visit_elements(*document_.RootElement(), [&](XMLElement& element) {
    if (is_named(element, "site") && element.Attribute(name.c_str()) != nullptr) {
      element.DeleteAttribute(name.c_str());
      dropped = true;
    }
    return true;
  });
  if (dropped) notes_.push_back("MuJoCo does not know \"" + name + "\" of sites: it is ignored");
  return dropped;
}

bool ModelRepair::drop_sections(const std::string& complaint) {
  if (std::exchange(dropped_sections_, true)) return false;
  bool dropped = false;
  visit_elements(*document_.RootElement(), [&](XMLElement& element) {
    const auto* parent = element.Parent()->ToElement();
    const bool is_default = parent != nullptr && is_named(*parent, "default");
    const bool is_kept = !is_one_of(element.Name(), kSections) &&
                         !(is_default && is_one_of(element.Name(), kActuatorDefaults));
    dropped = dropped || !is_kept;
    return is_kept;
  });
  if (dropped) {
    std::string reason = one_line(complaint);
    remove_prefixes(reason);
    notes_.push_back(
        "sensors, actuators, cameras and lights are ignored, because MuJoCo cannot "
        "read one of them: " +
        reason);
  }
  return dropped;
}

// Finds bodies of an MJCF that represent the world: above the body with the free joint, or named
// "world".
bool ModelRepair::free_world_bodies() {
  std::vector<std::string> names;
  for (auto* world : children_of(*document_.RootElement(), "worldbody")) {
    auto* body = world->FirstChildElement("body");
    while (body != nullptr) {
      auto* next = body->NextSiblingElement("body");
      const std::string name = attribute_of(body, "name");
      if (is_only_frame(*body) && (name == "world" || holds_free_joint(*body))) {
        names.push_back("\"" + name + "\"");
        auto* inner = body->FirstChildElement("body");
        // The bodies below are now at the top.
        if (inner != nullptr && is_only_frame(*inner) &&
            inner->NextSiblingElement("body") == nullptr)
          next = inner;
        make_frame(*body);
      }
      body = next;
    }
  }
  if (names.empty()) return false;
  notes_.push_back(
      names.size() == 1
          ? "the body " + names[0] +
                " represents the world: it has no mass and no joint, and is omitted"
          : "the bodies " + list_names(names, 3) +
                " represent the world: they have no mass and no joint, and are omitted");
  return true;
}

// Handles a URDF whose floating joint is below links that represent the world: renames the parent
// of the joint to MuJoCo's reserved name for the world.
bool ModelRepair::free_world_links() {
  XMLElement& robot = *document_.RootElement();
  XMLElement* floating = child_with(robot, "joint", "type", "floating");
  auto* parent = floating == nullptr ? nullptr : floating->FirstChildElement("parent");
  if (parent == nullptr) return false;
  const std::string name = attribute_of(parent, "link");
  std::vector<XMLElement*> removed;
  for (std::string link = name;;) {
    XMLElement* element = child_with(robot, "link", "name", link);
    if (element == nullptr || !is_massless(*element)) return false;
    if (link != name) removed.push_back(element);
    XMLElement* joint = joint_from(robot, "child", link);
    if (joint == nullptr) break;
    const auto* above = joint->FirstChildElement("parent");
    const bool is_fixed = attribute_of(joint, "type") == "fixed" && is_at_origin(*joint);
    if (!is_fixed || above == nullptr || removed.size() > 10) return false;
    removed.push_back(joint);
    link = attribute_of(above, "link");
  }
  child_with(robot, "link", "name", name)->SetAttribute("name", "world");
  for (auto* joint : children_of(robot, "joint")) {
    auto* from = joint->FirstChildElement("parent");
    if (from != nullptr && attribute_of(from, "link") == name) from->SetAttribute("link", "world");
  }
  for (XMLElement* each : removed) robot.DeleteChild(each);
  notes_.push_back("the link \"" + name +
                   "\" represents the world: it has no mass, and is omitted");
  return true;
}

bool ModelRepair::apply(const std::string& complaint) {
  const bool has_links = is_urdf(*document_.RootElement());
  if (complaint.find(kNestedFreeJoint) != std::string::npos) {
    return has_links ? free_world_links() : free_world_bodies();
  }
  if (has_links) return false;
  if (complaint.find("repeated name 'world' in body") != std::string::npos) {
    return free_world_bodies();
  }
  return drop_attribute(complaint) || drop_sections(complaint);
}

std::optional<std::string> ModelRepair::repair(const std::string& complaint) {
  if (!load() || !apply(complaint)) return std::nullopt;
  return text();
}

std::string ModelRepair::text() const {
  tinyxml2::XMLPrinter printer;
  document_.Print(&printer);
  return std::string(printer.CStr());
}

std::optional<std::string> ModelRepair::drop_links_above_base() {
  if (!load() || !is_urdf(*document_.RootElement())) return std::nullopt;
  XMLElement& robot = *document_.RootElement();
  std::vector<std::string> names;
  std::string base;
  while (XMLElement* link = root_link(robot)) {
    base = attribute_of(link, "name");
    XMLElement* joint = only_joint_below(robot, base);
    const bool is_above = joint != nullptr && base != "world" && is_massless(*link) &&
                          attribute_of(joint, "type") == "fixed" && keeps_upright(*joint);
    if (!is_above) break;
    names.push_back("\"" + base + "\"");
    robot.DeleteChild(joint);
    robot.DeleteChild(link);
  }
  if (names.empty()) return std::nullopt;
  notes_.push_back(
      fmt::format("{} above the base {} no mass and {} omitted: the root of motions is \"{}\"",
                  (names.size() == 1 ? "the link " : "the links ") + list_names(names, 3),
                  names.size() == 1 ? "has" : "have", names.size() == 1 ? "is" : "are", base));
  return text();
}

}  // namespace retarget

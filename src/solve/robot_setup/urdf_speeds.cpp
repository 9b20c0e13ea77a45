#include "solve/robot_setup/urdf_speeds.h"

#include <tinyxml2.h>

#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>

#include "base/parse_xml.h"
#include "retarget/error.h"
#include "retarget/file.h"

namespace retarget {

std::map<std::string, double> urdf_speeds(const std::string& path) {
  std::map<std::string, double> speeds;
  const auto text = read_file(path, ErrorKind::kConfig);
  if (!text) return speeds;
  tinyxml2::XMLDocument document;
  if (!parse_xml(text->view(), document)) {
    return speeds;
  }
  const tinyxml2::XMLElement* robot = document.FirstChildElement("robot");
  if (robot == nullptr) return speeds;
  for (const auto* joint = robot->FirstChildElement("joint"); joint != nullptr;
       joint = joint->NextSiblingElement("joint")) {
    const auto* limit = joint->FirstChildElement("limit");
    const char* name = joint->Attribute("name");
    const char* velocity = limit == nullptr ? nullptr : limit->Attribute("velocity");
    if (name == nullptr || velocity == nullptr) continue;
    const std::string_view digits(velocity);
    double speed = 0.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), speed);
    if (error == std::errc() && std::isfinite(speed) && speed > 0.0) speeds[name] = speed;
  }
  return speeds;
}

}  // namespace retarget

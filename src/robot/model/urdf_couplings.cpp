#include "robot/model/urdf_couplings.h"

#include <tinyxml2.h>

#include <cmath>
#include <utility>

#include "base/parse_xml.h"
#include "retarget/error.h"
#include "retarget/file.h"

namespace retarget {

std::map<std::string, JointCoupling> urdf_couplings(const std::string& path) {
  std::map<std::string, JointCoupling> couplings;
  const auto text = read_file(path, ErrorKind::kConfig);
  if (!text) return couplings;
  tinyxml2::XMLDocument document;
  if (!parse_xml(text->view(), document)) {
    return couplings;
  }
  const tinyxml2::XMLElement* robot = document.FirstChildElement("robot");
  if (robot == nullptr) return couplings;
  for (const auto* joint = robot->FirstChildElement("joint"); joint != nullptr;
       joint = joint->NextSiblingElement("joint")) {
    const auto* mimic = joint->FirstChildElement("mimic");
    const char* name = joint->Attribute("name");
    const char* leader = mimic == nullptr ? nullptr : mimic->Attribute("joint");
    if (name == nullptr || leader == nullptr) continue;
    JointCoupling coupling{leader, mimic->DoubleAttribute("multiplier", 1.0),
                           mimic->DoubleAttribute("offset", 0.0)};
    if (!std::isfinite(coupling.ratio) || !std::isfinite(coupling.offset)) continue;
    couplings[name] = std::move(coupling);
  }
  return couplings;
}

}  // namespace retarget

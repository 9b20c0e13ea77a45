#include "robot/model/load_profile.h"

#include <cmath>
#include <vector>

#include "base/json.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;
using Couplings = std::map<std::string, JointCoupling>;

const std::vector<std::string> kCouplingKeys = {"joint", "ratio", "offset"};

std::string named(const std::string& joint) {
  return "\"" + joint + "\"";
}

bool is_known_joint(const std::string& name, const Robot& robot, const std::string& what,
                    Faults& faults) {
  if (robot.find_joint(name)) return true;
  faults.add(what + ": the model has no joint " + named(name) +
             faults.suggestion(name, robot.joint_names()));
  return false;
}

double number_or(double none, const Json& entry, const char* key, const std::string& what,
                 Faults& faults) {
  const auto found = entry.find(key);
  if (found == entry.end()) return none;
  if (found->is_number() && std::isfinite(found->get<double>())) return found->get<double>();
  faults.add(what + ": " + named(key) + " must be a number, found " + short_text(*found));
  return none;
}

void add_cycles(const Couplings& couplings, Faults& faults) {
  for (const auto& [first, coupling] : couplings) {
    std::vector<std::string> names = {named(first)};
    std::string leader = coupling.leader;
    // A cycle is reported at its alphabetically first joint.
    while (leader > first) {
      names.push_back(named(leader));
      const auto next = couplings.find(leader);
      if (next == couplings.end() || names.size() > couplings.size()) break;
      leader = next->second.leader;
    }
    if (leader != first || names.size() < 2) continue;
    faults.add("\"coupled_joints\": these joints drive each other in a cycle: " +
               list_names(names, 6));
  }
}

}  // namespace

Couplings couplings_from_json(const Json& json, const Robot& robot, Faults& faults) {
  Couplings couplings;
  for (const auto& [name, entry] : json.items()) {
    const std::string what = "\"coupled_joints\" of " + named(name);
    if (!is_known_joint(name, robot, "\"coupled_joints\"", faults)) continue;
    if (!entry.is_object()) {
      faults.add(what + " must be {\"joint\": name, \"ratio\": number, \"offset\": number}");
      continue;
    }
    const JsonMembers members(entry, faults, what + ": ");
    members.check_keys(kCouplingKeys);
    JointCoupling coupling;
    coupling.leader = members.text("joint");
    if (!is_known_joint(coupling.leader, robot, what, faults)) continue;
    if (coupling.leader == name) faults.add(what + ": a joint cannot be coupled to itself");
    coupling.ratio = number_or(1.0, entry, "ratio", what, faults);
    coupling.offset = number_or(0.0, entry, "offset", what, faults);
    couplings[name] = coupling;
  }
  add_cycles(couplings, faults);
  return couplings;
}

}  // namespace retarget

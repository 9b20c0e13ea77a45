#pragma once

#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/rig.h"
#include "support/value_of.h"

namespace retarget {

/// The texts of the findings of `robots check` of one kind: errors or notes.
inline std::vector<std::string> finding_texts(const Result<std::vector<RobotFinding>>& found,
                                              bool faults) {
  std::vector<std::string> texts;
  for (const RobotFinding& finding : value_of(found)) {
    if (finding.fault == faults) texts.push_back(finding.text);
  }
  return texts;
}

}  // namespace retarget

#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/rig.h"

namespace retarget {

/// The texts of the findings of `robots check` of one kind: errors or notes.
inline std::vector<std::string> finding_texts(const Result<std::vector<RobotFinding>>& found,
                                              bool faults) {
  EXPECT_TRUE(found) << describe(found.error());
  std::vector<std::string> texts;
  if (!found) return texts;
  for (const RobotFinding& finding : *found) {
    if (finding.fault == faults) texts.push_back(finding.text);
  }
  return texts;
}

}  // namespace retarget

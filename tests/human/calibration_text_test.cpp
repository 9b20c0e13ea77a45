#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "human/hand_made_maps.h"
#include "human/skeleton/calibrate.h"
#include "support/recorded_clip.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using testing::StartsWith;

TEST(CalibrationText, NamesTheEvidenceForTheSkeleton) {
  const Clip clip = recorded_clip("wave");
  const std::pair<const char*, const char*> texts[] = {
      {"mixamo", "mixamo skeleton, unit cm (0.01 m), "},
      {"names", "a skeleton recognised by its joint names, unit cm (0.01 m), "},
      {"topology", "a skeleton recognised by its shape, unit cm "},
      {"map file", "a skeleton with a bone map from a file, unit cm "},
  };
  for (const auto& [profile, text] : texts) {
    const auto found = value_of(calibrate(clip, lafan1_map(clip.skeleton(), profile), {}));
    EXPECT_EQ(found.profile, profile);
    EXPECT_THAT(found.description, StartsWith(text));
  }
}

}  // namespace
}  // namespace retarget

#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "human/tiny_skeleton.h"
#include "support/value_of.h"

namespace retarget {

/// The expected joint per bone; all must match.
inline void expect_bones(const std::string& body,
                         const std::vector<std::pair<const char*, const char*>>& expected) {
  const Skeleton skeleton = tiny_skeleton(body);
  // With the profiles, and by names alone.
  for (const auto& profiles : {shipped_profiles(), std::vector<SkeletonProfile>()}) {
    const auto map = value_of(recognise_skeleton(skeleton, profiles));
    for (const auto& [bone, joint] : expected) {
      EXPECT_EQ(joint_name(map, skeleton, bone), joint) << bone << " by " << map.profile;
    }
  }
}

/// A body under other names: pairs of old and new words, applied in order.
inline std::string renamed(const std::vector<std::pair<const char*, const char*>>& words) {
  std::string body = kBody;
  for (const auto& [from, to] : words) body = replaced(body, from, to);
  return body;
}

}  // namespace retarget

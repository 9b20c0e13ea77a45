#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/robot_motion/gltf_writer.h"

namespace retarget {
namespace {

TEST(GltfTimes, AreRejectedOnceTheyRepeat) {
  EXPECT_TRUE(check_key_times({30, 1}, 0));
  // A day at 120 frames per second.
  EXPECT_TRUE(check_key_times({120, 1}, 10'368'000));
  const auto repeats = check_key_times({120, 1}, 20'000'000);
  ASSERT_FALSE(repeats);
  EXPECT_THAT(repeats.error().message, testing::HasSubstr("have equal times"));
}

}  // namespace
}  // namespace retarget

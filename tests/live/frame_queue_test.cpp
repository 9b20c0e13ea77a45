// Gaps between the frames of a queue.

#include <gtest/gtest.h>

#include "live/session/frame_queue.h"

namespace retarget {
namespace {

// Ten frames per second that arrive at their times, without some of them.
FrameQueue queue_without(int missing) {
  FrameQueue queue;
  for (int i = 0; i < 20; ++i) {
    const double time = 0.1 * (i < 15 ? i : i + missing);
    queue.push(time, HumanPose{}, time);
  }
  return queue;
}

TEST(FrameQueue, KnowsWhereFramesAreMissing) {
  const FrameQueue whole = queue_without(0), gap = queue_without(1);
  for (const double time : {0.55, 1.44, 1.55}) EXPECT_EQ(whole.past_gap(time, 1.0), time);
  EXPECT_EQ(gap.past_gap(1.35, 1.0), 1.35);
  EXPECT_DOUBLE_EQ(gap.past_gap(1.45, 1.0), 1.6);
  EXPECT_EQ(gap.past_gap(1.65, 1.0), 1.65);
}

// A few frames do not show the rate of the others.
TEST(FrameQueue, KnowsNoGapsBeforeItKnowsTheInterval) {
  FrameQueue queue;
  for (const double time : {0.0, 0.1, 0.3}) queue.push(time, HumanPose{}, time);
  EXPECT_EQ(queue.past_gap(0.2, 1.0), 0.2);
}

}  // namespace
}  // namespace retarget

#include "retarget/clip.h"

#include <gtest/gtest.h>

#include <utility>

#include "motion/test_clips.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST(Clip, StartsInTheRestPose) {
  const Clip clip(make_tree(), FrameRate{30, 1}, 3);
  for (int frame = 0; frame < 3; ++frame) {
    ASSERT_EQ(clip.rotations(frame).size(), 5U);
    ASSERT_EQ(clip.translations(frame).size(), 2U);
    for (int joint = 0; joint < 5; ++joint) {
      EXPECT_EQ(clip.rotations(frame)[joint].coeffs(), Quaterniond::Identity().coeffs());
      EXPECT_EQ(clip.translation(frame, joint), clip.skeleton().joint(joint).offset);
    }
  }
}

TEST(Clip, FramesAreIndependent) {
  Clip clip(make_tree(), FrameRate{30, 1}, 3);
  clip.translations(1)[1] = Vector3d(1, 2, 3);
  clip.rotations(1)[2] = Quaterniond(0, 1, 0, 0);
  EXPECT_EQ(clip.translation(1, 3), Vector3d(1, 2, 3));
  EXPECT_EQ(clip.translation(0, 3), clip.skeleton().joint(3).offset);
  EXPECT_EQ(clip.translation(2, 3), clip.skeleton().joint(3).offset);
  EXPECT_EQ(clip.rotations(1)[2].x(), 1.0);
  EXPECT_EQ(clip.rotations(0)[2].x(), 0.0);
  EXPECT_EQ(clip.rotations(2)[2].x(), 0.0);
}

TEST(Clip, DurationIsFromTheFirstToTheLastFrame) {
  EXPECT_DOUBLE_EQ(Clip(make_tree(), FrameRate{30, 1}, 301).duration(), 10.0);
  EXPECT_DOUBLE_EQ(Clip(make_tree(), FrameRate{2997, 125}, 2998).duration(), 125.0);
  EXPECT_EQ(Clip(make_tree(), FrameRate{30, 1}, 1).duration(), 0.0);
  EXPECT_EQ(Clip(make_tree(), FrameRate{30, 1}, 0).duration(), 0.0);
}

TEST(Cut, UsesAHalfOpenRange) {
  const Clip clip = make_clip(FrameRate{30, 1}, 10, [](double t) { return t; });
  const Clip part = cut(clip, 3, 7);
  EXPECT_EQ(part.frame_count(), 4);
  EXPECT_EQ(part.rate(), clip.rate());
  EXPECT_EQ(part.shared_skeleton(), clip.shared_skeleton());
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(same_bits(part, i, clip, 3 + i));
  EXPECT_TRUE(same_bits(cut(clip, 0, 10), clip));
  EXPECT_EQ(cut(clip, 10, 10).frame_count(), 0);
}

TEST(MakeSignContinuous, UndoesFlipsAndKeepsTheFirstFrame) {
  const Clip clip = make_clip(FrameRate{30, 1}, 200, [](double t) { return 2.0 * t; });
  Clip flipped = clip;
  for (int frame = 1; frame < 200; ++frame) {
    for (std::size_t joint = 0; joint < 5; ++joint) {
      auto& q = flipped.rotations(frame)[joint];
      if ((frame * 7 + joint) % 3 == 0) q.coeffs() = -q.coeffs();
    }
  }
  make_sign_continuous(flipped);
  // Two whole turns: the sign changes with the angle in both.
  EXPECT_TRUE(same_bits(flipped, clip));

  Clip upside_down = clip;
  upside_down.rotations(0)[0].coeffs() *= -1.0;
  make_sign_continuous(upside_down);
  for (int frame = 0; frame < 200; ++frame) {
    const auto& q = std::as_const(upside_down).rotations(frame)[0];
    EXPECT_EQ(q.coeffs(), -clip.rotations(frame)[0].coeffs());
  }
}

TEST(MakeSignContinuous, HandlesEmptyAndSingleFrames) {
  for (const int count : {0, 1}) {
    Clip clip(make_tree(), FrameRate{30, 1}, count);
    make_sign_continuous(clip);
    EXPECT_EQ(clip.frame_count(), count);
  }
}

}  // namespace
}  // namespace retarget

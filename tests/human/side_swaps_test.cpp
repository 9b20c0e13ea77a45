#include "human/gait/side_swaps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <utility>

namespace retarget {
namespace {

using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Tracks = std::vector<std::vector<Vector3d>>;

const std::vector<std::string> kNames = {
    "left_hip",      "right_hip",      "left_knee",  "right_knee",  "left_ankle", "right_ankle",
    "left_shoulder", "right_shoulder", "left_elbow", "right_elbow", "nose"};
constexpr std::size_t kLegJoints = 6, kSwapFrames = 100;

// Legs that swing past each other, metres.
Tracks walking() {
  Tracks tracks(kNames.size());
  for (std::size_t joint = 0; joint < kNames.size(); ++joint) {
    for (std::size_t frame = 0; frame < kSwapFrames; ++frame) {
      const double side = joint % 2 == 0 ? 1.0 : -1.0, time = static_cast<double>(frame) / 30.0;
      const double swing = 0.04 * static_cast<double>(joint / 2) * side * std::sin(6.0 * time);
      tracks[joint].emplace_back(1.4 * time + swing, 0.1 * side, 1.0);
    }
  }
  return tracks;
}

void exchange(Tracks& tracks, std::size_t first, std::size_t last, std::size_t begin,
              std::size_t end) {
  for (std::size_t joint = first; joint < last; joint += 2) {
    for (std::size_t frame = begin; frame < end; ++frame) {
      std::swap(tracks[joint][frame], tracks[joint + 1][frame]);
    }
  }
}

TEST(SideSwaps, OfLegsAreUndone) {
  Tracks tracks = walking();
  exchange(tracks, 0, kLegJoints, 20, 27);
  exchange(tracks, 0, kLegJoints, 60, 61);
  const SideSwaps found = undo_side_swaps(tracks, kNames, 0.1);
  EXPECT_EQ(tracks, walking());
  EXPECT_THAT(found.undone, ElementsAre("the legs exchanged sides in 8 frames"));
  EXPECT_THAT(found.kept, IsEmpty());
}

TEST(SideSwaps, OfArmsAreUndoneAlone) {
  Tracks tracks = walking();
  exchange(tracks, kLegJoints, kNames.size() - 1, 40, 50);
  EXPECT_THAT(undo_side_swaps(tracks, kNames, 0.1).undone,
              ElementsAre("the arms exchanged sides in 10 frames"));
  EXPECT_EQ(tracks, walking());
}

TEST(SideSwaps, OfArmsExchangeCollarbonesThatExchangeToo) {
  std::vector<std::string> names = kNames;
  names.insert(names.end(), {"left_collar", "right_collar", "left_eye", "right_eye"});
  Tracks tracks = walking();
  const auto at = [&](double side) {
    std::vector<Vector3d> track = walking().back();
    for (Vector3d& place : track) place.y() = 0.03 * side;
    return track;
  };
  for (const double side : {1.0, -1.0, 1.0, -1.0}) tracks.push_back(at(side));
  const Tracks expected = tracks;
  exchange(tracks, kLegJoints, kNames.size() - 1, 40, 50);
  exchange(tracks, kNames.size(), kNames.size() + 2, 40, 50);
  EXPECT_THAT(undo_side_swaps(tracks, names, 0.1).undone,
              ElementsAre("the arms exchanged sides in 10 frames"));
  EXPECT_EQ(tracks, expected);
}

TEST(SideSwaps, ThatLastAreReported) {
  Tracks tracks = walking();
  exchange(tracks, 0, kLegJoints, 30, kSwapFrames);
  const Tracks before = tracks;
  const SideSwaps found = undo_side_swaps(tracks, kNames, 0.1);
  EXPECT_EQ(tracks, before);
  EXPECT_THAT(found.undone, IsEmpty());
  EXPECT_THAT(found.kept, ElementsAre(HasSubstr("the legs exchange sides in frame 30")));
}

TEST(SideSwaps, CompleteClipsCutsAndUnknownSidesHaveNone) {
  Tracks tracks = walking();
  EXPECT_TRUE(undo_side_swaps(tracks, kNames, 0.1).empty());
  for (auto& track : tracks) {
    for (std::size_t frame = 50; frame < kSwapFrames; ++frame) track[frame].x() += 1.0;
  }
  EXPECT_TRUE(undo_side_swaps(tracks, kNames, 0.1).empty());
  exchange(tracks, 0, kLegJoints, 20, 27);
  EXPECT_TRUE(undo_side_swaps(tracks, std::vector<std::string>(kNames.size(), "a"), 0.1).empty());
}

}  // namespace
}  // namespace retarget

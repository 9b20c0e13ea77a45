// Feet and knees of edited motions: toes that stay planted while the heel is up, legs near full
// stretch.

#include <gmock/gmock.h>

#include <algorithm>

#include "edit/plant_feet.h"
#include "edit_sample.h"
#include "retarget/edit.h"
#include "support/shared_data.h"
#include "support/value_of.h"
#include "support/with_joints.h"

namespace retarget {
namespace {

using namespace edit_test;

using Track = std::vector<Eigen::Vector3d>;

Track track_of(const HumanClip& human, const char* bone) {
  Track track;
  for (int i = 0; i < human.frame_count; ++i) {
    track.push_back(human.frame(i)[*bone_from_name(bone)].translation);
  }
  return track;
}

// Runs of frames in which a point is low and slow; independent of the library's contacts.
std::vector<FrameRange> standing(const Track& track, double fps) {
  constexpr double kSlow = 0.1, kLow = 0.03;
  double lowest = track[0].z();
  for (const Eigen::Vector3d& place : track) lowest = std::min(lowest, place.z());
  std::vector<FrameRange> runs;
  for (int i = 0; i + 1 < static_cast<int>(track.size()); ++i) {
    if (track[i].z() > lowest + kLow || (track[i + 1] - track[i]).norm() * fps > kSlow) continue;
    if (runs.empty() || runs.back().end != i + 1) runs.push_back({i, i + 1});
    runs.back().end = i + 2;
  }
  // Exclude the frames in which the contact begins and ends.
  for (FrameRange& run : runs) run = {run.begin + 1, run.end - 1};
  std::erase_if(runs, [&](const FrameRange& run) { return run.end - run.begin < 0.1 * fps; });
  return runs;
}

// Additional movement over the floor of points that stand in the source, metres.
double largest_slide(const HumanClip& source, const HumanClip& edited, const char* bone) {
  const Track before = track_of(source, bone), after = track_of(edited, bone);
  double largest = 0.0;
  for (const FrameRange& run : standing(before, source.rate.fps())) {
    for (int i = run.begin; i < run.end; ++i) {
      const double own = (before[i] - before[run.begin]).head<2>().norm();
      const double now = (after[i] - after[run.begin]).head<2>().norm();
      largest = std::max(largest, now - own);
    }
  }
  return largest;
}

double largest_knee_acceleration(const HumanClip& human) {
  double largest = 0.0;
  for (const char* bone : {"LeftLeg", "RightLeg"}) {
    const Track track = track_of(human, bone);
    for (std::size_t i = 1; i + 1 < track.size(); ++i) {
      largest = std::max(largest, (track[i + 1] - 2.0 * track[i] + track[i - 1]).norm());
    }
  }
  return largest * human.rate.fps() * human.rate.fps();
}

Clip follow(const EditSample& sample, const GroundPath& path) {
  return follow_path(sample.clip, sample.calibration, path, {}).value().clip;
}

GroundPath own_path(const EditSample& sample) {
  return fit_path(sample.clip, sample.calibration).value().path;
}

TEST(FeetOnPaths, ToesStayPlantedWhileTheHeelIsUp) {
  const EditSample& sample = data_sample("walk");
  const GroundPath own = own_path(sample);
  const GroundPose start = own.at(0.0);
  const HumanClip source = sample.human();
  for (const GroundPath& path :
       {own.scaled(0.8), own.scaled(1.25), circle_path(start, 1.0, own.length()),
        circle_path(start, -2.0, own.length()), figure8_path(start, own.length())}) {
    const HumanClip moved = sample.human_of(follow(sample, path));
    for (const char* bone : {"LeftToe", "RightToe"}) {
      ASSERT_GT(standing(track_of(source, bone), 30.0).size(), 3u);
      EXPECT_LT(largest_slide(source, moved, bone), 0.01) << bone << " " << path.length();
    }
  }
}

TEST(FeetOnPaths, KneesDoNotPopNearFullStretch) {
  const EditSample& sample = data_sample("walk");
  const GroundPath own = own_path(sample);
  for (const double scale : {0.7, 1.25, 1.4, 1.6}) {
    const HumanClip moved = sample.human_of(follow(sample, own.scaled(scale)));
    EXPECT_LT(largest_knee_acceleration(moved), 1.3 * largest_knee_acceleration(sample.human()))
        << scale;
  }
}

TEST(FeetOnPaths, HandlesRecordedKneesAndToes) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  struct Walk {
    const char* file;
    double scale;  // Scale of its path.
  };
  for (const auto& [name, scale] :
       {Walk{"dialects/games105_walk60", 1.25}, Walk{"dialects/games105_walk60", 1.6},
        Walk{"dialects/soma_walk_forward_120fps", 1.25},
        Walk{"dialects/soma_walk_forward_120fps", 1.6},
        Walk{"lafan1_cuts/dance1_subject1_stumbling_filtered_60fps", 1.25}}) {
    const auto file = *shared / "data" / (std::string(name) + ".bvh");
    const EditSample sample(load_bvh(file.string()).value().clip);
    const HumanClip source = sample.human();
    const HumanClip moved = sample.human_of(follow(sample, own_path(sample).scaled(scale)));
    EXPECT_LT(largest_knee_acceleration(moved), 2.0 * largest_knee_acceleration(source))
        << name << " " << scale;
    for (const char* bone : {"LeftToe", "RightToe"}) {
      EXPECT_LT(largest_slide(source, moved, bone), 0.02) << name << " " << bone << " " << scale;
    }
  }
}

// Thighs and shins with other proportions.
Clip with_other_legs(const Clip& clip) {
  std::vector<Joint> joints = clip.skeleton().joints();
  for (Joint& joint : joints) {
    if (joint.name.ends_with("UpLeg")) continue;
    if (joint.name.ends_with("Leg")) joint.offset *= 0.85;
    if (joint.name.ends_with("Foot")) joint.offset *= 1.1;
    if (joint.name.ends_with("Toe")) joint.offset *= 1.3;
  }
  return with_joints(clip, joints);
}

TEST(FeetAfterATransfer, ContactsMatchTheSource) {
  const EditSample& sample = data_sample("walk");
  const Clip legs = with_other_legs(sample.clip);
  const auto found = recognise_skeleton(legs, all_profiles());
  ASSERT_TRUE(found) << describe(found.error());
  const EditSample other(legs);
  const HumanClip source = sample.human();
  Clip moved = transfer(sample.clip, sample.calibration, other.as_target());
  const HumanClip slid = other.human_of(moved);
  const auto feet =
      value_of(plant_transferred_feet(moved, other.as_target(), sample.clip, sample.calibration));
  const HumanClip planted = other.human_of(moved);
  EXPECT_LT(feet.largest_miss, 0.002);
  for (const char* bone : {"LeftToe", "RightToe"}) {
    EXPECT_GT(largest_slide(source, slid, bone), 0.02) << bone;
    EXPECT_LT(largest_slide(source, planted, bone), 0.003) << bone;
  }
  EXPECT_LT(largest_knee_acceleration(planted), 1.3 * largest_knee_acceleration(source));
  // With an identical body the feet need no correction.
  Clip same = transfer(sample.clip, sample.calibration, sample.as_target());
  const auto none =
      value_of(plant_transferred_feet(same, sample.as_target(), sample.clip, sample.calibration));
  EXPECT_LT(none.largest_correction, 1e-9);
}

}  // namespace
}  // namespace retarget

#include <gmock/gmock.h>

#include <cmath>

#include "edit/fit_path.h"
#include "edit/ground_pose.h"
#include "edit/plant_feet.h"
#include "edit_sample.h"
#include "human/gait/contact_plan.h"
#include "retarget/edit.h"
#include "retarget/statistics.h"
#include "retarget/text.h"
#include "support/angles.h"
#include "support/shared_data.h"

namespace retarget {
namespace {

using namespace edit_test;

FollowedPath follow_with_report(const EditSample& sample, const GroundPath& path,
                                PathKeep keep = PathKeep::kTime) {
  FollowPathOptions options;
  options.keep = keep;
  return follow_path(sample.clip, sample.calibration, path, options).value();
}

TEST(FittedPaths, FollowTheTrackWithoutCorners) {
  const PathMotion walk = path_of(data_sample("walk"));
  EXPECT_LT(walk.largest_distance, 0.05);
  const auto hips = hips_over_ground(data_sample("walk").human());
  EXPECT_NEAR(walk.path.length(), (hips.back().position - hips.front().position).norm(), 0.1);
  for (std::size_t i = 1; i < walk.along.size(); ++i) ASSERT_GE(walk.along[i], walk.along[i - 1]);
  const auto& points = walk.path.control_points();
  for (std::size_t i = 3; i + 3 < points.size(); i += 3) {
    const Eigen::Vector2d in = points[i] - points[i - 1], out = points[i + 1] - points[i];
    EXPECT_NEAR(in.x() * out.y() - in.y() * out.x(), 0.0, 1e-12);
    EXPECT_GT(in.dot(out), 0.0);
  }
  // The body stands at both ends.
  ASSERT_EQ(walk.still.size(), 2u);
  EXPECT_EQ(walk.still.front().begin, 0);
  EXPECT_EQ(walk.still.back().end, 301);
}

TEST(Rethreading, OwnPathIsIdentity) {
  for (const char* name : {"walk", "turn_in_place", "get_up", "squat"}) {
    const EditSample& sample = data_sample(name);
    const GroundPath path = parse_path(format_path(path_of(sample).path), "p").value();
    EXPECT_LT(largest_distance(follow_with_report(sample, path).clip, sample.clip, 0.01), 1e-6)
        << name;
    EXPECT_LT(largest_distance(follow_with_report(sample, path, PathKeep::kStride).clip,
                               sample.clip, 0.01),
              1e-6);
  }
  const EditSample& walk = data_sample("walk");
  EXPECT_LT(largest_distance(follow_with_report(walk, path_of(walk).path, PathKeep::kSpeed).clip,
                             walk.clip, 0.01),
            1e-6);
}

TEST(Rethreading, RigidPathMoveMovesTheMotionRigidly) {
  const GroundPose move{{2.0, -1.0}, 2.2};
  for (const char* name : {"walk", "turn_in_place"}) {
    const EditSample& sample = data_sample(name);
    Clip wanted = sample.clip;
    BodyMover::of(wanted, sample.calibration).value().move_all(wanted, move.in_space());
    const Clip found = follow_with_report(sample, path_of(sample).path.moved(move)).clip;
    EXPECT_LT(largest_distance(found, wanted, 0.01), 1e-6) << name;
    EXPECT_LT(largest_distance(through_bvh(found), found, 0.01), 1e-7) << name;
  }
}

// Ankles of planted feet, in contact according to the clip itself.
struct StepFacts {
  double mean_stride = 0.0;  // metres, both feet
  double slip = 0.0;         // mean speed over the floor, m/s
};

StepFacts steps_of(const HumanClip& human, const ContactPlan& contacts) {
  std::vector<double> strides, speeds;
  for (int foot = 0; foot < 2; ++foot) {
    const Bone bone = *bone_from_name(foot == 0 ? "LeftFoot" : "RightFoot");
    const auto at = [&](int frame) {
      return Eigen::Vector2d(human.frame(frame)[bone].translation.head<2>());
    };
    const auto& phases = contacts.phases[foot];
    for (std::size_t i = 0; i < phases.size(); ++i) {
      const auto middle = [](const ContactPhase& phase) { return (phase.begin + phase.end) / 2; };
      if (i > 0) strides.push_back((at(middle(phases[i])) - at(middle(phases[i - 1]))).norm());
      for (int frame = phases[i].begin; frame + 1 < phases[i].end; ++frame) {
        speeds.push_back((at(frame + 1) - at(frame)).norm() * human.rate.fps());
      }
    }
  }
  return {mean(strides), mean(speeds)};
}

TEST(Rethreading, WalksAlongACircle) {
  const EditSample& sample = data_sample("walk");
  const PathMotion own = path_of(sample);
  const GroundPath circle = circle_path(own.path.at(0.0), 3.0, own.path.length());
  const FollowedPath round = follow_with_report(sample, circle);
  const ContactPlan contacts = find_contacts(sample.human());
  const StepFacts before = steps_of(sample.human(), contacts);
  const StepFacts after = steps_of(sample.human_of(round.clip), contacts);
  EXPECT_NEAR(after.mean_stride / before.mean_stride, 1.0, 0.02);
  EXPECT_LT(after.slip, 0.02);
  EXPECT_LT(after.slip, before.slip + 0.002);
  EXPECT_LT(round.feet.largest_miss, 0.002);

  // The angle between heading and tangent is preserved, and so is the offset from the path.
  const auto hips = hips_over_ground(sample.human());
  const auto moved = hips_over_ground(sample.human_of(round.clip));
  const auto frames = path_frames(own.path, own.along, own.still, {0.0, 0.0});
  for (std::size_t i = 0; i < hips.size(); ++i) {
    const GroundPose was = frames[i].inverse() * hips[i];
    const GroundPose is = round.frames[i].inverse() * moved[i];
    ASSERT_LT((was.position - is.position).norm(), 1e-9);
    ASSERT_LT(angle_between(was.heading, is.heading), 1e-9);
  }
  // Joints other than the root's and the legs' do not change.
  const int spine = sample.map.joint(Bone::kSpine);
  for (int joint = spine; joint < sample.clip.skeleton().joint_count(); ++joint) {
    ASSERT_EQ(round.clip.rotations(150)[joint].coeffs(),
              sample.clip.rotations(150)[joint].coeffs());
  }
}

// Without planting, the same feet slide.
TEST(Rethreading, PlantingPreventsSlip) {
  const EditSample& sample = data_sample("walk");
  const PathMotion own = path_of(sample);
  const GroundPath tight = circle_path(own.path.at(0.0), 1.0, own.path.length());
  const FollowedPath round = follow_with_report(sample, tight);
  const ContactPlan contacts = find_contacts(sample.human());
  EXPECT_LT(steps_of(sample.human_of(round.clip), contacts).slip, 0.02);
  Clip slid = sample.clip;
  const auto mover = BodyMover::of(slid, sample.calibration).value();
  const auto frames = path_frames(own.path, own.along, own.still, {0.0, 0.0});
  for (int i = 0; i < slid.frame_count(); ++i) {
    mover.move(slid, i, round.frames[i] * frames[i].inverse());
  }
  EXPECT_GT(steps_of(sample.human_of(slid), contacts).slip, 0.05);
}

TEST(Rethreading, KeepsTimeSpeedOrStride) {
  const EditSample& sample = data_sample("walk");
  const PathMotion own = path_of(sample);
  const GroundPath longer = own.path.scaled(1.25);
  const auto way = [&](const Clip& clip) {
    const auto hips = hips_over_ground(sample.human_of(clip));
    return (hips.back().position - hips.front().position).norm();
  };
  const double length = way(sample.clip);
  const Clip in_time = follow_with_report(sample, longer).clip;
  EXPECT_EQ(in_time.frame_count(), sample.clip.frame_count());
  EXPECT_NEAR(way(in_time), 1.25 * length, 0.02);
  const Clip at_speed = follow_with_report(sample, longer, PathKeep::kSpeed).clip;
  EXPECT_EQ(at_speed.frame_count(), 376);
  EXPECT_NEAR(way(at_speed), 1.25 * length, 0.02);
  const Clip in_stride = follow_with_report(sample, longer, PathKeep::kStride).clip;
  EXPECT_EQ(in_stride.frame_count(), sample.clip.frame_count());
  EXPECT_NEAR(way(in_stride), length, 0.02);
}

TEST(Rethreading, StridesThatLeaveThePathAreReported) {
  const EditSample& sample = data_sample("walk");
  const PathMotion own = path_of(sample);
  const auto texts = [](const FollowedPath& found) {
    std::string all;
    for (const Warning& doubt : found.doubts) all += doubt.message + "\n";
    return all;
  };
  const FollowedPath beyond = follow_with_report(sample, own.path.scaled(0.5), PathKeep::kStride);
  EXPECT_THAT(texts(beyond), testing::HasSubstr("leaves the end of the path"));
  const std::string half = number_text(0.5 * own.path.length(), 2);
  EXPECT_THAT(texts(beyond), testing::HasSubstr("straight on for " + half + " m"));
  const std::string travel = "travel " + number_text(own.path.length(), 3) + " m";
  EXPECT_THAT(beyond.notes[0].text, testing::HasSubstr(travel));
  const FollowedPath within = follow_with_report(sample, own.path.scaled(1.25), PathKeep::kStride);
  EXPECT_THAT(texts(within), testing::Not(testing::HasSubstr("leaves")));
  EXPECT_THAT(within.notes[0].text, testing::HasSubstr(travel));
  // Strides do not fit on a tight short path either.
  const GroundPath tight = circle_path(own.path.at(0.0), 0.3, 0.5 * own.path.length());
  const FollowedPath moved = follow_with_report(sample, tight);
  EXPECT_THAT(texts(moved), testing::HasSubstr("use a gentler path"));
  EXPECT_THAT(texts(moved), testing::Not(testing::HasSubstr("stride")));
  EXPECT_THAT(moved.notes[0].text, testing::Not(testing::HasSubstr("travel")));
}

// The feet of slower motion are planted at the played speed, not the original speed.
TEST(Rethreading, FeetStayPlantedAtConstantSpeed) {
  const EditSample& sample = data_sample("walk");
  const PathMotion own = path_of(sample);
  const GroundPath longer = circle_path(own.path.at(0.0), 1.5, 1.6 * own.path.length());
  const HumanClip slow = sample.human_of(follow_with_report(sample, longer, PathKeep::kSpeed).clip);
  const StepFacts steps = steps_of(slow, find_contacts(slow));
  EXPECT_LT(steps.slip, 0.02);
  EXPECT_GT(steps.mean_stride, 1.5);
}

// The walk with end sites instead of toe joints.
Clip walk_without_toe_joints() {
  const Clip& walk = data_sample("walk").clip;
  std::vector<Joint> joints;
  std::vector<int> kept;
  for (int i = 0; i < walk.skeleton().joint_count(); ++i) {
    Joint joint = walk.skeleton().joint(i);
    if (joint.name.ends_with("Toe")) {
      joints.back().end_sites = {joint.offset};
      continue;
    }
    // Omitted joints have no children.
    if (joint.parent >= 0) {
      joint.parent = static_cast<int>(std::ranges::find(kept, joint.parent) - kept.begin());
    }
    joints.push_back(joint);
    kept.push_back(i);
  }
  Clip clip(std::make_shared<const Skeleton>(joints), walk.rate(), walk.frame_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (std::size_t i = 0; i < kept.size(); ++i) {
      clip.rotations(frame)[i] = walk.rotations(frame)[kept[i]];
    }
    clip.translations(frame)[0] = walk.translations(frame)[0];
  }
  return clip;
}

// Without toe joints, the End Site of the foot is the toe: a foot on its toes turns about it, not
// about its ankle.
TEST(Rethreading, FeetWithoutToeJointsPivotOnTheirToes) {
  const EditSample &walk = data_sample("walk"), bare(walk_without_toe_joints());
  const PlantSummary with = follow_with_report(walk, path_of(walk).path.scaled(1.6)).feet,
                     without = follow_with_report(bare, path_of(bare).path.scaled(1.6)).feet;
  EXPECT_LT(with.largest_miss, 0.005);
  EXPECT_LT(without.largest_miss, 0.005);
  EXPECT_NEAR(without.largest_drop, with.largest_drop, 0.01);
}

TEST(Rethreading, UTurnDoesNotSpin) {
  // A walk out and back by a hairpin, and the same path straightened.
  const EditSample& sample = data_sample("walk");
  const GroundPose start = path_of(sample).path.at(0.0);
  const auto at = [&](double x, double y) { return start * Eigen::Vector2d(x, y); };
  const GroundPath hairpin = path_through(
      {at(0, 0), at(2, 0), at(3, 0.2), at(3.2, 0.6), at(3, 1), at(2, 1.2), at(0, 1.2)});
  const Clip there = follow_with_report(sample, hairpin).clip;
  const auto headings = hips_over_ground(sample.human_of(there));
  EXPECT_NEAR(headings.back().heading - headings.front().heading, kPi, 0.3);
  const EditSample again(there);
  const Clip straight = follow_with_report(again, line_path(start, 7.0)).clip;
  const auto after = hips_over_ground(sample.human_of(straight));
  for (std::size_t i = 1; i < after.size(); ++i) {
    ASSERT_LT(std::abs(after[i].heading - after[i - 1].heading), 0.25) << i;
    ASSERT_LT(std::abs(after[i].heading - after[0].heading), 1.0) << i;
  }
}

// Degrees; bent forwards positive, about the mean axis of bent knees in the shin.
std::vector<double> knee_angles(const Clip& clip, const LegJoints& leg) {
  std::vector<Pose> poses(static_cast<std::size_t>(clip.skeleton().joint_count()));
  std::vector<Eigen::Vector3d> across;
  std::vector<double> along;
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    forward_kinematics(clip, frame, poses);
    const Pose& knee = poses[leg.knee];
    const Eigen::Vector3d thigh = (knee.translation - poses[leg.hip].translation).normalized();
    const Eigen::Vector3d shin = (poses[leg.ankle].translation - knee.translation).normalized();
    across.push_back(knee.rotation.conjugate() * thigh.cross(shin));
    along.push_back(thigh.dot(shin));
    if (across.back().norm() > 0.35) axis += across.back();
  }
  std::vector<double> angles;
  for (std::size_t i = 0; i < across.size(); ++i) {
    angles.push_back(std::atan2(across[i].dot(axis.normalized()), along[i]) * 180.0 / kPi);
  }
  return angles;
}

// Almost straight legs, whose bend is noise, bend as knees do on other paths.
TEST(Rethreading, KneesBendForwards) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  struct Walk {
    const char* file;
    double max_joint_step;  // beyond the source's own, degrees from a frame to the next
  };
  for (const auto& [name, max_joint_step] :
       {Walk{"games105_walk60", 4.0}, Walk{"soma_walk_forward_120fps", 1.5}}) {
    const auto file = *shared / "data/dialects" / (std::string(name) + ".bvh");
    const EditSample sample(load_bvh(file.string()).value().clip);
    const PathMotion own = path_of(sample);
    const auto legs = find_legs(sample.clip.skeleton(), sample.calibration);
    for (const GroundPath& path : {own.path.scaled(0.8), own.path.scaled(1.1),
                                   circle_path(own.path.at(0.0), 3.0, own.path.length()),
                                   circle_path(own.path.at(0.0), 1.0, own.path.length())}) {
      const Clip moved = follow_with_report(sample, path).clip;
      for (const auto& leg : legs) {
        const auto before = knee_angles(sample.clip, *leg), after = knee_angles(moved, *leg);
        EXPECT_GT(*std::ranges::min_element(after), *std::ranges::min_element(before) - 0.5);
        for (std::size_t i = 1; i < after.size(); ++i) {
          const double own_step = std::abs(before[i] - before[i - 1]);
          ASSERT_LT(std::abs(after[i] - after[i - 1]), own_step + max_joint_step)
              << name << " " << i;
        }
      }
    }
  }
}

TEST(Rethreading, CornersAreTurnedAtALimitedRate) {
  const EditSample& sample = data_sample("walk");
  const GroundPose start = path_of(sample).path.at(0.0);
  const auto at = [&](double x, double y) { return start * Eigen::Vector2d(x, y); };
  for (const GroundPath& path :
       {path_through({at(0, 0), at(3.8, 0), at(0, 0)}),
        GroundPath({at(0, 0), at(1, 0), at(2, 0), at(3, 0), at(3, 1), at(3, 2), at(3, 3)})}) {
    const HumanClip moved = sample.human_of(follow_with_report(sample, path).clip);
    const auto hips = hips_over_ground(moved);
    for (std::size_t i = 1; i < hips.size(); ++i) {
      // 4 rad/s, plus the walk's own turning.
      ASSERT_LT(std::abs(hips[i].heading - hips[i - 1].heading), 0.2) << i;
    }
  }
}

TEST(Rethreading, HeadingFollowsTheBodyWhileStanding) {
  // The path reverses at a corner, where the body stands and turns left.
  const GroundPath path({{0, 0}, {1, 0}, {2, 0}, {2, 0}, {2, 0}, {1, 0}, {0, 0}});
  std::vector<double> along;
  for (int i = 0; i < 60; ++i)
    along.push_back(i < 20 ? 0.1 * i : i < 40 ? 2.0 : 2.0 + 0.1 * (i - 39));
  const std::vector<StillPhase> still{{20, 40, 0.0}};
  for (const double turn : {3.3, -2.9}) {
    const auto frames = path_frames(path, along, still, {turn});
    EXPECT_NEAR(frames.back().heading - frames.front().heading, turn > 0.0 ? kPi : -kPi, 1e-6);
    for (std::size_t i = 1; i < frames.size(); ++i) {
      EXPECT_LT(std::abs(frames[i].heading - frames[i - 1].heading), 0.5);
    }
  }
}

TEST(Rethreading, HandlesShortClipsAndDegeneratePaths) {
  const EditSample& walk = data_sample("walk");
  const auto try_it = [&](const Clip& clip, const GroundPath& path, PathKeep keep) {
    FollowPathOptions options;
    options.keep = keep;
    const auto result = follow_path(clip, walk.calibration, path, options);
    if (!result) {
      EXPECT_FALSE(result.error().message.empty());
      return;
    }
    EXPECT_EQ(result->clip.frame_count() > 0, clip.frame_count() > 0);
    EXPECT_TRUE(format_bvh(result->clip)) << "not finite";
  };
  Clip still = cut(walk.clip, 0, 40);
  for (int i = 1; i < 40; ++i) {
    std::ranges::copy(walk.clip.rotations(0), still.rotations(i).begin());
    std::ranges::copy(walk.clip.translations(0), still.translations(i).begin());
  }
  const std::vector<GroundPath> paths = {line_path({{1.0, 1.0}, 2.0}, 0.0), line_path({}, 0.05),
                                         GroundPath({{0, 0}, {0, 0}, {0, 0}, {0, 0}}),
                                         figure8_path({}, 6.0),
                                         path_through({{0, 0}, {1, 0}, {0, 0}, {1, 0}})};
  for (const Clip& clip : {cut(walk.clip, 0, 1), cut(walk.clip, 0, 0), still,
                           cut(walk.clip, 100, 103), cut(walk.clip, 30, 90)}) {
    for (const GroundPath& path : paths) {
      for (const PathKeep keep : {PathKeep::kTime, PathKeep::kStride, PathKeep::kSpeed}) {
        try_it(clip, path, keep);
      }
    }
  }
  EXPECT_FALSE(fit_path(cut(walk.clip, 0, 0), walk.calibration));
}

TEST(PathPictures, AreValidSvg) {
  const EditSample& sample = data_sample("walk");
  const GroundPath path = path_of(sample).path;
  const std::string svg = draw_paths(sample.calibration, {{&sample.clip, &path}});
  EXPECT_TRUE(svg.starts_with("<svg"));
  EXPECT_THAT(svg, testing::HasSubstr("polyline"));
  EXPECT_THAT(svg, testing::Not(testing::HasSubstr("nan")));
  EXPECT_LT(svg.size(), 100000u);
}

}  // namespace
}  // namespace retarget

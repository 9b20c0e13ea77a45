// Bodies in the files of a robot's variants, against the maker's models and MuJoCo.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "g1_maker_models.h"
#include "retarget/motion_io.h"
#include "robot/model/variant.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::Contains;
using ::testing::ElementsAreArray;
using ::testing::IsSupersetOf;
using ::testing::UnorderedElementsAreArray;

constexpr double kTolerance = 1e-6;
constexpr int kFrames = 20;

// A random root, and every joint within +-1 rad.
RobotClip random_clip(const std::shared_ptr<const Robot>& robot) {
  std::mt19937 random(23);
  std::uniform_real_distribution<double> one(-1.0, 1.0);
  RobotClip clip(robot, {50, 1}, kFrames);
  for (int frame = 0; frame < kFrames; ++frame) {
    const auto qpos = clip.qpos(frame);
    for (int i = 0; i < 7; ++i) qpos[i] = one(random);
    qpos[3] += 4.0;  // At most half a turn apart, so that signs do not change.
    const double norm =
        std::sqrt(qpos[3] * qpos[3] + qpos[4] * qpos[4] + qpos[5] * qpos[5] + qpos[6] * qpos[6]);
    for (int i = 3; i < 7; ++i) qpos[i] /= norm;
    for (const int joint : robot->output_joints()) {
      qpos[robot->joints()[joint].qpos_address] = one(random);
    }
  }
  return clip;
}

class VariantBodies : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    maker_ = robot_from_text(g1_maker_model(GetParam()));
    variant_ = value_of(robot_variant(load_g1(), std::to_string(GetParam())));
  }

  // The largest difference of a body position (m) or quaternion component, over all frames.
  [[nodiscard]] double difference(const TrackingMotion& motion) const {
    const mjModel& model = *maker_->model();
    const std::unique_ptr<mjData, void (*)(mjData*)> data(mj_makeData(&model), mj_deleteData);
    const std::size_t joints = motion.joint_names.size(), bodies = motion.body_names.size();
    double worst = 0.0;
    for (std::size_t frame = 0; frame < motion.frames; ++frame) {
      const double* place = motion.body_pos.data() + 3 * frame * bodies;
      const double* turn = motion.body_quat.data() + 4 * frame * bodies;
      std::copy_n(place, 3, data->qpos);
      std::copy_n(turn, 4, data->qpos + 3);
      for (std::size_t j = 0; j < joints; ++j) {
        const int id = mj_name2id(&model, mjOBJ_JOINT, motion.joint_names[j].c_str());
        EXPECT_GE(id, 0) << motion.joint_names[j];
        data->qpos[model.jnt_qposadr[id]] = motion.joint_pos[frame * joints + j];
      }
      mj_kinematics(&model, data.get());
      for (std::size_t b = 0; b < bodies; ++b) {
        const int id = mj_name2id(&model, mjOBJ_BODY, motion.body_names[b].c_str());
        EXPECT_GE(id, 0) << motion.body_names[b];
        double cosine = 0.0;
        for (int i = 0; i < 4; ++i) {
          cosine += data->xquat[4 * id + i] * turn[4 * b + static_cast<std::size_t>(i)];
        }
        const double sign = cosine < 0.0 ? -1.0 : 1.0;
        for (std::size_t i = 0; i < 4; ++i) {
          const double theirs = data->xquat[4 * static_cast<std::size_t>(id) + i];
          worst = std::max(worst, std::abs(sign * turn[4 * b + i] - theirs));
        }
        for (std::size_t i = 0; i < 3; ++i) {
          const double theirs = data->xpos[3 * static_cast<std::size_t>(id) + i];
          worst = std::max(worst, std::abs(place[3 * b + i] - theirs));
        }
      }
    }
    return worst;
  }

  std::shared_ptr<const Robot> maker_, variant_;
};

TEST_P(VariantBodies, MatchTheMakersPositionsAndOrder) {
  std::vector<std::string> names = maker_->body_names();
  names.erase(names.begin());  // the world
  TrackingOptions options;
  options.rate = {50, 1};
  const RobotClip clip = random_clip(variant_);
  for (const MotionFormat format : {MotionFormat::kNpzMjlab, MotionFormat::kNpzBeyondMimic}) {
    const auto motion = value_of(make_tracking_motion(clip, format, options));
    EXPECT_THAT(motion.joint_names, UnorderedElementsAreArray(maker_->joint_names()));
    EXPECT_THAT(motion.body_names, UnorderedElementsAreArray(names));
    if (format == MotionFormat::kNpzMjlab) {
      EXPECT_THAT(motion.joint_names, ElementsAreArray(maker_->joint_names()));
      EXPECT_THAT(motion.body_names, ElementsAreArray(names));
    }
    EXPECT_LT(difference(motion), kTolerance);
  }
}

// The names in trainer configurations: the anchor and the tracked bodies.
TEST_P(VariantBodies, IncludeTheBodiesOfTrainers) {
  const auto motion =
      value_of(make_tracking_motion(random_clip(variant_), MotionFormat::kNpzBeyondMimic));
  EXPECT_THAT(motion.body_names,
              IsSupersetOf({"pelvis", "left_hip_roll_link", "left_knee_link",
                            "left_ankle_roll_link", "right_hip_roll_link", "right_knee_link",
                            "right_ankle_roll_link", "torso_link", "left_shoulder_roll_link",
                            "left_elbow_link", "right_shoulder_roll_link", "right_elbow_link"}));
  EXPECT_THAT(motion.body_names,
              Contains(GetParam() == 23 ? "left_wrist_roll_rubber_hand" : "left_wrist_yaw_link"));
  EXPECT_EQ(motion.body_names.size(), GetParam() == 23 ? 24U : 30U);
}

TEST_P(VariantBodies, AllRoundTrip) {
  const RobotClip clip = random_clip(variant_);
  WriteMotionOptions writing;
  writing.tracking.rate = {50, 1};
  for (const MotionFormat format : {MotionFormat::kNpzMjlab, MotionFormat::kNpzBeyondMimic}) {
    const auto bytes = value_of(format_robot_motion(clip, format, writing));
    // Read them as the variant's file and as the whole robot's.
    for (const auto& robot : {variant_, load_g1()}) {
      const auto motion = value_of(parse_robot_motion(bytes, robot, "m.npz"));
      EXPECT_EQ(motion.format, format);
      const RobotClip again = with_robot(motion.clip, variant_);
      for (int frame = 0; frame < again.frame_count(); ++frame) {
        for (std::size_t i = 0; i < again.qpos(frame).size(); ++i) {
          ASSERT_NEAR(again.qpos(frame)[i], clip.qpos(frame)[i], kTolerance) << frame << " " << i;
        }
      }
    }
  }
}

// Files written when these variants had the whole robot's bodies without those that no column
// moves.
TEST_P(VariantBodies, ReadEarlierFiles) {
  RobotVariant earlier = variant_->variant();
  earlier.model.clear();
  earlier.bodies.clear();
  const auto held = value_of(make_variant(load_g1(), earlier));
  const auto bytes = value_of(format_robot_motion(random_clip(held), MotionFormat::kNpzMjlab));
  const auto motion = parse_robot_motion(bytes, load_g1(), "m.npz");
  EXPECT_TRUE(motion) << describe(motion.error());
}

INSTANTIATE_TEST_SUITE_P(G1, VariantBodies, testing::Values(23, 27),
                         [](const auto& joints) { return std::to_string(joints.param); });

}  // namespace
}  // namespace retarget

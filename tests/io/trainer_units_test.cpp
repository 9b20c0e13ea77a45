// Files of training frameworks state no units and orders: those of their formats are checked by the
// numbers and by the positions of bodies.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "base/option_name.h"
#include "formats/containers/npz.h"
#include "formats/containers/pickle.h"
#include "retarget/motion_io.h"
#include "retarget/pose.h"
#include "retarget/so3.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kDegree = 3.14159265358979323846 / 180.0;

// Deviations of a file from the motion.
struct TrainerFault {
  double angles = 1.0, lengths = 1.0;  // Factors.
  bool other_order = false;            // Of the root quaternion.
  bool reversed = false;               // Joints in the reverse order.
  double height = 0.0;                 // Added to the root, but not to the bodies.
  bool with_bodies = true;             // Positions of bodies and their names.
};

class TrainerUnits : public ::testing::Test {
 protected:
  // A standing G1 that moves all joints.
  [[nodiscard]] RobotClip motion(double swing = 0.3) const {
    RobotClip clip(robot_, {30, 1}, 40);
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      const auto qpos = clip.qpos(frame);
      const Eigen::Quaterniond turn =
          exp_so3({0.0, 0.0, 0.7}) * exp_so3({0.03 * std::sin(0.2 * frame), 0.05, 0.0});
      qpos[2] = 0.76;
      qpos[3] = turn.w();
      for (std::size_t i = 0; i < 3; ++i) qpos[4 + i] = turn.vec()[static_cast<int>(i)];
      for (std::size_t i = 7; i < qpos.size(); ++i) {
        qpos[i] = swing * std::sin(0.2 * frame + static_cast<double>(i));
      }
    }
    return clip;
  }

  struct Columns {
    std::vector<double> position, xyzw, wxyz, joints, world, local;
    std::size_t frames = 0, bodies = 0;
  };
  [[nodiscard]] Columns columns_of(const RobotClip& clip, const TrainerFault& fault) const {
    Columns columns;
    columns.frames = static_cast<std::size_t>(clip.frame_count());
    columns.bodies = robot_->bodies().size() - 1;
    std::vector<Pose> world_from_body(robot_->bodies().size());
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      const auto qpos = clip.qpos(frame);
      for (std::size_t i = 0; i < 3; ++i) {
        columns.position.push_back(fault.lengths * (qpos[i] + (i == 2 ? fault.height : 0.0)));
      }
      const std::vector<double> wxyz(qpos.begin() + 3, qpos.begin() + 7);
      const std::vector<double> xyzw = {wxyz[1], wxyz[2], wxyz[3], wxyz[0]};
      const auto& first = fault.other_order ? wxyz : xyzw;
      const auto& second = fault.other_order ? xyzw : wxyz;
      columns.xyzw.insert(columns.xyzw.end(), first.begin(), first.end());
      columns.wxyz.insert(columns.wxyz.end(), second.begin(), second.end());
      std::vector<double> joints;
      for (const int joint : robot_->output_joints()) {
        joints.push_back(fault.angles * qpos[robot_->joints()[joint].qpos_address]);
      }
      if (fault.reversed) std::ranges::reverse(joints);
      columns.joints.insert(columns.joints.end(), joints.begin(), joints.end());
      forward_kinematics(*robot_, qpos, world_from_body);
      const Pose root_from_world = world_from_body[robot_->root_body()].inverse();
      for (std::size_t b = 1; b <= columns.bodies; ++b) {
        const Eigen::Vector3d& place = world_from_body[b].translation;
        for (int i = 0; i < 3; ++i) columns.world.push_back(fault.lengths * place[i]);
        const Eigen::Vector3d local = root_from_world * place;
        for (int i = 0; i < 3; ++i) columns.local.push_back(local[i]);
      }
    }
    return columns;
  }
  [[nodiscard]] std::vector<std::string> bodies() const {
    std::vector<std::string> names = robot_->body_names();
    names.erase(names.begin());
    return names;
  }

  [[nodiscard]] std::string gmr(const RobotClip& clip, const TrainerFault& fault) const {
    const Columns columns = columns_of(clip, fault);
    const std::size_t frames = columns.frames, joints = robot_->output_joints().size();
    PickleWriter pickle;
    pickle.begin_dict();
    pickle.text("fps");
    pickle.integer(30);
    pickle.array("root_pos", float64_array(columns.position, {frames, 3}));
    pickle.array("root_rot", float64_array(columns.xyzw, {frames, 4}));
    pickle.array("dof_pos", float64_array(columns.joints, {frames, joints}));
    if (fault.with_bodies) {
      pickle.array("local_body_pos", float64_array(columns.local, {frames, columns.bodies, 3}));
    } else {
      pickle.text("local_body_pos");
      pickle.none();
    }
    pickle.text("link_body_list");
    pickle.texts(bodies());
    pickle.end_dict();
    return pickle.finish();
  }
  [[nodiscard]] std::string mimickit(const RobotClip& clip, const TrainerFault& fault) const {
    const Columns columns = columns_of(clip, fault);
    const std::size_t joints = robot_->output_joints().size();
    PickleWriter pickle;
    pickle.begin_dict();
    pickle.text("loop_mode");
    pickle.integer(0);
    pickle.text("fps");
    pickle.integer(30);
    pickle.text("frames");
    pickle.begin_list();
    for (std::size_t frame = 0; frame < columns.frames; ++frame) {
      pickle.begin_list();
      for (std::size_t i = 0; i < 3; ++i) pickle.number(columns.position[3 * frame + i]);
      for (int i = 0; i < 3; ++i) pickle.number(i == 2 ? 0.7 : 0.0);
      for (std::size_t i = 0; i < joints; ++i) {
        pickle.number(columns.joints[joints * frame + i]);
      }
      pickle.end_list();
    }
    pickle.end_list();
    pickle.end_dict();
    return pickle.finish();
  }
  [[nodiscard]] std::string holosoma(const RobotClip& clip, const TrainerFault& fault) const {
    const Columns columns = columns_of(clip, fault);
    const std::size_t frames = columns.frames, joints = robot_->output_joints().size();
    std::vector<double> rows, turns(4 * frames * columns.bodies, 0.0);
    for (std::size_t i = 0; i < turns.size(); i += 4) turns[i] = 1.0;
    const auto append = [&](const std::vector<double>& from, std::size_t frame, std::size_t width) {
      const auto begin = from.begin() + static_cast<std::ptrdiff_t>(frame * width);
      rows.insert(rows.end(), begin, begin + static_cast<std::ptrdiff_t>(width));
    };
    for (std::size_t frame = 0; frame < frames; ++frame) {
      append(columns.position, frame, 3);
      append(columns.wxyz, frame, 4);
      append(columns.joints, frame, joints);
    }
    std::vector<std::string> names;
    for (const int joint : robot_->output_joints()) names.push_back(robot_->joints()[joint].name);
    NpzWriter npz;
    npz.add("fps", float64_array(std::vector<double>{30.0}, {1}));
    npz.add("joint_pos", float64_array(rows, {frames, 7 + joints}));
    npz.add("body_pos_w", float64_array(columns.world, {frames, columns.bodies, 3}));
    npz.add("body_quat_w", float64_array(turns, {frames, columns.bodies, 4}));
    npz.add("joint_names", text_array(names));
    if (fault.with_bodies) npz.add("body_names", text_array(bodies()));
    return npz.finish().value();
  }

  [[nodiscard]] Result<RobotMotion> read(const std::string& bytes,
                                         const ReadMotionOptions& options = {}) const {
    return parse_robot_motion(bytes, robot_, "m", options);
  }
  void expect_sound(const std::string& bytes, const ReadMotionOptions& options = {}) const {
    const auto found = value_of(read(bytes, options));
    EXPECT_THAT(found.warnings, IsEmpty());
  }
  [[nodiscard]] std::string fault_of(const std::string& bytes) const {
    const auto found = read(bytes);
    if (found) return "no error";
    EXPECT_EQ(found.error().kind, ErrorKind::kInput);
    return describe(found.error(), option_as_flag);
  }

  std::shared_ptr<const Robot> robot_ = load_g1();
};

TEST_F(TrainerUnits, SoundFilesAreRead) {
  for (const bool with_bodies : {true, false}) {
    const TrainerFault none{.with_bodies = with_bodies};
    expect_sound(gmr(motion(), none));
    expect_sound(holosoma(motion(), none));
  }
  expect_sound(mimickit(motion(), {}));
}

TEST_F(TrainerUnits, DegreesAreAnError) {
  const TrainerFault degrees{.angles = 1.0 / kDegree, .with_bodies = false};
  const auto words = [](const char* remedy) {
    return AllOf(HasSubstr(" in frame "), HasSubstr("rad, and the format "),
                 HasSubstr("are these degrees?"), HasSubstr("_joint is "), HasSubstr(remedy));
  };
  EXPECT_THAT(fault_of(gmr(motion(), degrees)), words("--source-angles deg"));
  EXPECT_THAT(fault_of(mimickit(motion(), degrees)), words("--source-angles deg"));
  EXPECT_THAT(fault_of(holosoma(motion(), degrees)), words("convert the joints to radians"));
  ReadMotionOptions given;
  given.degrees = true;
  const auto read_so = value_of(read(gmr(motion(), degrees), given));
  EXPECT_NEAR(read_so.clip.qpos(3)[9], motion().qpos(3)[9], 1e-9);
  // Angles below the widest range; the bodies decide.
  EXPECT_THAT(fault_of(gmr(motion(0.05), {.angles = 1.0 / kDegree})),
              HasSubstr("they fit if the joints are in degrees"));
}

TEST_F(TrainerUnits, OtherUnitsOfLengthAreAnError) {
  for (const double scale : {100.0, 1000.0}) {
    const TrainerFault fault{.lengths = scale, .with_bodies = false};
    EXPECT_THAT(fault_of(gmr(motion(), fault)),
                AllOf(HasSubstr("m high in frame 0"), HasSubstr("is it in centimetres"),
                      HasSubstr("--source-unit cm")));
    EXPECT_THAT(fault_of(mimickit(motion(), fault)), HasSubstr("is it in centimetres"));
    EXPECT_THAT(fault_of(holosoma(motion(), fault)), HasSubstr("convert the positions to metres"));
  }
  EXPECT_THAT(fault_of(holosoma(motion(), {.lengths = 100.0})),
              HasSubstr("they fit if lengths are in centimetres"));
  EXPECT_THAT(fault_of(gmr(motion(), {.lengths = 0.01})), HasSubstr("may not be in metres"));
  // A robot on a roof: bodies in the world confirm its height.
  RobotClip high = motion();
  for (int frame = 0; frame < high.frame_count(); ++frame) high.qpos(frame)[2] += 20.0;
  expect_sound(holosoma(high, {}));
  EXPECT_THAT(fault_of(gmr(high, {})), HasSubstr("--source-unit"));
  ReadMotionOptions given;
  given.metres_per_unit = 1.0;
  expect_sound(gmr(high, {}), given);
}

TEST_F(TrainerUnits, BodiesContradictOtherOrders) {
  const std::string away = "away from the forward kinematics of the robot unitree_g1";
  EXPECT_THAT(fault_of(gmr(motion(), {.reversed = true})),
              AllOf(HasSubstr(away), HasSubstr("another order"), HasSubstr("--from pkl-gmr")));
  EXPECT_THAT(fault_of(holosoma(motion(), {.reversed = true})), HasSubstr(away));
  EXPECT_THAT(fault_of(holosoma(motion(), {.other_order = true})),
              AllOf(HasSubstr(away), HasSubstr("they fit if the root quaternion is x y z w")));
  EXPECT_THAT(fault_of(holosoma(motion(), {.height = 1.0})), HasSubstr(away));
  // The user's choice of a format serves files of other robots.
  ReadMotionOptions chosen;
  chosen.format = MotionFormat::kPklGmr;
  EXPECT_TRUE(read(gmr(motion(), {.reversed = true}), chosen));
  chosen.format = MotionFormat::kNpzHolosoma;
  EXPECT_FALSE(read(gmr(motion(), {.reversed = true}), chosen));
}

}  // namespace
}  // namespace retarget

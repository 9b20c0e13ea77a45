#include "formats/smpl/read_smpl.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "smpl/motion_parts.h"
#include "smpl_test_support.h"
#include "support/load_smpl.h"
#include "support/shared_data.h"
#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::Not;
using ::testing::SizeIs;

constexpr std::size_t kFrames = 4;

std::string number(double value) {
  return npy_doubles({}, {value});
}

// Random poses with hands at rest.
std::vector<double> poses_of_bodies() {
  std::vector<double> poses = Numbers(3).list(kFrames * 156, 1.2);
  for (std::size_t frame = 0; frame < kFrames; ++frame) {
    std::fill_n(poses.begin() + static_cast<long>(frame * 156 + 66), 90, 0.0);
  }
  return poses;
}

// The arrays of a valid AMASS file; some of them replaced or, if empty, omitted.
struct Amass {
  std::size_t width = 156;
  std::vector<double> poses = poses_of_bodies();
  std::vector<double> trans = Numbers(4).list(kFrames * 3);
  std::vector<std::pair<std::string, std::string>> replaced;

  Amass& with(const std::string& name, const std::string& bytes) {
    replaced.emplace_back(name, bytes);
    return *this;
  }
  Amass& without(const std::string& name) { return with(name, ""); }

  [[nodiscard]] std::string bytes() const {
    std::vector<std::pair<std::string, std::string>> arrays = {
        {"poses", npy_doubles({kFrames, width}, poses)},
        {"trans", npy_doubles({kFrames, 3}, trans)},
        {"betas", npy_doubles({16}, std::vector<double>(16))},
        {"mocap_framerate", number(120)},
        {"gender", npy_text("male")}};
    for (const auto& [name, bytes] : replaced) {
      const auto same = [&name = name](const auto& array) { return array.first == name; };
      std::erase_if(arrays, same);
      if (!bytes.empty()) arrays.emplace_back(name, bytes);
    }
    NpzBuilder builder;
    for (const auto& [name, bytes] : arrays) builder.add(name, bytes);
    return builder.build();
  }
};

SmplMotion amass_motion(const Amass& amass, const ArrayReadOptions& options = {}) {
  return value_of(read_smpl(amass.bytes(), "walk.npz", options));
}

std::string amass_error(const Amass& amass, const ArrayReadOptions& options = {}) {
  const Result<SmplMotion> motion = read_smpl(amass.bytes(), "walk.npz", options);
  if (motion) return "no error";
  EXPECT_EQ(motion.error().kind, ErrorKind::kInput);
  EXPECT_EQ(motion.error().location.file, "walk.npz");
  return describe(motion.error());
}

void expect_same_clip(const Clip& a, const Clip& b) {
  ASSERT_EQ(a.frame_count(), b.frame_count());
  for (int frame = 0; frame < a.frame_count(); ++frame) {
    for (int joint = 0; joint < kSmplJointCount; ++joint) {
      EXPECT_EQ(a.rotations(frame)[joint].coeffs(), b.rotations(frame)[joint].coeffs());
      EXPECT_EQ(a.translation(frame, joint), b.translation(frame, joint));
    }
  }
}

// Rodrigues' formula.
Eigen::Matrix3d turned_by(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  if (angle == 0.0) return Eigen::Matrix3d::Identity();
  const Eigen::Vector3d axis = w / angle;
  Eigen::Matrix3d cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return Eigen::Matrix3d::Identity() + std::sin(angle) * cross +
         (1.0 - std::cos(angle)) * cross * cross;
}

// The models' own recursion: x_j = R_parent (J_j - J_parent) + x_parent, x_0 = J_0 + trans.
void expect_kinematics(const Amass& amass, const SmplMotion& motion, const SmplRestBody& body) {
  std::vector<Pose> found(kSmplJointCount);
  for (std::size_t frame = 0; frame < kFrames; ++frame) {
    std::vector<Eigen::Matrix3d> rotation(kSmplJointCount);
    std::vector<Eigen::Vector3d> position(kSmplJointCount);
    for (int joint = 0; joint < kSmplJointCount; ++joint) {
      const double* row = amass.poses.data() + frame * amass.width + 3 * joint;
      const Eigen::Matrix3d local = turned_by({row[0], row[1], row[2]});
      const int parent = kSmplParents[joint];
      if (parent < 0) {
        const double* trans = amass.trans.data() + 3 * frame;
        rotation[joint] = local;
        position[joint] = body.joints[joint] + Eigen::Vector3d(trans[0], trans[1], trans[2]);
        continue;
      }
      rotation[joint] = rotation[parent] * local;
      position[joint] =
          rotation[parent] * (body.joints[joint] - body.joints[parent]) + position[parent];
    }
    forward_kinematics(motion.clip, static_cast<int>(frame), found);
    for (int joint = 0; joint < kSmplJointCount; ++joint) {
      const int place = *motion.clip.skeleton().find(kSmplJointNames[joint]);
      EXPECT_LT((found[place].translation - position[joint]).norm(), 1e-12);
      EXPECT_LT((found[place].rotation.toRotationMatrix() - rotation[joint]).norm(), 1e-12);
    }
  }
}

TEST(ReadSmpl, ReadsAnAmassMotion) {
  const Amass amass;
  const SmplMotion motion = amass_motion(amass);
  EXPECT_EQ(motion.clip.frame_count(), static_cast<int>(kFrames));
  EXPECT_EQ(motion.clip.rate(), (FrameRate{120, 1}));
  EXPECT_EQ(motion.gender, "male");
  EXPECT_EQ(motion.betas, std::vector<double>(16));
  EXPECT_EQ(motion.family, SmplFamily::kSmpl);
  EXPECT_TRUE(motion.approximate_body);
  EXPECT_DOUBLE_EQ(motion.height, 1.66);
  EXPECT_THAT(motion.warnings, IsEmpty());
  expect_kinematics(amass, motion, generic_smpl_rest_body(1.66));
}

TEST(ReadSmpl, SmallAndFullRotationsAreExact) {
  Amass amass;
  for (const double angle : {0.0, 5e-324, 1e-160, 1e-9, 1e-5, 1e-4, 3.1, 3.15, 6.5, -12.0}) {
    for (std::size_t i = 0; i < amass.poses.size(); ++i) amass.poses[i] = i % 3 == 1 ? angle : 0.0;
    const SmplMotion motion = amass_motion(amass);
    for (const Eigen::Quaterniond& rotation : motion.clip.rotations(1)) {
      EXPECT_NEAR(rotation.w(), std::cos(angle / 2), 1e-15);
      EXPECT_NEAR(rotation.y(), std::sin(angle / 2), 1e-15 * std::max(1.0, std::abs(angle)));
      EXPECT_EQ(rotation.x(), 0.0);
      EXPECT_NEAR(rotation.norm(), 1.0, 1e-15);
    }
  }
}

TEST(ReadSmpl, UsesJointsOfTheUsersModel) {
  const MadeUpModel model(24, 3);
  const auto body = value_of(read_smpl_body(model.bytes(), "model.npz"));
  ArrayReadOptions options;
  options.body = &body;
  Amass amass;
  const std::vector<double> betas = {0.5, -1.0, 2.0};
  amass.with("betas", npy_doubles({3}, betas));
  const SmplMotion motion = amass_motion(amass, options);
  EXPECT_FALSE(motion.approximate_body);
  EXPECT_NEAR(motion.height, model.shaped(0, 1, betas) - model.shaped(5, 1, betas), 1e-12);
  EXPECT_THAT(motion.warnings, IsEmpty());
  SmplRestBody expected;
  for (std::size_t i = 0; i < expected.joints.size(); ++i) {
    expected.joints[i] = model.joint(i, betas);
  }
  expect_kinematics(amass, motion, expected);
}

TEST(ReadSmpl, WarnsAboutBetasThatDoNotFitTheModel) {
  const Result<SmplBody> smpl = read_smpl_body(MadeUpModel(24, 3).bytes(), "smpl.npz");
  const Result<SmplBody> smplx = read_smpl_body(MadeUpModel(55, 3).bytes(), "smplx.npz");
  ASSERT_TRUE(smpl.has_value() && smplx.has_value());
  ArrayReadOptions options;
  options.body = &*smpl;

  // Additional zeros cause no warning.
  EXPECT_THAT(amass_motion(Amass(), options).warnings, IsEmpty());
  const std::string betas = npy_doubles({5}, {1, 0, 0, 0, 2});
  const SmplMotion more = amass_motion(Amass().with("betas", betas), options);
  EXPECT_THAT(warnings_of(more), HasSubstr("has 3 betas, the motion 5"));
  EXPECT_NE(more.clip.skeleton().joint(5).offset,
            amass_motion(Amass(), options).clip.skeleton().joint(5).offset);

  // SMPL-X has other shapes: the mean shape is used.
  options.body = &*smplx;
  const SmplMotion other = amass_motion(Amass().with("betas", betas), options);
  EXPECT_THAT(warnings_of(other), HasSubstr("betas belong to SMPL or SMPL+H"));
  EXPECT_EQ(other.clip.skeleton().joint(5).offset,
            amass_motion(Amass(), options).clip.skeleton().joint(5).offset);
}

TEST(ReadSmpl, DropsHandsAndFace) {
  const Amass whole;
  const Clip expected = amass_motion(whole).clip;
  for (const std::size_t width : {66, 72, 165}) {
    Amass other;
    other.width = width;
    other.poses.clear();
    for (std::size_t frame = 0; frame < kFrames; ++frame) {
      for (std::size_t i = 0; i < width; ++i) {
        // Hands are unrestricted.
        other.poses.push_back(i < 66 ? whole.poses[frame * 156 + i]
                                     : std::numeric_limits<double>::quiet_NaN());
      }
    }
    const SmplMotion motion = amass_motion(other);
    expect_same_clip(motion.clip, expected);
    EXPECT_EQ(motion.family, width == 165  ? SmplFamily::kSmplx
                             : width == 72 ? SmplFamily::kSmpl
                                           : SmplFamily::kUnknown);
    Amass cubed = other;
    cubed.with("poses", npy_doubles({kFrames, width / 3, 3}, other.poses));
    expect_same_clip(amass_motion(cubed).clip, expected);
  }
}

TEST(ReadSmpl, ReadsSmplxSpellings) {
  const Amass whole;
  const Clip expected = amass_motion(whole).clip;
  std::vector<double> root, body, with_hands;
  for (std::size_t frame = 0; frame < kFrames; ++frame) {
    const auto row = whole.poses.begin() + static_cast<long>(frame * 156);
    root.insert(root.end(), row, row + 3);
    body.insert(body.end(), row + 3, row + 66);
    with_hands.insert(with_hands.end(), row + 3, row + 72);
  }
  Amass smplx;
  smplx.without("mocap_framerate").with("mocap_frame_rate", number(120));
  // SMPL-X files contain both forms.
  smplx.with("poses", npy_doubles({kFrames, 165}, std::vector<double>(kFrames * 165)));
  smplx.with("root_orient", npy_doubles({kFrames, 3}, root));
  smplx.with("pose_body", npy_doubles({kFrames, 63}, body));
  smplx.with("pose_jaw", npy_doubles({kFrames, 3}, std::vector<double>(kFrames * 3)));
  SmplMotion motion = amass_motion(smplx);
  expect_same_clip(motion.clip, expected);
  EXPECT_EQ(motion.family, SmplFamily::kSmplx);

  smplx.without("poses").without("pose_jaw");
  EXPECT_EQ(amass_motion(smplx).family, SmplFamily::kUnknown);
  smplx.with("surface_model_type", npy_text("smplx_locked_head"));
  EXPECT_EQ(amass_motion(smplx).family, SmplFamily::kSmplx);
  smplx.with("surface_model_type", npy_text("smplh"));
  EXPECT_EQ(amass_motion(smplx).family, SmplFamily::kSmpl);

  smplx.with("pose_body", npy_doubles({kFrames, 21, 3}, body));
  expect_same_clip(amass_motion(smplx).clip, expected);
  smplx.with("pose_body", npy_doubles({kFrames, 69}, with_hands));
  expect_same_clip(amass_motion(smplx).clip, expected);
}

TEST(ReadSmpl, ReadsEveryFormOfTheFrameRate) {
  const auto rate = [](const std::string& name, const std::string& bytes) {
    return amass_motion(Amass().without("mocap_framerate").with(name, bytes)).clip.rate();
  };
  EXPECT_EQ(rate("mocap_framerate", number(59.94)), (FrameRate{2997, 50}));
  EXPECT_EQ(rate("mocap_frame_rate", npy_doubles({1}, {120.00001})), (FrameRate{120, 1}));
  EXPECT_EQ(rate("fps", npy("<i8", "()", element_bytes<std::int64_t>({30}))), (FrameRate{30, 1}));
  EXPECT_EQ(rate("fps", npy("|u1", "(1, 1)", "\x64")), (FrameRate{100, 1}));
  EXPECT_EQ(amass_motion(Amass().with("fps", number(120))).clip.rate(), (FrameRate{120, 1}));
}

TEST(ReadSmpl, RoundedRatesAreOneRate) {
  const auto with_rates = [](const std::string& names, double fps, double seconds) {
    return amass_motion(Amass().with("mocap_framerate", number(fps)).with(names, number(seconds)));
  };
  const auto warned = [](const SmplMotion& motion) {
    return motion.warnings.empty() ? std::string() : motion.warnings.front().message;
  };
  const double four_bytes = static_cast<float>(0.0333);
  for (const double seconds : {0.033, 0.0333, 0.03, 0.033333, 1.0 / 30.0, four_bytes}) {
    const SmplMotion motion = with_rates("dt", 30, seconds);
    EXPECT_EQ(motion.clip.rate(), (FrameRate{30, 1})) << seconds;
    EXPECT_THAT(warned(motion), Not(HasSubstr("ignored"))) << seconds;
  }
  for (const double seconds : {0.005, 1.0 / 60.0, 0.035, 0.032, 0.04}) {
    const SmplMotion motion = with_rates("frame_time", 30, seconds);
    EXPECT_EQ(motion.clip.rate(), (FrameRate{30, 1})) << seconds;
    EXPECT_THAT(warned(motion), HasSubstr("frame_time is ignored: it gives ")) << seconds;
    EXPECT_THAT(warned(motion), HasSubstr(" frames per second, mocap_framerate 30")) << seconds;
  }
  // The number with more digits is the rate.
  EXPECT_EQ(with_rates("fps", 30, 29.97).clip.rate(), (FrameRate{2997, 100}));
  const auto times = [&](double first, double second) {
    return amass_motion(Amass()
                            .without("mocap_framerate")
                            .with("frame_time", number(first))
                            .with("dt", number(second)));
  };
  EXPECT_EQ(times(0.033, 1.0 / 30.0).clip.rate(), (FrameRate{30, 1}));
  EXPECT_THAT(warned(times(0.033, 1.0 / 30.0)), Not(HasSubstr("ignored")));
  EXPECT_EQ(times(0.02, 0.005).clip.rate(), (FrameRate{50, 1}));
  EXPECT_THAT(warned(times(0.02, 0.005)),
              HasSubstr("dt is ignored: it gives 200 frames per second, frame_time 50"));
  EXPECT_EQ(times(33.3, 0.02).clip.rate(), (FrameRate{50, 1})) << "not in seconds";
}

TEST(ReadSmpl, RequiresARateOrOverride) {
  ArrayReadOptions given;
  given.source_fps = 50.0;
  const auto both = [&](const Amass& amass, const std::string& words) {
    EXPECT_THAT(amass_error(amass), HasSubstr(words));
    EXPECT_THAT(amass_error(amass), HasSubstr("hint: give the frame rate with source_fps"));
    EXPECT_EQ(amass_motion(amass, given).clip.rate(), (FrameRate{50, 1}));
  };
  both(Amass().without("mocap_framerate"), "no frame rate: found none of mocap_framerate");
  both(Amass().with("mocap_framerate", number(0)), "above 0, found 0");
  both(Amass().with("mocap_framerate", number(std::nan(""))), "above 0, found");
  both(Amass().with("mocap_framerate", npy_text("30")), "expected one number, found text");
  both(Amass().with("mocap_framerate", npy_doubles({2}, {30, 30})), "found numbers of shape (2,)");
  both(Amass().with("fps", number(119)), "119 frames per second, but mocap_framerate says 120");
  both(Amass().with("fps", number(30)), "30 frames per second, but mocap_framerate says 120");
  EXPECT_EQ(amass_motion(Amass(), given).clip.rate(), (FrameRate{50, 1}));

  for (const double wrong : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    given.source_fps = wrong;
    const auto motion = read_smpl(Amass().bytes(), "walk.npz", given);
    ASSERT_FALSE(motion.has_value());
    EXPECT_EQ(motion.error().kind, ErrorKind::kUsage);
  }
}

TEST(ReadSmpl, ReadsEveryFormOfTheGender) {
  const auto gender = [](const std::string& bytes) {
    const SmplMotion motion = amass_motion(Amass().with("gender", bytes));
    EXPECT_EQ(motion.warnings.empty(), !motion.gender.empty());
    return motion.gender;
  };
  EXPECT_EQ(gender(npy_text("neutral")), "neutral");
  EXPECT_EQ(gender(npy("|S6", "()", "female")), "female");
  EXPECT_EQ(gender(npy("|S8", "(1,)", std::string("male\0\0\0\0", 8))), "male");
  EXPECT_EQ(gender(npy_text("b'female'")), "female");
  EXPECT_EQ(gender(npy_text("Male")), "male");
  EXPECT_EQ(gender(npy_text("other")), "");
  EXPECT_EQ(gender(npy("|O", "()",
                       "\x80\x03"
                       "C\x04male.")),
            "");
  EXPECT_EQ(gender(number(1)), "");
  EXPECT_EQ(gender(npy("<U4", "(0,)", "")), "");
  EXPECT_THAT(warnings_of(amass_motion(Amass().without("gender"))), HasSubstr("no gender"));
}

TEST(ReadSmpl, ReadsHeightFromBetas) {
  const auto height = [](const std::string& betas) {
    return amass_motion(Amass().with("betas", betas)).height;
  };
  EXPECT_DOUBLE_EQ(height(npy_doubles({10}, {2, 9, 9, 9, 9, 9, 9, 9, 9, 9})), 1.86);
  EXPECT_DOUBLE_EQ(height(npy_doubles({1, 2}, {-1, 5})), 1.56);
  EXPECT_DOUBLE_EQ(height(npy_doubles({0}, {})), 1.66);
  const SmplMotion without = amass_motion(Amass().without("betas"));
  EXPECT_DOUBLE_EQ(without.height, 1.66);
  EXPECT_THAT(warnings_of(without), HasSubstr("no betas"));

  const SmplMotion changing =
      amass_motion(Amass().with("betas", npy_doubles({kFrames, 2}, {1, 0, 2, 0, 2, 0, 2, 0})));
  EXPECT_DOUBLE_EQ(changing.height, 1.76);
  EXPECT_THAT(warnings_of(changing), HasSubstr("vary over time"));

  const std::vector<double> rows(2 * (kFrames + 1));
  EXPECT_THAT(amass_error(Amass().with("betas", npy_doubles({kFrames + 1, 2}, rows))),
              HasSubstr("rows, the rotations have"));

  const Amass absurd = Amass().with("betas", npy_doubles({1}, {40}));
  EXPECT_THAT(amass_error(absurd), HasSubstr("would give a body height of 5.66"));
  EXPECT_THAT(amass_error(absurd), HasSubstr("give the body model with smpl_model"));
}

TEST(ReadSmpl, ClipStaysWithinTheMemoryLimit) {
  ArrayReadOptions options;
  options.max_clip_bytes = 500;
  EXPECT_THAT(amass_error(Amass{}, options), HasSubstr("of memory, at most 500 are allowed"));
  Amass narrow;
  narrow.width = 66;
  narrow.poses.resize(kFrames * 66);
  options.max_clip_bytes = kFrames * (22 * 32 + 24);
  EXPECT_EQ(amass_motion(narrow, options).clip.frame_count(), kFrames);
  --options.max_clip_bytes;
  EXPECT_THAT(amass_error(narrow, options), HasSubstr("4 frames take 0 MB of memory"));
}

TEST(ReadSmpl, RejectsBadArraysByNameAndFrame) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Amass amass;
  amass.poses[2 * 156 + 65] = nan;
  EXPECT_THAT(amass_error(amass), HasSubstr("array \"poses\": NaN in frame 2, column 65"));
  amass.poses[2 * 156 + 65] = 0;
  amass.poses[156 + 3] = -HUGE_VAL;
  EXPECT_THAT(amass_error(amass), HasSubstr("array \"poses\": infinity in frame 1, column 3"));
  amass.poses[156 + 3] = 180;
  EXPECT_THAT(amass_error(amass), HasSubstr("in radians, found 180.000000 in frame 1, column 3"));
  // Degrees below 100, in three joints; in radians, a root may turn several times.
  amass = Amass();
  for (std::size_t frame = 0; frame < kFrames; ++frame) amass.poses[frame * 156] = 20.0;
  amass_motion(amass);
  for (const std::size_t joint : {4U, 5U, 18U}) amass.poses[156 + 3 * joint + 1] = 50.0 + joint;
  EXPECT_THAT(amass_error(amass), AllOf(HasSubstr("found 68.000000 in frame 1, left_elbow"),
                                        HasSubstr("are these degrees?")));
  amass.poses[156 + 3 * 4 + 1] = 1.0;
  amass_motion(amass);
  amass = Amass();
  amass.trans[10] = nan;
  EXPECT_THAT(amass_error(amass), HasSubstr("array \"trans\": NaN in frame 3, column 1"));

  const auto with = [](const std::string& name, const std::string& bytes) {
    return amass_error(Amass().with(name, bytes));
  };
  EXPECT_THAT(with("betas", npy_doubles({2}, {0, nan})), HasSubstr("betas\": number 1 is not fin"));
  EXPECT_THAT(with("betas", npy_text("x")), HasSubstr("betas\": expected a row of numbers"));
  EXPECT_THAT(with("trans", npy_doubles({3, 3}, std::vector<double>(9))),
              HasSubstr("array \"trans\": it has 3 frames, the rotations have 4"));
  EXPECT_THAT(with("trans", npy_doubles({12}, std::vector<double>(12))),
              HasSubstr("expected numbers of shape (frames, 3), found (12,)"));
  EXPECT_THAT(with("poses", npy_doubles({4, 63}, std::vector<double>(4 * 63))),
              HasSubstr("(frames, 66) or (frames, 72) or (frames, 156) or (frames, 165), found "
                        "(4, 63)"));
  EXPECT_THAT(with("poses", npy("<f8", "(4, 61489146912365172, 0)", "")),
              HasSubstr("expected numbers of shape"));
  EXPECT_THAT(with("poses", npy_doubles({0, 72}, {})), HasSubstr("poses\": it has no frames"));
  EXPECT_THAT(with("poses", npy("|O", "(4, 72)", "pickled")),
              HasSubstr("array \"poses\": it contains Python objects"));
  EXPECT_THAT(with("poses", npy_text("none")), HasSubstr("found text of ()"));
  EXPECT_THAT(amass_error(Amass().without("trans")), HasSubstr("no array \"trans\""));
}

TEST(ReadSmpl, RejectsInconsistentParts) {
  Amass amass;
  amass.without("poses").with("root_orient", npy_doubles({4, 3}, std::vector<double>(12)));
  EXPECT_THAT(amass_error(amass), HasSubstr("joint positions as \"joint_positions\"; found trans"));
  amass.with("pose_body", npy_doubles({3, 63}, std::vector<double>(189)));
  EXPECT_THAT(amass_error(amass), HasSubstr("pose_body\": it has 3 frames, root_orient has 4"));
}

TEST(ReadSmpl, NamesOtherFileTypes) {
  EXPECT_THAT(amass_error(Amass().without("poses")), HasSubstr("motions are *_poses.npz"));
  const auto model = read_smpl(MadeUpModel(24, 3).bytes(), "model.npz");
  ASSERT_FALSE(model.has_value());
  EXPECT_THAT(model.error().hint, HasSubstr("this is a body model"));
  const auto pickle = read_smpl("\x80\x04\x95", "motion.pkl");
  ASSERT_FALSE(pickle.has_value());
  EXPECT_THAT(pickle.error().message, HasSubstr("the pickle is cut off"));
}

TEST(ReadSmpl, FloatTypeAndOrderDoNotMatter) {
  Amass amass;
  std::vector<float> floats(amass.poses.begin(), amass.poses.end());
  amass.poses.assign(floats.begin(), floats.end());
  const Clip expected = amass_motion(amass).clip;
  expect_same_clip(
      amass_motion(Amass(amass).with("poses", npy_floats({kFrames, 156}, floats))).clip, expected);
  std::vector<float> fortran;
  for (std::size_t column = 0; column < 156; ++column) {
    for (std::size_t frame = 0; frame < kFrames; ++frame) {
      fortran.push_back(floats[frame * 156 + column]);
    }
  }
  const std::string columns = npy("<f4", "(4, 156)", element_bytes(fortran), true);
  expect_same_clip(amass_motion(Amass(amass).with("poses", columns)).clip, expected);
}

TEST(ReadSmpl, ReadsOrRejectsEveryTruncationAndChange) {
  const std::string bytes = Amass()
                                .with("poses", npy_doubles({1, 66}, Numbers(5).list(66)))
                                .with("trans", npy_doubles({1, 3}, {1, 2, 3}))
                                .bytes();
  ASSERT_TRUE(read_smpl(bytes, "walk.npz").has_value());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(read_smpl(std::string_view(bytes).substr(0, size), "walk.npz").has_value());
  }
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(~changed[at]);
    const auto motion = read_smpl(changed, "walk.npz");
    EXPECT_TRUE(motion.has_value() || !motion.error().message.empty());
  }
}

// Height of the lowest toes over a clip, and mean height of the head above the pelvis.
struct Extent {
  double lowest_toes = HUGE_VAL;
  double mean_head = 0.0;
};

Extent extent_of(const Clip& clip) {
  Extent extent;
  std::vector<Pose> world(kSmplJointCount);
  const int head = *clip.skeleton().find("head");
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    forward_kinematics(clip, frame, world);
    for (const char* name : {"left_foot", "right_foot"}) {
      const double height = world[*clip.skeleton().find(name)].translation.z();
      extent.lowest_toes = std::min(extent.lowest_toes, height);
    }
    extent.mean_head += (world[head].translation - world[0].translation).z() / clip.frame_count();
  }
  return extent;
}

TEST(ReadSmpl, RealMotionsStandOnTheFloorWithZUp) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(*shared / "data" / "smpl")) {
    if (entry.path().extension() != ".npz") continue;
    SCOPED_TRACE(entry.path().filename().string());
    const auto motion = value_of(load_smpl(entry.path().string()));
    EXPECT_EQ(motion.clip.rate(), (FrameRate{30, 1}));
    EXPECT_EQ(motion.gender, "neutral");
    EXPECT_THAT(motion.betas, SizeIs(16));
    EXPECT_THAT(motion.warnings, IsEmpty());
    const Extent extent = extent_of(motion.clip);
    EXPECT_NEAR(extent.lowest_toes, 0.02, 0.08);
    EXPECT_NEAR(extent.mean_head, 0.362 * 1.66, 0.05);
    ++files;
  }
  EXPECT_GT(files, 0);
}

TEST(LoadSmpl, ReportsMissingFiles) {
  const TemporaryFolder folder;
  const std::string path = folder.write("walk.npz", Amass().bytes());
  EXPECT_TRUE(load_smpl(path).has_value());
  const auto missing = load_smpl(path + "x");
  ASSERT_FALSE(missing.has_value());
  EXPECT_EQ(missing.error().kind, ErrorKind::kInput);
}

}  // namespace
}  // namespace retarget

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/option_name.h"
#include "human/skeleton/recognise.h"
#include "human/tiny_skeleton.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

// Lengths of a four-legged body, y up, facing z; centimetres.
struct Beast {
  double trunk, thigh, shin, upper, lower, width;
  double metatarsus = 12.0;     // From the heel, or the joint with its name, to the toes.
  int tail = 0, proboscis = 0;  // joints
};

constexpr Beast kElephant = {105, 65, 56, 55, 47, 22, 12, 5, 6};
constexpr Beast kHorse = {100, 52, 52, 42, 46, 18, 40};
// With legs of human length relative to the trunk.
constexpr Beast kCalf = {84, 65, 60, 48, 36, 15};
constexpr Beast kCow = {100, 55, 50, 42, 34, 16};

std::string line(int depth, const std::string& name, double x, double y, double z) {
  return std::string(static_cast<std::size_t>(2 * depth), ' ') + name + " " + std::to_string(x) +
         " " + std::to_string(y) + " " + std::to_string(z) + "\n";
}

// A body with human names, as assigned by tools that rig animals on human templates.
Skeleton body_of_heights(const Beast& beast) {
  std::string body = line(0, "Hips", 0, 140, 0);
  for (int i = 0; i < beast.tail; ++i) body += line(1 + i, "Rear" + std::to_string(i), 0, -8, -9);
  for (const std::string side : {"Left", "Right"}) {
    const double x = side == "Left" ? beast.width : -beast.width;
    body += line(1, side + "UpLeg", x, -8, -4) + line(2, side + "Leg", 0, -beast.thigh, 5) +
            line(3, side + "Foot", 0, -beast.shin, -5) +
            line(4, side + "ToeBase", 0, -0.9 * beast.metatarsus, 0.4 * beast.metatarsus) +
            line(5, "end", 0, 0, 8);
  }
  for (int i = 0; i < 3; ++i) {
    body += line(1 + i, "Spine" + (i == 0 ? "" : std::to_string(i)), 0, 0, beast.trunk / 3);
  }
  for (const std::string side : {"Left", "Right"}) {
    const double x = 0.5 * (side == "Left" ? beast.width : -beast.width);
    body += line(4, side + "Shoulder", x, 5, 5) + line(5, side + "Arm", x, -15, 5) +
            line(6, side + "ForeArm", 0, -beast.upper, -4) +
            line(7, side + "Hand", 0, -beast.lower, 4) + line(8, "end", 0, -12, 8);
  }
  body += line(4, "Neck", 0, 15, 15) + line(5, "Head", 0, 15, 40);
  for (int i = 0; i < beast.proboscis; ++i) {
    body += line(6 + i, "Snake" + std::to_string(i), 0, -14, 7);
  }
  return tiny_skeleton(body);
}

Eigen::Quaterniond about_x(double degrees) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(degrees / 180.0 * M_PI, Eigen::Vector3d::UnitX()));
}

// Two seconds of a walk, rising at most by this angle on the hind legs for a moment.
Clip walk_of(const Skeleton& skeleton, double reared) {
  Clip clip(std::make_shared<const Skeleton>(skeleton), {30, 1}, 60);
  for (int frame = 0; frame < 60; ++frame) {
    const double swing = 15.0 * std::sin(frame / 30.0 * 2.0 * M_PI);
    const double rise = frame > 45 ? reared : 0.0;
    const auto turn = [&](const char* joint, double degrees) {
      clip.rotations(frame)[*skeleton.find(joint)] = about_x(degrees);
    };
    turn("Hips", -rise);
    turn("LeftUpLeg", swing + rise);
    turn("RightUpLeg", -swing + rise);
    turn("LeftLeg", 10.0);
    turn("RightLeg", 10.0);
    turn("LeftArm", -swing);
    turn("RightArm", swing);
  }
  return clip;
}

TEST(HumanProportions, RejectsQuadrupedsWithAnyNames) {
  for (const auto& [name, beast] :
       {std::pair("elephant", kElephant), {"horse", kHorse}, {"cow", kCow}, {"calf", kCalf}}) {
    for (const double reared : {0.0, 40.0}) {
      SCOPED_TRACE(std::string(name) + (reared > 0.0 ? ", on its hind legs for a while" : ""));
      const Clip clip = walk_of(body_of_heights(beast), reared);
      for (const Clip& named : {clip, without_names(clip)}) {
        const auto map = recognise_skeleton(named, shipped_profiles());
        ASSERT_FALSE(map) << map->profile << " " << map->confidence;
        EXPECT_THAT(map.error().message, HasSubstr("the skeleton is not human"));
        EXPECT_THAT(map.error().hint, HasSubstr(OPTION("map")));
      }
    }
  }
}

TEST(HumanProportions, UprightBodyWithLongArmsOnlyCausesWarnings) {
  // A cartoon gorilla.
  std::string body = kBody;
  for (const char* length : {"-42 0.5", "-41 -0.5"}) body = replaced(body, length, "-24 0");
  const Skeleton skeleton = tiny_skeleton(body);
  const Clip clip(std::make_shared<const Skeleton>(skeleton), {30, 1}, 30);
  const auto map = value_of(recognise_skeleton(clip, shipped_profiles()));
  EXPECT_THAT(map.notes, Contains(HasSubstr("unusual for a human: the arms")));
  EXPECT_LT(map.confidence, 0.8);
}

TEST(HumanProportions, AcceptsPeopleOnAllFours) {
  const Skeleton skeleton = tiny_skeleton(kBody);
  Clip clip(std::make_shared<const Skeleton>(skeleton), {30, 1}, 60);
  for (int frame = 0; frame < 60; ++frame) {
    const double swing = 10.0 * std::sin(frame / 30.0 * 2.0 * M_PI);
    const auto turn = [&](const char* joint, const Eigen::Quaterniond& rotation) {
      clip.rotations(frame)[*skeleton.find(joint)] = rotation;
    };
    const auto about_z = [](double degrees) {
      return Eigen::Quaterniond(
          Eigen::AngleAxisd(degrees / 180.0 * M_PI, Eigen::Vector3d::UnitZ()));
    };
    // Hands and feet on the floor, legs straight, the hips highest.
    turn("Hips", about_x(105));
    turn("LeftUpLeg", about_x(-100 + swing));
    turn("RightUpLeg", about_x(-100 - swing));
    turn("LeftArm", about_x(-90 - swing) * about_z(-85));
    turn("RightArm", about_x(-90 + swing) * about_z(85));
  }
  for (const Clip& named : {clip, without_names(clip)}) {
    const auto map = value_of(recognise_skeleton(named, shipped_profiles()));
    EXPECT_THAT(map.notes, Contains(HasSubstr("the trunk never rises over the legs")));
    EXPECT_THAT(map.notes, Not(Contains(HasSubstr("narrow"))));
  }
}

}  // namespace
}  // namespace retarget

// Arrays of several motions or people.

#include "formats/smpl/places_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "joint_motion_support.h"
#include "smpl_test_support.h"
#include "support/npz_builder.h"

namespace retarget {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Two bodies of 22 joints, a metre apart, that move by a millimetre per frame.
std::vector<double> two_people(std::size_t frames, bool frames_first) {
  std::vector<double> values;
  const std::size_t first = frames_first ? frames : 2, second = frames_first ? 2 : frames;
  for (std::size_t i = 0; i < first; ++i) {
    for (std::size_t j = 0; j < second; ++j) {
      const auto frame = static_cast<double>(frames_first ? i : j);
      const auto person = static_cast<double>(frames_first ? j : i);
      for (std::size_t number = 0; number < 66; ++number) {
        values.push_back(0.01 * static_cast<double>(number) + 0.001 * frame + person);
      }
    }
  }
  return values;
}

TEST(PlacesLayoutTest, FindsTheAxisOfPeople) {
  ArrayReadOptions second;
  second.take = "2";
  const std::string people = npy_doubles({20, 2, 22, 3}, two_people(20, true));
  const std::string motions = npy_doubles({2, 20, 22, 3}, two_people(20, false));
  EXPECT_THAT(joint_error(people), AllOf(HasSubstr("the file holds 2 people"),
                                         HasSubstr("--take N chooses one, 1 to 2")));
  EXPECT_THAT(joint_error(motions), HasSubstr("the file holds 2 motions"));
  for (const std::string* bytes : {&people, &motions}) {
    const JointMotion motion = joints_of(*bytes, second);
    EXPECT_EQ(motion.frame_count, 20);
    EXPECT_NEAR(motion.position(3, 1).x(), 1.033, 1e-12);
  }
  std::vector<double> alone = two_people(40, true);
  alone.resize(alone.size() / 2);
  EXPECT_EQ(joints_of(npy_doubles({40, 1, 22, 3}, alone)).frame_count, 40);
  // Copies of one motion.
  std::vector<double> copies = two_people(20, false);
  std::copy_n(copies.begin(), copies.size() / 2, copies.begin() + 20 * 66);
  EXPECT_THAT(joint_error(npy_doubles({2, 20, 22, 3}, copies)), HasSubstr("2 motions"));
  // The choice of a motion is not a choice of a frame.
  EXPECT_THAT(joint_error(npy_doubles({20, 2, 17, 3}, counted(2040)), second),
              HasSubstr("20 frames of 2 people"));
}

// `copies` of a motion, along the first or the second axis.
std::vector<double> copied(std::size_t copies, std::size_t frames, bool copies_first) {
  std::vector<double> motion = two_people(frames, false);
  motion.resize(frames * 66);
  std::vector<double> values;
  const std::size_t outer = copies_first ? copies : frames;
  for (std::size_t i = 0; i < outer; ++i) {
    for (std::size_t j = 0; j < copies * frames / outer; ++j) {
      const std::size_t frame = copies_first ? j : i;
      const auto row = motion.begin() + static_cast<std::ptrdiff_t>(66 * frame);
      values.insert(values.end(), row, row + 66);
    }
  }
  return values;
}

TEST(PlacesLayoutTest, CopiesOfAMotionAreNotItsFrames) {
  ArrayReadOptions second;
  second.take = "2";
  for (const std::size_t copies : {3UL, 50UL}) {
    const std::string first_axis = npy_doubles({copies, 20, 22, 3}, copied(copies, 20, true));
    EXPECT_THAT(joint_error(first_axis), HasSubstr(std::to_string(copies) + " motions"));
    const JointMotion motion = joints_of(first_axis, second);
    EXPECT_EQ(motion.frame_count, 20);
    EXPECT_NEAR(motion.position(3, 1).x(), 0.033, 1e-12);
  }
  const std::string people = npy_doubles({20, 3, 22, 3}, copied(3, 20, false));
  EXPECT_THAT(joint_error(people), HasSubstr("3 people"));
  EXPECT_NEAR(joints_of(people, second).position(3, 1).x(), 0.033, 1e-12);
}

TEST(PlacesLayoutTest, ANumberDoesNotDecideBetweenPeopleAndMotions) {
  // Points as far apart along one axis as along the other one.
  const std::string bytes = npy_doubles({40, 8, 22, 3}, Numbers(1).list(40 * 8 * 66));
  ArrayReadOptions options;
  for (const char* take : {"8", "20", "41"}) {
    options.take = take;
    EXPECT_THAT(joint_error(bytes, options), HasSubstr("40 motions of 8 frames")) << take;
  }
  // Two people who never move, or copies of a motion of two frames.
  std::vector<double> still;
  for (int frame = 0; frame < 40; ++frame) {
    for (int i = 0; i < 132; ++i) still.push_back(0.1 * i);
  }
  EXPECT_THAT(joint_error(npy_doubles({40, 2, 22, 3}, still)), HasSubstr("40 motions of 2 frames"));
  const std::string alone = npy_doubles({5, 1, 22, 3}, counted(330));
  EXPECT_EQ(joints_of(alone).frame_count, 5);
  options.take = "3";
  EXPECT_THAT(joint_error(alone, options), HasSubstr("no person \"3\": the file holds 1 person"));
}

TEST(PlacesLayoutTest, AbsentPeopleAreReported) {
  for (const double absent : {0.0, -1.0, std::nan("")}) {
    // Four people in 20 frames, the last two of them absent.
    std::vector<double> values;
    const std::vector<double> present = two_people(20, true);
    for (std::size_t frame = 0; frame < 20; ++frame) {
      const auto row = present.begin() + static_cast<std::ptrdiff_t>(132 * frame);
      values.insert(values.end(), row, row + 132);
      values.insert(values.end(), 132, absent);
    }
    const std::string bytes = npy_doubles({20, 4, 22, 3}, values);
    EXPECT_THAT(joint_error(bytes),
                AllOf(HasSubstr("the file holds 4 people"),
                      HasSubstr("chooses one: 1, 2; the others are absent in all frames")));
    ArrayReadOptions options;
    options.take = "2";
    EXPECT_EQ(joints_of(bytes, options).frame_count, 20);
    options.take = "3";
    EXPECT_THAT(joint_error(bytes, options),
                HasSubstr("person 3 is absent: NaN or zeros in all frames"));
    // One of three is present.
    std::vector<double> one;
    for (std::size_t frame = 0; frame < 20; ++frame) {
      const auto row = present.begin() + static_cast<std::ptrdiff_t>(132 * frame);
      one.insert(one.end(), 66, absent);
      one.insert(one.end(), row, row + 66);
      one.insert(one.end(), 66, absent);
    }
    options.take = "2";
    EXPECT_EQ(joints_of(npy_doubles({20, 3, 22, 3}, one), options).frame_count, 20);
    EXPECT_THAT(joint_error(npy_doubles({20, 3, 22, 3}, one)), HasSubstr("3 people"));
    const std::string absent_motions =
        npy_doubles({3, 20, 22, 3}, std::vector<double>(20 * 3 * 66, absent));
    EXPECT_THAT(joint_error(absent_motions), HasSubstr("chooses one, 1 to 3"));
    EXPECT_THAT(joint_error(absent_motions, options),
                HasSubstr("motion 2 is absent: NaN or zeros in all frames"));
  }
}

}  // namespace
}  // namespace retarget

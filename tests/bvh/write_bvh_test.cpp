#include "retarget/bvh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <filesystem>
#include <limits>
#include <locale>
#include <memory>
#include <numbers>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "bvh_test_support.h"
#include "retarget/clip.h"
#include "support/shared_data.h"
#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;

constexpr double kTolerance = 1e-9;

const std::vector<Channel> kPositions = {Channel::kXPosition, Channel::kYPosition,
                                         Channel::kZPosition};

Joint make_joint(std::string name, int parent, std::vector<Channel> channels) {
  Joint joint;
  joint.name = std::move(name);
  joint.parent = parent;
  joint.offset = {0.1, -2.0, 1.0 / 3.0};
  joint.channels = std::move(channels);
  return joint;
}

std::vector<Channel> rotation_channels(std::vector<int> axes) {
  std::vector<Channel> channels;
  for (const int axis : axes) {
    channels.push_back(static_cast<Channel>(static_cast<int>(Channel::kXRotation) + axis));
  }
  return channels;
}

// One joint per order of three rotations, every second one with positions after its rotations.
std::shared_ptr<const Skeleton> skeleton_of_all_orders() {
  std::vector<Joint> joints;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) {
        if (i == j || j == k) continue;
        const int index = static_cast<int>(joints.size());
        std::vector<Channel> channels = rotation_channels({i, j, k});
        if (index % 2 == 0) channels.insert(channels.end(), kPositions.begin(), kPositions.end());
        joints.push_back(make_joint("joint " + std::to_string(index), -1, std::move(channels)));
      }
    }
  }
  // A chain of the even joints, each with an odd sibling.
  for (int i = 0; i < static_cast<int>(joints.size()); ++i) {
    joints[i].parent = i == 0 ? -1 : i % 2 == 1 ? i - 1 : i - 2;
  }
  joints.back().end_sites = {{1.0, 2.0, 3.0}, {0.0, 1e-7, -123456.789}};
  return std::make_shared<const Skeleton>(std::move(joints));
}

void fill_at_random(Clip& clip, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (auto& rotation : clip.rotations(frame)) {
      rotation = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                     .normalized();
    }
    for (auto& translation : clip.translations(frame)) {
      translation = 100.0 * Eigen::Vector3d(normal(random), normal(random), normal(random));
    }
  }
}

void expect_same_clip(const Clip& a, const Clip& b, double tolerance = kTolerance) {
  ASSERT_EQ(a.skeleton().joint_count(), b.skeleton().joint_count());
  ASSERT_EQ(a.frame_count(), b.frame_count());
  EXPECT_EQ(a.rate(), b.rate());
  for (int joint = 0; joint < a.skeleton().joint_count(); ++joint) {
    const Joint& left = a.skeleton().joint(joint);
    const Joint& right = b.skeleton().joint(joint);
    EXPECT_EQ(left.name, right.name);
    EXPECT_EQ(left.parent, right.parent);
    EXPECT_EQ(left.channels, right.channels);
    EXPECT_LE((left.offset - right.offset).cwiseAbs().maxCoeff(), tolerance);
    ASSERT_EQ(left.end_sites.size(), right.end_sites.size());
    for (std::size_t i = 0; i < left.end_sites.size(); ++i) {
      EXPECT_LE((left.end_sites[i] - right.end_sites[i]).cwiseAbs().maxCoeff(), tolerance);
    }
  }
  for (int frame = 0; frame < a.frame_count(); ++frame) {
    for (int joint = 0; joint < a.skeleton().joint_count(); ++joint) {
      EXPECT_LE(a.rotations(frame)[joint].angularDistance(b.rotations(frame)[joint]), tolerance)
          << "frame " << frame << ", joint " << joint;
      const Eigen::Vector3d gap = a.translation(frame, joint) - b.translation(frame, joint);
      EXPECT_LE(gap.cwiseAbs().maxCoeff(), tolerance) << "frame " << frame << ", joint " << joint;
    }
  }
}

std::string text_of(const Clip& clip, const BvhWriteOptions& options = {}) {
  return value_of(format_bvh(clip, options));
}

TEST(WriteBvh, WritesTheUsualFormat) {
  std::vector<Joint> joints = {make_joint("Hips", -1, kPositions),
                               make_joint("Spine", 0, rotation_channels({2, 1, 0})),
                               make_joint("Tail", 0, {})};
  joints[0].channels.push_back(Channel::kYRotation);
  joints[0].offset.setZero();
  joints[1].offset = {0.0, 10.5, -0.0};
  joints[1].end_sites = {{0.0, 1.0, 0.0}};
  joints[1].channels.push_back(Channel::kXScale);
  joints[2].offset = {0.0, 0.0, -3.0};
  Clip clip(std::make_shared<const Skeleton>(joints), FrameRate{30, 1}, 1);
  clip.rotations(0)[0] = Eigen::Quaterniond(std::sqrt(0.5), 0.0, std::sqrt(0.5), 0.0);
  clip.translations(0)[0] = {1.0, -2.25, 1e-9};
  BvhWriteOptions options;
  options.decimals = 4;
  EXPECT_EQ(text_of(clip, options),
            "HIERARCHY\n"
            "ROOT Hips\n"
            "{\n"
            "\tOFFSET 0.0000 0.0000 0.0000\n"
            "\tCHANNELS 4 Xposition Yposition Zposition Yrotation\n"
            "\tJOINT Spine\n"
            "\t{\n"
            "\t\tOFFSET 0.0000 10.5000 0.0000\n"
            "\t\tCHANNELS 4 Zrotation Yrotation Xrotation Xscale\n"
            "\t\tEnd Site\n"
            "\t\t{\n"
            "\t\t\tOFFSET 0.0000 1.0000 0.0000\n"
            "\t\t}\n"
            "\t}\n"
            "\tJOINT Tail\n"
            "\t{\n"
            "\t\tOFFSET 0.0000 0.0000 -3.0000\n"
            "\t\tCHANNELS 0\n"
            "\t}\n"
            "}\n"
            "MOTION\n"
            "Frames: 1\n"
            "Frame Time: 0.03333333333333333\n"
            "1.0000 -2.2500 0.0000 90.0000 0.0000 0.0000 0.0000 1.0000\n");
}

TEST(WriteBvh, RoundTripsInAllOrders) {
  Clip clip(skeleton_of_all_orders(), FrameRate{120, 1}, 40);
  fill_at_random(clip, 5);
  expect_same_clip(clip_of(text_of(clip)), clip);
}

TEST(WriteBvh, RoundTripsAtGimbalLock) {
  const auto skeleton = skeleton_of_all_orders();
  Clip clip(skeleton, FrameRate{60, 1}, 60);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> radians(-7.0, 7.0);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (int joint = 0; joint < skeleton->joint_count(); ++joint) {
      std::vector<int> axes;
      for (const Channel channel : skeleton->joint(joint).channels) {
        if (is_rotation(channel)) axes.push_back(axis_of(channel));
      }
      const double quarters = std::numbers::pi / 2.0 * (frame % 9 - 4);
      const double aside = frame % 4 == 0 ? 0.0 : std::pow(10.0, -(frame % 17));
      const std::vector<double> angles = {radians(random), quarters + aside, radians(random)};
      Eigen::Quaterniond& rotation = clip.rotations(frame)[joint];
      for (int i = 0; i < 3; ++i) {
        rotation = rotation * Eigen::AngleAxisd(angles[i], Eigen::Vector3d::Unit(axes[i]));
      }
    }
  }
  expect_same_clip(clip_of(text_of(clip)), clip);
}

TEST(WriteBvh, RatesRoundTripExactly) {
  for (const FrameRate rate : {FrameRate{30, 1}, FrameRate{120, 1}, FrameRate{2997, 125},
                               FrameRate{30000, 1001}, FrameRate{1, 2}, FrameRate{1000, 7}}) {
    const Clip clip(skeleton_of_all_orders(), rate, 2);
    EXPECT_EQ(clip_of(text_of(clip)).rate(), rate);
  }
}

TEST(WriteBvh, AnglesAreContinuous) {
  const auto skeleton = std::make_shared<const Skeleton>(
      std::vector<Joint>{make_joint("Hips", -1, rotation_channels({2, 0, 1}))});
  Clip clip(skeleton, FrameRate{30, 1}, 400);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    clip.rotations(frame)[0] =
        Eigen::AngleAxisd(0.05 * frame, Eigen::Vector3d(1.0, 2.0, -0.5).normalized());
  }
  const std::string text = text_of(clip);
  const std::string rows = text.substr(text.find('\n', text.find("Frame Time")) + 1);
  std::istringstream numbers(rows);
  std::vector<double> before(3, 0.0);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (double& last : before) {
      double value = 0.0;
      numbers >> value;
      EXPECT_LT(std::abs(value - last), 60.0) << "frame " << frame;
      last = value;
    }
  }
}

TEST(WriteBvh, JointsAtZeroRoundTrip) {
  // Zeros in all position channels would select the offset.
  for (const std::optional<int> decimals : {std::optional<int>(), std::optional<int>(6)}) {
    std::vector<Joint> joints = {make_joint("Hips", -1, kPositions),
                                 make_joint("Hand", 0, kPositions)};
    Clip clip(std::make_shared<const Skeleton>(joints), FrameRate{30, 1}, 3);
    for (int frame = 0; frame < 3; ++frame) clip.translations(frame)[1].setConstant(1e-13);
    BvhWriteOptions options;
    options.decimals = decimals;
    const Clip back = clip_of(text_of(clip, options));
    EXPECT_LE(back.translation(0, 1).norm(), decimals ? 1e-6 : 1e-11);
    EXPECT_LE(back.translation(2, 1).norm(), 1e-11);
  }
}

TEST(WriteBvh, RejectsClipsThatCannotBeReadBack) {
  const auto hinge = std::make_shared<const Skeleton>(
      std::vector<Joint>{make_joint("Knee", -1, {Channel::kYPosition, Channel::kXRotation})});
  Clip bent(hinge, FrameRate{30, 1}, 2);
  bent.rotations(1)[0] = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX());
  EXPECT_TRUE(format_bvh(bent).has_value());
  bent.rotations(1)[0] = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ());
  Result<std::string> text = format_bvh(bent);
  ASSERT_FALSE(text.has_value());
  EXPECT_THAT(text.error().message, HasSubstr("\"Knee\" in frame 1"));
  EXPECT_THAT(text.error().hint, HasSubstr("three rotation channels"));

  Clip moved(hinge, FrameRate{30, 1}, 1);
  moved.translations(0)[0].x() += 1.0;
  EXPECT_THAT(format_bvh(moved).error().message, HasSubstr("without a position channel"));

  const double nan = std::numeric_limits<double>::quiet_NaN();
  Clip lost(hinge, FrameRate{30, 1}, 1);
  lost.translations(0)[0].y() = nan;
  EXPECT_FALSE(format_bvh(lost).has_value());
  lost.translations(0)[0].y() = 0.0;
  lost.rotations(0)[0].x() = nan;
  EXPECT_FALSE(format_bvh(lost).has_value());

  for (const char* name : {"", " a", "a ", "a\nb", "a{b", "a\rb"}) {
    const auto named =
        std::make_shared<const Skeleton>(std::vector<Joint>{make_joint(name, -1, kPositions)});
    EXPECT_FALSE(format_bvh(Clip(named, FrameRate{30, 1}, 1)).has_value()) << name;
  }
  const auto rigid = std::make_shared<const Skeleton>(std::vector<Joint>{make_joint("a", -1, {})});
  EXPECT_TRUE(format_bvh(Clip(rigid, FrameRate{30, 1}, 0)).has_value());
  EXPECT_FALSE(format_bvh(Clip(rigid, FrameRate{30, 1}, 1)).has_value());
  // 0 - (1 - 3, 2): joint 3 would follow its closed parent.
  const auto tangled = std::make_shared<const Skeleton>(
      std::vector<Joint>{make_joint("a", -1, kPositions), make_joint("b", 0, {}),
                         make_joint("c", 0, {}), make_joint("d", 1, {})});
  EXPECT_THAT(format_bvh(Clip(tangled, FrameRate{30, 1}, 1)).error().message,
              HasSubstr("depth-first"));
  BvhWriteOptions options;
  options.decimals = 99;
  EXPECT_EQ(format_bvh(bent, options).error().kind, ErrorKind::kUsage);
}

// The stream locale has a decimal comma; the C locale comes from an installed one.
class CommaPunctuation : public std::numpunct<char> {
 protected:
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(WriteBvh, IsIndependentOfTheLocale) {
  Clip clip(skeleton_of_all_orders(), FrameRate{2997, 125}, 1200);
  fill_at_random(clip, 8);
  const std::string plain = text_of(clip);

  const std::locale streams_before =
      std::locale::global(std::locale(std::locale::classic(), new CommaPunctuation));
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "de_DE", "fr_FR.UTF-8", "fr_FR.utf8"}) {
    if (std::setlocale(LC_ALL, name) != nullptr) break;
  }
  const std::string text = text_of(clip);
  const Clip back = clip_of(text);
  const std::string error = describe(read_exactly("HIERARCHY\nROOT").error());
  std::setlocale(LC_ALL, "C");
  std::locale::global(streams_before);

  EXPECT_EQ(text, plain);
  expect_same_clip(back, clip);
  EXPECT_THAT(error, HasSubstr("test.bvh:2:5: error: "));
}

TEST(WriteBvh, SavesAndLoads) {
  Clip clip(skeleton_of_all_orders(), FrameRate{30, 1}, 3);
  fill_at_random(clip, 9);
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "test.bvh").string();
  ASSERT_TRUE(save_bvh(path, clip).has_value());
  const auto file = value_of(load_bvh(path));
  expect_same_clip(file.clip, clip);
  std::filesystem::remove(path);

  clip.rotations(1)[0].x() = std::numeric_limits<double>::infinity();
  const Result<void> saved = save_bvh(path, clip);
  ASSERT_FALSE(saved.has_value());
  EXPECT_EQ(saved.error().location.file, path);
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(WriteBvh, RealFilesRoundTrip) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(*shared / "data/dialects")) {
    SCOPED_TRACE(entry.path());
    const auto file = value_of(load_bvh(entry.path().string()));
    const Clip clip = cut(file.clip, 0, std::min(file.clip.frame_count(), 100));
    expect_same_clip(clip_of(text_of(clip)), clip);
    ++count;
  }
  EXPECT_GE(count, 19);
}

}  // namespace
}  // namespace retarget

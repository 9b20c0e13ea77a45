#include "formats/scene/read_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/option_name.h"
#include "formats/containers/file_kind.h"
#include "retarget/pose.h"
#include "support/processor_time.h"
#include "support/value_of.h"
#include "support/world_poses.h"

namespace retarget {
namespace {

using Eigen::Quaterniond, Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Writes a document of a pelvis, a spine and a leg in MVN's form.
struct Document {
  std::string frames;
  std::string rate = "frameRate=\"60\"";
  std::string joints =
      "<joint "
      "label=\"jL5S1\"><connector1>Pelvis/jL5S1</connector1><connector2>L5/jL5S1</connector2></"
      "joint>"
      "<joint "
      "label=\"jHip\"><connector1>Pelvis/jHip</connector1><connector2>Leg/jHip</connector2></"
      "joint>";

  void add(const std::string& type, const std::vector<Pose>& poses,
           const std::string& stamp = "time=\"0\"") {
    std::string rotations, positions;
    for (const auto& [q, p] : poses) {
      rotations += fmt::format("{} {} {} {} ", q.w(), q.x(), q.y(), q.z());
      positions += fmt::format("{} {} {} ", p.x(), p.y(), p.z());
    }
    frames += fmt::format(
        "<frame {} type=\"{}\"><orientation>{}</orientation><position>{}</position></frame>\n",
        stamp, type, rotations, positions);
  }

  // Adds a frame at a time in milliseconds.
  void add_at(double time, int index) {
    add("normal", {{}, {}, {}}, fmt::format("time=\"{}\" index=\"{}\"", time, index));
  }

  [[nodiscard]] std::string text() const {
    return "<?xml version=\"1.0\"?>\n<mvnx version=\"4\"><subject label=\"A\" " + rate +
           "><segments><segment label=\"Pelvis\" id=\"1\"/><segment label=\"L5\" id=\"2\"/>"
           "<segment label=\"Leg\" id=\"3\"/></segments><joints>" +
           joints + "</joints><frames>" + frames + "</frames></subject></mvnx>";
  }
};

Quaterniond about_x(double angle) {
  return Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitX()));
}

// The body stands with the pelvis at a height, and is then rotated as a whole about x.
std::vector<Pose> poses(double angle) {
  const Quaterniond q = about_x(angle);
  const Vector3d pelvis(0.1, 0.2, 0.95);
  return {{q, pelvis},
          {q, pelvis + q * Vector3d(0, 0, 0.1)},
          {q, pelvis + q * Vector3d(0, 0.1, -0.05)}};
}

TEST(MvnxTest, ReadsSegmentsAsJoints) {
  Document document;
  document.add("identity", poses(0.0));
  document.add("tpose", poses(0.0));
  for (const double angle : {0.0, 0.3, 0.6}) document.add("normal", poses(angle));
  ASSERT_EQ(file_type(document.text()).kind, FileKind::kMvnx);
  const auto clip = value_of(read_mvnx(document.text(), "test.mvnx", {}));
  EXPECT_THAT(clip.skeleton().names(), ElementsAre("Pelvis", "L5", "Leg"));
  EXPECT_EQ(to_text(clip.rate()), "60");
  ASSERT_EQ(clip.frame_count(), 3);
  EXPECT_EQ(*clip.origin().metres_per_unit, 1.0);
  EXPECT_EQ(*clip.origin().up, Vector3d::UnitZ());
  EXPECT_FALSE(clip.skeleton().joint(2).has_position_channels());
  EXPECT_LT((clip.skeleton().joint(2).offset - Vector3d(0, 0.1, -0.05)).norm(), 1e-12);
  for (int frame = 0; frame < 3; ++frame) {
    const auto found = world_poses(clip, frame);
    const auto expected = poses(0.3 * frame);
    for (std::size_t joint = 0; joint < 3; ++joint) {
      EXPECT_LT((found[joint].translation - expected[joint].translation).norm(), 1e-12);
      EXPECT_LT(found[joint].rotation.angularDistance(expected[joint].rotation), 1e-9);
    }
  }
}

// Rotations are relative to the calibration pose.
TEST(MvnxTest, UsesTheTposeAsZeroPose) {
  Document document;
  document.add("npose", poses(0.5));
  document.add("tpose", poses(0.2));
  document.add("normal", poses(0.7));
  const auto clip = value_of(read_mvnx(document.text(), "test.mvnx", {}));
  EXPECT_LT(clip.rotations(0)[0].angularDistance(about_x(0.5)), 1e-9);
  EXPECT_THAT(clip.origin().choices, HasSubstr("\"tpose\""));
}

TEST(MvnxTest, RejectsImpossibleValues) {
  const auto message = [](const Document& document) {
    const auto clip = read_mvnx(document.text(), "test.mvnx", {});
    return clip ? std::string() : clip.error().message;
  };
  Document empty;
  EXPECT_THAT(message(empty), HasSubstr("no frames of type"));
  Document good;
  good.add("normal", poses(0.0));
  EXPECT_EQ(message(good), "");
  Document without_rate = good;
  without_rate.rate = "";
  EXPECT_THAT(message(without_rate), HasSubstr("no frame rate"));
  Document ring = good;
  ring.joints += "<joint><connector1>Leg/a</connector1><connector2>Pelvis/a</connector2></joint>";
  EXPECT_THAT(message(ring), HasSubstr("cycle"));
  Document stranger = good;
  stranger.joints += "<joint><connector1>Arm/a</connector1><connector2>Leg/a</connector2></joint>";
  EXPECT_THAT(message(stranger), HasSubstr("unknown segments"));
  Document short_frame = good;
  short_frame.frames += "<frame type=\"normal\"><orientation>1 0 0 0</orientation></frame>";
  EXPECT_THAT(message(short_frame), HasSubstr("for its 3 segments"));
  Document not_finite = good;
  not_finite.add("normal", {{Quaterniond::Identity(), {NAN, 0, 0}}, {}, {}});
  EXPECT_THAT(message(not_finite), HasSubstr("for its 3 segments"));
  Document not_unit = good;
  not_unit.add("normal", {{Quaterniond(0, 0, 0, 0), {0, 0, 0}}, {}, {}});
  EXPECT_THAT(message(not_unit), HasSubstr("unit quaternion"));
  const std::string cut = good.text().substr(0, 300);
  EXPECT_THAT(read_mvnx(cut, "cut.mvnx", {}).error().message, HasSubstr("broken or cut off"));
  std::string many = "<mvnx";
  for (int i = 0; i < 60'000; ++i) many += " a" + std::to_string(i) + "=\"1\"";
  const double begin = processor_time();
  EXPECT_THAT(read_mvnx(many + "/>", "many.mvnx", {}).error().message,
              HasSubstr("more than 100 attributes"));
  EXPECT_LT(processor_time() - begin, 2);
}

std::string clock_message(const Document& document) {
  const auto clip = read_mvnx(document.text(), "test.mvnx", {});
  return clip ? std::string() : clip.error().message;
}

TEST(MvnxTest, RejectsMissingFrames) {
  Document gap;
  for (int i = 0; i < 40; ++i) {
    if (i < 10 || i >= 20) gap.add_at(std::floor(1000.0 * i / 60.0), i);
  }
  EXPECT_THAT(clock_message(gap), HasSubstr("frame 10 comes 183 ms after the frame before"));
  const auto refused = read_mvnx(gap.text(), "test.mvnx", {});
  EXPECT_EQ(refused.error().location.line, 12U);
  EXPECT_THAT(refused.error().hint, HasSubstr(OPTION("source-fps")));
  SceneReadOptions options;
  options.source_fps = 60.0;
  const auto clip = value_of(read_mvnx(gap.text(), "test.mvnx", options));
  EXPECT_EQ(clip.frame_count(), 30);
  ASSERT_EQ(clip.origin().warnings.size(), 1U);
  EXPECT_THAT(clip.origin().warnings[0].message, HasSubstr("frames may be missing"));

  Document without_times;
  for (const int index : {0, 1, 2, 5, 6}) without_times.add_at(0, index);
  EXPECT_THAT(clock_message(without_times), HasSubstr("frame 3 has index 5 after 2"));
  Document back;
  for (const double time : {0.0, 17.0, 33.0, 33.0, 50.0}) back.add_at(time, 0);
  EXPECT_THAT(clock_message(back), HasSubstr("not uniform"));
}

TEST(MvnxTest, RejectsARateThatContradictsTheTimes) {
  Document document;
  for (int i = 0; i < 30; ++i) document.add_at(std::round(1000.0 * i / 30.0), i);
  EXPECT_THAT(clock_message(document), HasSubstr("states 60 fps, but the times of its frames"));
  SceneReadOptions options;
  options.source_fps = 60.0;
  const auto clip = value_of(read_mvnx(document.text(), "test.mvnx", options));
  EXPECT_EQ(to_text(clip.rate()), "60");
}

TEST(MvnxTest, ToleratesTimesInWholeMilliseconds) {
  for (const int fps : {30, 60, 100, 120, 240}) {
    for (const bool is_truncated : {false, true}) {
      Document document;
      document.rate = fmt::format("frameRate=\"{}\"", fps);
      for (int i = 5; i < 300; ++i) {
        const double time = 1000.0 * i / fps;
        document.add_at(is_truncated ? std::floor(time) : std::round(time), i);
      }
      EXPECT_EQ(clock_message(document), "") << fps;
    }
  }
  // A few frames do not contradict a rate by rounding alone.
  Document two;
  two.add_at(0, 0);
  two.add_at(16, 1);
  EXPECT_EQ(clock_message(two), "");
  // Times that are all equal determine no rate.
  Document none;
  for (int i = 0; i < 3; ++i) none.add_at(0, 0);
  EXPECT_EQ(clock_message(none), "");
}

TEST(MvnxTest, ReadsFilesWithADocumentType) {
  Document document;
  document.add("normal", poses(0.0));
  for (const char* type :
       {"<!DOCTYPE mvnx>", "<!DOCTYPE mvnx [ <!ELEMENT mvnx ANY>\n<!ELEMENT subject ANY> ]>"}) {
    std::string text = document.text();
    text.insert(text.find("<mvnx"), type);
    EXPECT_EQ(file_type(text).kind, FileKind::kMvnx);
    const auto clip = read_mvnx(text, "typed.mvnx", {});
    EXPECT_TRUE(clip.has_value()) << type;
  }
}

TEST(MvnxTest, ReadsTheRequestedSubject) {
  Document first, second;
  first.add("normal", poses(0.0));
  for (const double angle : {0.3, 0.6}) second.add("normal", poses(angle));
  std::string text = second.text();
  const std::size_t begin = text.find("<subject"), end = text.find("</mvnx>");
  std::string other = text.substr(begin, end - begin);
  other.replace(other.find("\"A\""), 3, "\"B\"");
  text = first.text();
  text.insert(text.find("</mvnx>"), other);
  const auto read = [&](const std::string& root, const std::string& take = {}) {
    SceneReadOptions options;
    options.root = root;
    options.take = take;
    return read_mvnx(text, "two.mvnx", options);
  };
  const auto plain = value_of(read(""));
  EXPECT_EQ(plain.frame_count(), 1);
  ASSERT_EQ(plain.origin().warnings.size(), 1U);
  EXPECT_THAT(plain.origin().warnings[0].message,
              HasSubstr("the file has 2 subjects (A, B), and only"));
  for (const char* root : {"B", "2"}) {
    const auto chosen = value_of(read(root));
    EXPECT_EQ(chosen.frame_count(), 2);
    EXPECT_TRUE(chosen.origin().warnings.empty());
    EXPECT_THAT(chosen.origin().choices, HasSubstr("subject 2 of 2"));
  }
  EXPECT_TRUE(read("A", "1"));
  for (const auto& wrong : {read("C"), read("3"), read("", "2")}) {
    ASSERT_FALSE(wrong);
    EXPECT_EQ(wrong.error().kind, ErrorKind::kUsage);
  }
  EXPECT_THAT(read("C").error().message, HasSubstr("found A, B"));
  // A subject without a label has its number.
  text.replace(text.find("\"B\""), 3, "\"\"");
  const auto unnamed = read("");
  ASSERT_TRUE(unnamed && unnamed->origin().warnings.size() == 1);
  EXPECT_THAT(unnamed->origin().warnings[0].message, HasSubstr("2 subjects (A, 2)"));
}

}  // namespace
}  // namespace retarget

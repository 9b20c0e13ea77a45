#include "formats/registry/format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "formats/containers/npz.h"
#include "formats/containers/pickle.h"
#include "retarget/text.h"
#include "support/temporary_folder.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kSource = RETARGET_SOURCE_DIR;

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << path;
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

RobotClip swinging_clip() {
  RobotClip clip(load_g1(), {30, 1}, 12);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto qpos = clip.qpos(frame);
    for (std::size_t i = 7; i < qpos.size(); ++i) {
      qpos[i] = 0.2 * std::sin(0.3 * frame + static_cast<double>(i));
    }
    // The robot faces neither along x nor along y, so the order of its quaternion is certain.
    qpos[3] = std::cos(0.6);
    qpos[6] = std::sin(0.6);
    qpos[2] = 0.76;
    qpos[0] = 0.02 * frame;
  }
  return clip;
}

// A human motion in each format, by its name.
std::map<std::string, std::string> human_samples() {
  const std::vector<double> numbers(4 * 66, 0.1);
  const std::vector<double> fps = {30.0};
  NpzWriter smpl, positions;
  smpl.add("poses", float64_array(numbers, {4, 66}));
  smpl.add("trans", float64_array(std::vector<double>(12, 0.9), {4, 3}));
  positions.add("joint_positions", float64_array(numbers, {4, 22, 3}));
  for (NpzWriter* npz : {&smpl, &positions}) npz->add("fps", float64_array(fps, {}));
  return {{"bvh", text_of(kSource + "/data/wave.bvh")},
          {"fbx", text_of(kSource + "/tests/scene/data/walk.fbx")},
          {"gltf", text_of(kSource + "/tests/scene/data/walk.glb")},
          {"mvnx", "<?xml version=\"1.0\"?><mvnx version=\"4\"><subject/></mvnx>"},
          {"smpl", *smpl.finish()},
          {"positions", *positions.finish()}};
}

Result<HumanFile> read_human(const std::string& bytes, const SourceOptions& source = {}) {
  return read_human_file(bytes, "motion", {source, false, std::size_t{1} << 30U});
}

TEST(FormatRegistry, NamesAndOutputExtensionsAreUnique) {
  std::set<std::string_view> names, endings;
  for (const Format& format : all_formats()) {
    EXPECT_TRUE(names.insert(format.name).second) << format.name;
    if (!format.is_robots()) {
      EXPECT_EQ(format.family.read_robot, nullptr) << format.name;
      EXPECT_NE(format.family.read_human, nullptr) << format.name;
      continue;
    }
    EXPECT_EQ(format.family.read_human, nullptr) << format.name;
    EXPECT_TRUE(endings.insert(format.long_ending).second) << format.name;
    EXPECT_EQ(&robot_format(format.motion_format), &format);
    EXPECT_EQ(format_name(format.motion_format), format.name);
    EXPECT_TRUE(format.long_ending.ends_with(format_ending(format.motion_format)));
  }
}

TEST(FormatRegistry, EveryTypeOfContentHasOneHumanReader) {
  for (const FileKind kind : {FileKind::kOther, FileKind::kForeign, FileKind::kBvh, FileKind::kFbx,
                              FileKind::kGltf, FileKind::kMvnx, FileKind::kNpz, FileKind::kTorch,
                              FileKind::kNpy, FileKind::kPickle, FileKind::kGzip}) {
    std::set<const FormatFamily*> readers;
    for (const Format& format : all_formats()) {
      if (!format.is_robots() && format.family.reads(kind)) readers.insert(&format.family);
    }
    EXPECT_EQ(readers.size(), 1U) << static_cast<int>(kind);
  }
}

// The content decides, not the file name.
TEST(FormatRegistry, DetectsEachHumanFormatAndNoOther) {
  const auto samples = human_samples();
  for (const Format& format : all_formats()) {
    if (format.is_robots()) continue;
    ASSERT_TRUE(samples.contains(std::string(format.name))) << "no sample of " << format.name;
    const std::string& bytes = samples.at(std::string(format.name));
    const FileKind kind = file_type(bytes).kind;
    for (const Format& other : all_formats()) {
      if (other.is_robots()) continue;
      EXPECT_EQ(other.family.reads(kind), &other.family == &format.family)
          << format.name << " as " << other.name;
    }
    const auto human = read_human(bytes);
    if (format.name == "mvnx") {
      EXPECT_THAT(describe(human.error()), HasSubstr("MVNX"));  // A document without a motion.
    } else {
      ASSERT_TRUE(human) << format.name << ": " << describe(human.error());
      EXPECT_EQ(std::holds_alternative<JointMotion>(*human), format.name == "positions");
    }
    const auto robot = parse_robot_motion(bytes, load_g1(), "motion", {});
    ASSERT_FALSE(robot) << format.name;
    EXPECT_THAT(
        describe(robot.error()),
        AnyOf(HasSubstr("human motion"), HasSubstr("is for display and cannot be converted back"),
              HasSubstr("no array \"joint_pos\"")))
        << format.name;
  }
}

TEST(FormatRegistry, EachWriterIsReadBackAsItsOwnFormat) {
  const RobotClip clip = swinging_clip();
  WriteMotionOptions write;
  write.tracking.rate = {30, 1};
  for (const Format& format : all_formats()) {
    if (!format.is_robots()) continue;
    const auto files = format_motion_files(clip, format.motion_format, write);
    ASSERT_TRUE(files) << format.name << ": " << describe(files.error());
    const TemporaryFolder folder;
    Result<RobotMotion> motion;
    if (format_is_folder(format.motion_format)) {
      for (const FormattedFile& file : *files) folder.write(file.name, file.bytes);
      motion = load_robot_motion(folder.path().string(), clip.shared_robot(), {});
    } else {
      const std::string& bytes = files->front().bytes;
      motion = parse_robot_motion(bytes, clip.shared_robot(), "motion", {});
      // The nodes of a GLB may be those of a human; other robot motions are not.
      if (format.family.read_robot != nullptr) EXPECT_FALSE(read_human(bytes)) << format.name;
    }
    if (format.family.read_robot == nullptr) {
      ASSERT_FALSE(motion) << format.name;
      EXPECT_THAT(describe(motion.error()),
                  HasSubstr("is for display and cannot be converted back"));
      continue;
    }
    ASSERT_TRUE(motion) << format.name << ": " << describe(motion.error());
    EXPECT_EQ(motion->format, format.motion_format) << format.name;
    const auto left_knee = clip.robot().find_joint("left_knee_joint");
    const int address = clip.robot().joints()[*left_knee].qpos_address;
    EXPECT_NEAR(motion->clip.qpos(5)[address], clip.qpos(5)[address], 1e-5) << format.name;
    EXPECT_NEAR(motion->clip.qpos(5)[0], clip.qpos(5)[0], 1e-5) << format.name;
  }
}

// If arrays exist only in robot motions, the error of the human reader suggests the right option.
TEST(FormatRegistry, ReportsRobotMotionsGivenAsHuman) {
  const RobotClip clip = swinging_clip();
  WriteMotionOptions write;
  write.tracking.rate = {30, 1};
  for (const Format& format : all_formats()) {
    if (format.family.read_robot == nullptr || format_is_folder(format.motion_format)) continue;
    if (format.motion_format == MotionFormat::kCsvSoma) continue;  // begins with names
    const auto bytes = value_of(format_robot_motion(clip, format.motion_format, write));
    const auto human = read_human(bytes);
    ASSERT_FALSE(human) << format.name;
    EXPECT_THAT(human.error().hint, HasSubstr("NAME names the robot")) << format.name;
  }
}

TEST(FormatRegistry, BelievesTheNameOfAnUnknownContent) {
  const SourceOptions source;
  const auto message_of = [&](const std::string& name, const std::string& bytes) {
    const auto read = read_human_file(bytes, name, {source, false, std::size_t{1} << 30U});
    return read ? "no error" : read.error().message;
  };
  for (const auto& [name, words] :
       std::map<std::string, std::string>{{"walk.npz", "not an NPZ file: no ZIP header"},
                                          {"walk.NPY", "not an NPY file: no NumPy header"},
                                          {"walk.pkl", "not a Python pickle"},
                                          {"walk.fbx", "not an FBX file"},
                                          {"walk.bvh", "expected HIERARCHY"},
                                          {"walk", "expected HIERARCHY"}}) {
    EXPECT_THAT(message_of(name, "a text\n"), HasSubstr(words)) << name;
    EXPECT_THAT(message_of(name, "<!doctype html>"), HasSubstr("a web page")) << name;
    EXPECT_EQ(message_of(name, human_samples().at("bvh")), "no error") << name;
  }
  const auto robot = parse_robot_motion("a text\nb\n", load_g1(), "walk.npz", {});
  ASSERT_FALSE(robot);
  EXPECT_EQ(robot.error().message, "not an NPZ file: no ZIP header");
  // A table under the name of an archive keeps the position of its fault.
  for (const char* header : {"", "a,b,c\n"}) {
    const auto table =
        parse_robot_motion(header + std::string("1,2,3\n1,2,x\n"), load_g1(), "walk.npz", {});
    ASSERT_FALSE(table);
    EXPECT_EQ(table.error().location.line, *header == 0 ? 2U : 3U);
    EXPECT_EQ(table.error().location.column, 5U);
  }
  const auto lost = parse_robot_motion("nan,2,3\n-inf,2,3\n", load_g1(), "walk.npz", {});
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().location.line, 1U);
  // All binary formats of the table have a header.
  for (const Format& format : all_formats()) {
    if (format.family.reads(FileKind::kOther)) continue;
    std::string_view endings = format.family.endings;
    while (!endings.empty()) {
      const std::string_view ending = take_until(endings, ' ');
      EXPECT_FALSE(missing_header(ending).empty()) << ending;
    }
  }
}

TEST(FormatRegistry, OptionsForOtherFormatsAreRejected) {
  const auto samples = human_samples();
  SourceOptions body, names, take;
  body.smpl_model = "body.npz";
  names.joint_names = "names.txt";
  take.take = "2";
  for (const SourceOptions* source : {&body, &names, &take}) {
    EXPECT_EQ(read_human(samples.at("bvh"), *source).error().kind, ErrorKind::kUsage);
  }
  for (const SourceOptions* source : {&body, &names}) {
    EXPECT_EQ(read_human(samples.at("fbx"), *source).error().kind, ErrorKind::kUsage);
  }
  // The type of a file is reported first.
  for (const auto& [name, bytes, words] :
       std::vector<std::array<std::string, 3>>{{"walk.npz", "a text\n", "not an NPZ file"},
                                               {"walk.npz", "<!doctype html>", "a web page"},
                                               {"walk.bvh", "HIERARCHY\nROOT", "expected"}}) {
    const auto read = read_human_file(bytes, name, {body, false, std::size_t{1} << 30U});
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error().kind, ErrorKind::kInput) << name;
    EXPECT_THAT(read.error().message, HasSubstr(words));
  }
}

TEST(FormatRegistry, JointPositionsAreNotTheJointsOfARobot) {
  std::vector<double> numbers(4 * 66, 0.1);
  numbers[70] = std::nan("");
  NpzWriter npz;
  npz.add("joint_positions", float64_array(numbers, {4, 22, 3}));
  PickleWriter pickle;
  pickle.begin_dict();
  pickle.text("joint_positions");
  pickle.array(float64_array(numbers, {4, 22, 3}));
  pickle.end_dict();
  for (const std::string& bytes : {*npz.finish(), pickle.finish()}) {
    const auto human = read_human(bytes);
    ASSERT_FALSE(human);
    EXPECT_THAT(human.error().message, HasSubstr("NaN in frame 1"));
    EXPECT_THAT(human.error().hint, Not(HasSubstr("robot")));
  }
}

TEST(FormatRegistry, FindsTheExtensionOfAFile) {
  EXPECT_EQ(human_endings_text(), ".bvh, .fbx, .glb, .gltf, .vrm, .vrma, .mvnx, .npz, .pt or .npy");
  EXPECT_EQ(robot_endings_text(), ".csv, .npz, .pkl, .pickle, .joblib, .motion or .pt");
  EXPECT_EQ(ending_of("folder.d/Walk.NPZ"), ".npz");
  EXPECT_TRUE(is_human_ending(".vrma") && !is_human_ending(".pkl") && !is_human_ending(".csv"));
  EXPECT_TRUE(is_robot_ending(".joblib") && !is_robot_ending(".glb") && !is_robot_ending(""));
  EXPECT_TRUE(may_be_human_ending(".pkl") && may_be_human_ending(".joblib"));
  EXPECT_TRUE(!may_be_human_ending(".csv") && !may_be_human_ending(".npz"));
  EXPECT_EQ(output_ending(".joblib"), ".pkl");
  EXPECT_EQ(output_ending(".tsv"), ".csv");
  EXPECT_EQ(output_ending(".bvh"), "");
}

// The lines of the table below a heading, up to the first line that is not part of it.
std::vector<std::string> table_below(const std::string& text, const std::string& heading) {
  std::vector<std::string> rows;
  std::istringstream lines(text.substr(std::min(text.find(heading), text.size())));
  std::string line;
  for (int i = 0; std::getline(lines, line) && line.starts_with('|'); ++i) {
    if (i >= 2) rows.push_back(line);
  }
  return rows;
}

TEST(FormatRegistry, DocumentationHasTheSameRows) {
  const std::string page = text_of(kSource + "/docs/formats.md");
  std::vector<std::string> humans, robots;
  for (const Format& format : all_formats()) {
    const std::string row = "| `" + std::string(format.name) + "` | " + std::string(format.file) +
                            " | " + std::string(format.programs) + " |";
    if (format.is_robots()) {
      robots.push_back(row);
    } else {
      const std::string details(format.page);
      humans.push_back(row + " [" + details + "](" + details + ") |");
    }
  }
  EXPECT_EQ(table_below(page, "| format | file | read by |"), robots);
  EXPECT_EQ(table_below(page, "| format | file | written by | details |"), humans);
}

// A file of zeros occupies no space on disk.
TEST(FormatRegistry, ChecksTheStartOfLargeFiles) {
  const TemporaryFolder folder;
  const auto error_of = [&](const std::string& start, std::uintmax_t size) {
    const std::string path = (folder.path() / "a.bvh").string();
    std::ofstream(path, std::ios::binary) << start;
    std::filesystem::resize_file(path, size);
    const auto checked = check_start_of_large_file(path);
    return checked ? std::string() : checked.error().message;
  };
  constexpr std::uintmax_t kLarge = std::uintmax_t{1} << 30U;
  EXPECT_THAT(error_of(std::string("\0\0\0\x20", 4) + "ftypisom", kLarge), HasSubstr("a video"));
  EXPECT_THAT(error_of("", kLarge), HasSubstr("binary data of an unknown type"));
  EXPECT_EQ(error_of("", 4096), "");
  EXPECT_EQ(error_of("HIERARCHY\n", kLarge), "");
  EXPECT_EQ(error_of("PK\x03\x04", kLarge), "");
  EXPECT_TRUE(check_start_of_large_file((folder.path() / "none").string()));
  EXPECT_TRUE(check_start_of_large_file(folder.path().string()));
}

TEST(FormatRegistry, RejectsARootOfArrays) {
  SourceOptions source;
  source.root = "Foo";
  for (const char* format : {"smpl", "positions"}) {
    const auto read = read_human_file(human_samples().at(format), "walk.npz",
                                      {source, false, std::size_t{1} << 30U});
    ASSERT_FALSE(read.has_value());
    EXPECT_EQ(read.error().kind, ErrorKind::kUsage);
    EXPECT_THAT(read.error().message, HasSubstr("contains arrays"));
  }
}

}  // namespace
}  // namespace retarget

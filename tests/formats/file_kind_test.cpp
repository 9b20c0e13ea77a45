#include "formats/containers/file_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "formats/bvh/read_bvh.h"
#include "formats/containers/npz.h"
#include "support/npz_builder.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// An archive may hold any format.
TEST(FileKindTest, HintsAtArchivesNameNoFormat) {
  for (const std::string start : {"\x1f\x8b\x08", "PK\x03\x04", "Rar!", "7z\xbc\xaf"}) {
    const FileType type = file_type(start);
    EXPECT_THAT(std::string(type.hint), HasSubstr("unpack it"));
    EXPECT_THAT(std::string(type.hint), Not(HasSubstr(".bvh")));
  }
}

TEST(FileKindTest, AKnownTypeIsNotComparedWithBvh) {
  for (const std::string& text :
       {std::string("\xff\xfe<\0?\0x\0m\0l\0", 12), std::string("\x1f\x8b\x08\0", 4)}) {
    const auto read = read_bvh(text, "take.mvnx", {});
    ASSERT_FALSE(read.has_value());
    EXPECT_THAT(read.error().message, HasSubstr("expected a human motion, found"));
    EXPECT_THAT(read.error().message, Not(HasSubstr("HIERARCHY")));
  }
}

TEST(FileKindTest, NamesFilesThatAreNoMotions) {
  const std::vector<std::pair<std::string, std::string>> files = {
      {std::string("\0\0\0\x20"
                   "ftypisom",
                   12),
       "video"},
      {"\x89PNG\r\n\x1a\n", "PNG"},
      {"%PDF-1.7\n", "PDF"},
      {"Vocaloid Motion Data 0002", "VMD"},
      {R"({"version":1.3,"people":[{"person_id":[-1],"pose_keypoints_2d":[1,2]}]})", "OpenPose"},
      {R"([{"a": 1}])", "JSON"},
      {"# Blender\r\nmtllib a.mtl\r\no Cube\r\nv 1 -0.5 2e-3\r\n", "OBJ"},
      {"v 1.0 0.5 2\n", "OBJ"},
      {"<!-- robot -->\n<mujoco model=\"g1\">", "MJCF"},
      {"<?xml version=\"1.0\"?>\n<robot name=\"g1\">", "URDF"},
      {"<?xml version=\"1.0\"?>\n<svg>", "XML"},
      {"\xEF\xBB\xBF"
       "Format Version,1.23,Take Name,Take 1\n",
       "Motive"},
      {"\x1a\x45\xdf\xa3\x01", "Matroska"},
      {"\x04\x22\x4d\x18\x64", "lz4"},
      {std::string("]\0\0\0\x04\xff\xff", 7), "lzma"},
      {"NO_OF_FRAMES\t100\nNO_OF_CAMERAS\t8\n", "Qualisys"}};
  for (const auto& [bytes, name] : files) {
    const FileType type = file_type(bytes);
    EXPECT_EQ(type.kind, FileKind::kForeign) << name;
    EXPECT_THAT(std::string(type.what), HasSubstr(name));
    EXPECT_FALSE(type.hint.empty()) << name;
    EXPECT_THAT(read_bvh(bytes, "walk.bvh", {}).error().message, HasSubstr(name));
  }
  // Tables of robots.
  for (const char* table : {"0.1,0.2\n", "v,o\n1,2\n", "# comment\n1 2 3\n", "time,x\n0,1\n",
                            "v x y z\n0 1 2 3\n", "o x y\n0 1 2\n", "v", "mtllib a.mtl"}) {
    EXPECT_EQ(file_type(table).kind, FileKind::kOther) << table;
  }
}

TEST(FileKindTest, ModelsAreRecognisedByTheWholeNameOfTheirRoot) {
  for (const char* text :
       {"<?xml version=\"1.0\"?><robots>", "<?xml version=\"1.0\"?><mujocos/>"}) {
    EXPECT_THAT(std::string(file_type(text).what), HasSubstr("XML document")) << text;
  }
  for (const char* text : {"<robot>", "<robot\n name=\"g1\">", "<robot/>"}) {
    EXPECT_THAT(std::string(file_type(text).what), HasSubstr("URDF")) << text;
  }
}

TEST(FileKindTest, AnArchiveNamesItsFiles) {
  const std::string bytes = NpzBuilder().add_entry("walk.bvh", "HIERARCHY", {}).build();
  const auto file = NpzFile::open(bytes, "walk.npz");
  ASSERT_FALSE(file.has_value());
  EXPECT_THAT(file.error().message, HasSubstr("a ZIP archive of other files: walk.bvh"));
  EXPECT_THAT(file.error().hint, HasSubstr("unpack it"));
}

}  // namespace
}  // namespace retarget

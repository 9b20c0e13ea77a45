// Models that would crash MuJoCo or never finish are rejected before MuJoCo reads them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "robot/model/load_model.h"
#include "support/processor_time.h"
#include "support/temporary_folder.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr const char* kBall = R"(<body name="base"><freejoint/><geom size="0.1"/></body>)";

std::string model(const std::string& before, const std::string& world = kBall) {
  return "<mujoco>\n" + before + "\n<worldbody>" + world + "</worldbody></mujoco>";
}

std::string message_of(const std::string& path, const ModelChanges& changes = {}) {
  const double begin = processor_time();
  const auto loaded = load_model(path, changes);
  EXPECT_LT(processor_time() - begin, 5);
  if (loaded) return "it loads";
  EXPECT_EQ(loaded.error().kind, ErrorKind::kConfig);
  return loaded.error().message;
}

std::string message_of_text(const std::string& text) {
  const TemporaryFolder folder;
  return message_of(folder.write("robot.xml", text));
}

TEST(VetModel, RejectsImplausibleSizes) {
  for (const char* size :
       {"nuser_body", "nuser_jnt", "nuser_geom", "nuser_site", "nuser_cam", "nuser_tendon",
        "nuser_actuator", "nuser_sensor", "nkey", "nuserdata", "njmax", "nconmax", "nstack"}) {
    const std::string said =
        message_of_text(model("<size " + std::string(size) + "=\"2000000000\"/>"));
    EXPECT_THAT(said, HasSubstr(std::string("<size> ") + size + " is 2000000000: at most "));
  }
  EXPECT_THAT(message_of_text(model(R"(<size memory="900E"/>)")), HasSubstr("memory is 900E"));
  EXPECT_THAT(message_of_text(model(R"(<size nkey="many"/>)")), HasSubstr("expected numbers"));
  EXPECT_EQ(message_of_text(model(R"(<size njmax="500" nconmax="100" nkey="1"
                                           nuser_body="4"/>)")),
            "it loads");
}

TEST(VetModel, RejectsElementsOfManyAttributes) {
  std::string many;
  for (int i = 0; i < 60'000; ++i) many += " a" + std::to_string(i) + "=\"1\"";
  EXPECT_EQ(message_of_text("<mujoco" + many + "><worldbody>" + kBall + "</worldbody></mujoco>"),
            "an element has more than 100 attributes");
  const TemporaryFolder folder;
  EXPECT_EQ(message_of(folder.write("robot.urdf", "<robot name=\"r\"><link" + many + "/></robot>")),
            "an element has more than 100 attributes");
}

TEST(VetModel, RejectsHugeCounts) {
  EXPECT_THAT(message_of_text(model(R"(<asset><hfield name="a" nrow="100000" ncol="100000"
                                       size="1 1 1 1"/></asset>)")),
              HasSubstr("cells of height fields"));
  EXPECT_THAT(message_of_text(model(R"(<custom><numeric name="a" size="2000000000" data="1"/>
                                       </custom>)")),
              HasSubstr("<numeric> size is 2000000000"));
  const std::string once = R"(<geom size="0.1"/>)";
  for (const char* count : {"1e9", "1000000000", "+1e9", " 2000000000 "}) {
    EXPECT_THAT(
        message_of_text(model("", kBall + std::string("<replicate offset=\"1 0 0\" count=\"") +
                                      count + "\">" + once + "</replicate>")),
        HasSubstr("<replicate> count is"));
  }
  // No single count is large.
  std::string nested = once;
  for (int i = 0; i < 9; ++i) {
    nested = R"(<replicate count="10" offset="1 0 0">)" + nested + "</replicate>";
  }
  EXPECT_THAT(message_of_text(model("", kBall + nested)), HasSubstr("elements"));
  EXPECT_THAT(message_of_text(model("", R"(<composite type="cable" count="100000 1 1"
      size="10"><joint kind="main"/><geom size="0.1"/></composite>)")),
              HasSubstr("<composite> count is"));
  EXPECT_THAT(message_of_text(model("", R"(<flexcomp name="a" type="grid" count="500 500 500"/>)")),
              HasSubstr("<flexcomp> count is"));
  EXPECT_THAT(message_of_text(model(R"(<asset><mesh name="a" builtin="plate"
                                       params="100000 100000"/></asset>)")),
              HasSubstr("<mesh> params"));
}

TEST(VetModel, RejectsTooManySensors) {
  std::string sensors;
  for (int i = 0; i < 2001; ++i) sensors += "<clock/>";
  EXPECT_THAT(message_of_text(model("<sensor>" + sensors + "</sensor>")),
              HasSubstr("more than 2000 sensors"));
}

TEST(VetModel, RejectsHugeKeyframes) {
  std::string mocaps, keys;
  for (int i = 0; i < 1000; ++i) mocaps += R"(<body mocap="true"/>)";
  for (int i = 0; i < 1000; ++i) keys += "<key/>";
  EXPECT_THAT(message_of_text(model(R"(<size nkey="10000"/>)", mocaps + kBall)),
              HasSubstr("numbers in its keyframes"));
  EXPECT_THAT(message_of_text(model("<keyframe>" + keys + "</keyframe>", mocaps + kBall)),
              HasSubstr("numbers in its keyframes"));
  // Plausible values of real robots.
  EXPECT_EQ(message_of_text(model(R"(<size nkey="100"/>)")), "it loads");
}

TEST(VetModel, RejectsLargeOrDeepTrees) {
  std::string many;
  for (int i = 0; i < 30'000; ++i) many += R"(<geom size="1"/>)";
  EXPECT_THAT(message_of_text(model("", many)), HasSubstr("more than 20000 elements"));
  std::string leaves = R"(<replicate count="900" offset="1 0 0"><body><joint/><geom size="1"/>
                          </body></replicate>)";
  for (int i = 0; i < 60; ++i) leaves = "<body><joint/>" + leaves + "<geom size=\"1\"/></body>";
  EXPECT_EQ(message_of_text(model("", leaves)), "it loads");
  EXPECT_THAT(message_of_text(model("", leaves + leaves)), HasSubstr("more than 1000 joints"));
  leaves = R"(<replicate count="2001"><body/></replicate>)";
  EXPECT_THAT(message_of_text(model("", leaves)), HasSubstr("more than 2000 bodies"));
  std::string urdf = R"(<robot name="r"><link name="l0"/>)";
  for (int i = 0; i < 5000; ++i) {
    const std::string a = std::to_string(i), b = std::to_string(i + 1);
    urdf += "<link name=\"l" + b + "\"/><joint name=\"j" + b +
            "\" type=\"fixed\"><parent link=\"l" + a + "\"/><child link=\"l" + b + "\"/></joint>";
  }
  EXPECT_THAT(message_of_text(urdf + "</robot>"), HasSubstr("more than 1000 joints"));
}

TEST(VetModel, RejectsPlugins) {
  EXPECT_THAT(message_of_text(model(R"(<extension><plugin plugin="mujoco.pid"/></extension>)")),
              HasSubstr("plugin"));
}

class VetFiles : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directory(folder_.path() / "model"); }
  std::string write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_.path() / name).parent_path());
    return folder_.write(name, text);
  }
  void make_pipe(const std::string& name) const {
    ASSERT_EQ(::mkfifo((folder_.path() / name).c_str(), 0600), 0);
  }
  const TemporaryFolder folder_;
};

TEST_F(VetFiles, RejectsPipes) {
  make_pipe("model/pipe.xml");
  EXPECT_THAT(message_of(write("model/robot.xml", model(R"(<include file="pipe.xml"/>)"))),
              HasSubstr("expected a regular file"));
  EXPECT_THAT(message_of((folder_.path() / "model/pipe.xml").string()),
              HasSubstr("a model must be a regular file"));
  EXPECT_THAT(message_of(write("model/robot.xml", model(R"(<asset><model name="a" file="pipe.xml"/>
                                                           </asset>)"))),
              HasSubstr("expected a regular file"));
  make_pipe("model/mesh.stl");
  const std::string meshed =
      write("model/robot.xml", model(R"(<asset><mesh name="a" file="mesh.stl"/></asset>)",
                                     R"(<body><freejoint/><geom type="mesh" mesh="a"/></body>)"));
  ModelChanges changes;
  changes.keep_meshes = true;
  EXPECT_THAT(message_of(meshed, changes), HasSubstr("not a regular file"));
}

TEST_F(VetFiles, RejectsIncludesOutsideTheFolder) {
  const std::string outside = write("secret.xml", "<mujocoinclude/>");
  const std::string said = "lies outside the model's folder";
  for (const std::string& name : {std::string("../secret.xml"), outside, std::string("link.xml")}) {
    std::error_code ignored;
    fs::create_symlink(outside, folder_.path() / "model/link.xml", ignored);
    EXPECT_THAT(message_of(write("model/robot.xml", model("<include file=\"" + name + "\"/>"))),
                HasSubstr(said));
    EXPECT_THAT(message_of(write("model/robot.xml", model("<asset><model name=\"a\" file=\"" +
                                                          name + "\"/></asset>"))),
                HasSubstr(said));
  }
}

TEST_F(VetFiles, ChecksIncludesInsideTheFolder) {
  write("model/parts/arm.xml", std::string("<mujocoinclude>") + kBall + "</mujocoinclude>");
  EXPECT_EQ(message_of(write("model/robot.xml", model("", R"(<include file="parts/arm.xml"/>)"))),
            "it loads");
  write("model/parts/arm.xml", R"(<mujocoinclude><size nkey="2000000000"/></mujocoinclude>)");
  EXPECT_THAT(message_of(write("model/robot.xml", model(R"(<include file="parts/arm.xml"/>)"))),
              HasSubstr("nkey is 2000000000"));
  write("model/itself.xml", R"(<mujocoinclude><include file="itself.xml"/></mujocoinclude>)");
  EXPECT_THAT(message_of(write("model/robot.xml", model(R"(<include file="itself.xml"/>)"))),
              HasSubstr("nests files too deeply"));
}

TEST_F(VetFiles, RejectsEndlessAttachments) {
  write("model/m0.xml", model("", R"(<body name="b"><geom size="1"/></body>)"));
  for (int i = 1; i < 12; ++i) {
    const std::string below = "m" + std::to_string(i - 1);
    std::string attached;
    for (int k = 0; k < 10; ++k) {
      attached +=
          "<attach model=\"" + below + "\" body=\"b\" prefix=\"p" + std::to_string(k) + "_\"/>";
    }
    write("model/m" + std::to_string(i) + ".xml",
          model("<asset><model name=\"" + below + "\" file=\"" + below + ".xml\"/></asset>",
                "<body name=\"b\">" + attached + "</body>"));
  }
  EXPECT_THAT(message_of((folder_.path() / "model/m11.xml").string()), HasSubstr("elements"));
}

}  // namespace
}  // namespace retarget

// Locations in which mesh files of models are found.

#include "robot/model/read_mesh.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "support/temporary_folder.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// A checkout with a package, whose model is two folders below it.
class MeshFilesTest : public ::testing::Test {
 protected:
  MeshFilesTest() : package_(folder_.path() / "checkout" / "walker_description") {
    put(package_ / "urdf" / "v2" / "robot.urdf");
    put(package_ / "meshes" / "leg.stl");
    put(package_ / "urdf" / "v2" / "visual" / "arm.stl");
    put(folder_.path() / "checkout" / "secret.stl");
  }

  static void put(const fs::path& file) {
    fs::create_directories(file.parent_path());
    std::ofstream(file) << "x";
  }

  [[nodiscard]] std::string found(const std::string& named) const {
    const auto file = find_mesh_file(named, package_ / "urdf" / "v2" / "robot.urdf", "");
    return file ? fs::weakly_canonical(*file).lexically_relative(package_).string() : "nothing";
  }

  TemporaryFolder folder_;
  fs::path package_;
};

TEST_F(MeshFilesTest, FindsPackagesTwoFoldersUpByName) {
  EXPECT_EQ(found("package://walker_description/meshes/leg.stl"), "meshes/leg.stl");
  EXPECT_EQ(found("$(find walker_description)/meshes/leg.stl"), "meshes/leg.stl");
  EXPECT_EQ(found("file://$(find walker_description)/meshes/leg.stl"), "meshes/leg.stl");
  EXPECT_EQ(found("package://other/meshes/leg.stl"), "nothing");
}

TEST_F(MeshFilesTest, FindsPackagesTwoFoldersUpByTheirFile) {
  put(package_ / "package.xml");
  EXPECT_EQ(found("package://other/meshes/leg.stl"), "meshes/leg.stl");
}

TEST_F(MeshFilesTest, LeadingFoldersMayBeMissing) {
  EXPECT_EQ(found("package://other/robots/walker/visual/arm.stl"), "urdf/v2/visual/arm.stl");
  EXPECT_EQ(found("package:/other/robots/walker/arm.stl"), "nothing");
  // Names without a package are used unchanged.
  EXPECT_EQ(found("robots/walker/visual/arm.stl"), "nothing");
  EXPECT_EQ(found("visual/arm.stl"), "urdf/v2/visual/arm.stl");
}

TEST_F(MeshFilesTest, DoesNotSearchOutsideThePackage) {
  EXPECT_EQ(found("package://walker_description/../secret.stl"), "nothing");
  EXPECT_EQ(found("../../../secret.stl"), "nothing");
  EXPECT_EQ(found("$(find walker_description"), "nothing");
  EXPECT_EQ(found("package://"), "nothing");
}

}  // namespace
}  // namespace retarget

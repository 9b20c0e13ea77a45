#include "robot/model/read_mesh.h"
#include "support/value_of.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <tuple>

namespace retarget {
namespace {

using ::testing::HasSubstr;

std::string collada(const std::string& positions, const std::string& primitives,
                    const std::string& node = "<instance_geometry url=\"#g\"/>") {
  return "<?xml version=\"1.0\"?><COLLADA><library_geometries><geometry id=\"g\"><mesh>"
         "<source id=\"p\"><float_array>" +
         positions +
         "</float_array></source>"
         "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>" +
         primitives +
         "</mesh></geometry></library_geometries><library_visual_scenes><visual_scene><node>" +
         node + "</node></visual_scene></library_visual_scenes></COLLADA>";
}

constexpr const char* kTriangle =
    "<triangles><input semantic=\"NORMAL\" offset=\"0\"/><input semantic=\"VERTEX\" offset=\"1\"/>"
    "<p>0 0 0 1 0 2</p></triangles>";
constexpr const char* kPositions = "0 0 0  1 0 0\n0 2 0";

TEST(ReadCollada, PlacesGeometryByItsNodes) {
  const auto mesh = value_of(read_mesh(
      collada(kPositions, kTriangle,
              "<matrix>1 0 0 0.5  0 1 0 0  0 0 1 0  0 0 0 1</matrix><rotate>0 0 1 90</rotate>"
              "<instance_geometry url=\"#g\"/>"),
      "a.dae"));
  ASSERT_EQ(mesh.vertices.size(), 3U);
  EXPECT_LT((mesh.vertices[1] - Eigen::Vector3d(0.5, 1, 0)).norm(), 1e-12);
  EXPECT_LT((mesh.vertices[2] - Eigen::Vector3d(-1.5, 0, 0)).norm(), 1e-12);
  ASSERT_EQ(mesh.triangles.size(), 1U);
  EXPECT_EQ(mesh.triangles[0], (std::array{0, 1, 2}));
}

TEST(ReadCollada, ReadsAGeometryThatIsUsedTwice) {
  const auto mesh =
      value_of(read_mesh(collada(kPositions, kTriangle,
                                 "<instance_geometry url=\"#g\"/><node><translate>0 0 1</translate>"
                                 "<instance_geometry url=\"#g\"/></node>"),
                         "a.DAE"));
  ASSERT_EQ(mesh.triangles.size(), 2U);
  EXPECT_EQ(mesh.triangles[1], (std::array{3, 4, 5}));
  EXPECT_EQ(mesh.vertices[4], Eigen::Vector3d(1, 0, 1));
}

TEST(ReadCollada, TriangulatesPolygons) {
  const auto mesh = value_of(
      read_mesh(collada("0 0 0 1 0 0 1 1 0 0 1 0 0 0 1",
                        "<polylist><input semantic=\"VERTEX\" offset=\"0\"/><vcount>4 3</vcount>"
                        "<p>0 1 2 3 0 1 4</p></polylist>"
                        "<polygons><input semantic=\"VERTEX\" offset=\"0\"/><p>1 2 4</p><p>0 2 3 "
                        "4</p></polygons>"),
                "a.dae"));
  ASSERT_EQ(mesh.triangles.size(), 6U);
  EXPECT_EQ(mesh.triangles[1], (std::array{0, 2, 3}));
  EXPECT_EQ(mesh.triangles[5], (std::array{0, 3, 4}));
}

TEST(ReadCollada, RejectsOtherFiles) {
  const std::string vertex = "<input semantic=\"VERTEX\" offset=\"0\"/>";
  for (const auto& [text, message] :
       {std::tuple{std::string("<a/>"), "not a COLLADA file"},
        {std::string("<COLLADA>"), "not a COLLADA file"},
        {std::string("<COLLADA/>"), "no triangles"},
        {collada("0 0 zero", kTriangle), "damaged"},
        {collada("0 0", kTriangle), "damaged"},
        {collada("0 0 0 1 0 0", kTriangle), "damaged"},
        {collada(kPositions, "<triangles>" + vertex + "<p>0 1 -1</p></triangles>"), "damaged"},
        {collada(kPositions, "<polylist>" + vertex + "<vcount>9</vcount><p>0 1 2</p></polylist>"),
         "damaged"},
        {collada(kPositions, kTriangle, "<rotate>0 0 1</rotate>"), "damaged"},
        {collada(kPositions, kTriangle,
                 "<scale>1e300 1e300 1e300</scale>"
                 "<instance_geometry url=\"#g\"/>"),
         "even in millimetres"}}) {
    const auto mesh = read_mesh(text, "a.dae");
    ASSERT_FALSE(mesh) << text;
    EXPECT_EQ(mesh.error().kind, ErrorKind::kInput);
    EXPECT_THAT(mesh.error().message, HasSubstr(message));
    EXPECT_EQ(mesh.error().location.file, "a.dae");
  }
}

}  // namespace
}  // namespace retarget

#include "robot/model/robot_meshes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "robot/model/read_mesh.h"

namespace retarget {
namespace {

using testing::HasSubstr;

// An open tube of many triangles, radius 0.1 m, length 0.3 m.
TriangleMesh tube(int around, int along) {
  TriangleMesh mesh;
  for (int j = 0; j <= along; ++j) {
    for (int i = 0; i < around; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / around;
      mesh.vertices.emplace_back(0.1 * std::cos(angle), 0.1 * std::sin(angle), 0.3 * j / along);
    }
  }
  for (int j = 0; j < along; ++j) {
    for (int i = 0; i < around; ++i) {
      const int a = j * around + i, b = j * around + (i + 1) % around;
      mesh.triangles.push_back({a, b, a + around});
      mesh.triangles.push_back({b, b + around, a + around});
    }
  }
  return mesh;
}

std::string binary_stl(const TriangleMesh& mesh) {
  std::string bytes(80, 's');
  const auto put = [&](const auto& value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.append(raw, sizeof value);
  };
  put(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    for (int i = 0; i < 3; ++i) put(0.0F);
    for (const int corner : triangle) {
      for (const double value : mesh.vertices[static_cast<std::size_t>(corner)]) {
        put(static_cast<float>(value));
      }
    }
    put(std::uint16_t{0});
  }
  return bytes;
}

TEST(ReadMesh, ReadsBothKindsOfStlAndObj) {
  const TriangleMesh made = tube(8, 2);
  const TriangleMesh binary = read_mesh(binary_stl(made), "a.STL").value();
  EXPECT_EQ(binary.triangles.size(), made.triangles.size());
  EXPECT_EQ(simplified(binary, 1000).vertices.size(), made.vertices.size());

  const TriangleMesh text =
      read_mesh(
          "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
          "vertex 0 1e-1 0\nendloop\nendfacet\nendsolid",
          "b.stl")
          .value();
  ASSERT_EQ(text.vertices.size(), 3U);
  EXPECT_EQ(text.vertices[2], Eigen::Vector3d(0.0, 0.1, 0.0));

  const TriangleMesh square =
      read_mesh("v 0 0 0\r\nv 1 0 0\nvn 0 0 1\nv 1 1 0\nv 0 1 0\nf 1/1/1 2//1 3 -1\n", "c.obj")
          .value();
  ASSERT_EQ(square.triangles.size(), 2U);
  EXPECT_EQ(square.triangles[1], (std::array{0, 2, 3}));
}

TEST(ReadMesh, AssumesMillimetresForHugeMeshes) {
  EXPECT_EQ(read_mesh("v 0 0 0\nv 200 0 0\nv 0 100 0\nf 1 2 3", "c.obj").value().vertices[1].x(),
            0.2);
}

TEST(ReadMesh, RejectsOtherFiles) {
  const std::string cut = binary_stl(tube(8, 2)).substr(0, 200);
  for (const auto& [bytes, file, message] :
       {std::tuple{std::string(), "a.stl", "no triangles"},
        {cut, "a.stl", "no triangles"},
        {std::string("vertex 1 2"), "a.stl", "three numbers"},
        {std::string("vertex 1 2 nan vertex 1 2 3 vertex 1 2 3"), "a.stl", "not a finite number"},
        {std::string("v 1 2 3\nv 1 2 1e30\nv 0 0 0\nf 1 2 3"), "a.obj", "even in millimetres"},
        {std::string("v 1 2"), "a.obj", "three numbers"},
        {std::string("v 1 2 3\nf 1 2 3"), "a.obj", "preceding vertices"},
        {std::string("v 1 2 3\nf 1 1 -2"), "a.obj", "preceding vertices"},
        {std::string("v 1 2 3\nf 1 1 99999999999999999999"), "a.obj", "preceding vertices"}}) {
    const auto mesh = read_mesh(bytes, file);
    ASSERT_FALSE(mesh) << bytes;
    EXPECT_EQ(mesh.error().kind, ErrorKind::kInput);
    EXPECT_THAT(mesh.error().message, HasSubstr(message));
    EXPECT_EQ(mesh.error().location.file, file);
  }
}

// Edges of a single triangle.
int open_edges(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> edges;
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      ++edges[std::minmax({triangle[i], triangle[(i + 1) % 3]})];
    }
  }
  return static_cast<int>(
      std::ranges::count_if(edges, [](const auto& edge) { return edge.second == 1; }));
}

TEST(Simplified, ClosesSeamsCausedByRounding) {
  // A tube whose last vertices equal the first ones up to the last bits and the sign of 0.
  TriangleMesh seam;
  constexpr int kAround = 64, kAlong = 30;
  for (int j = 0; j <= kAlong; ++j) {
    for (int i = 0; i <= kAround; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kAround;
      seam.vertices.emplace_back(0.1 * std::cos(angle), 0.1 * std::sin(angle), 0.01 * j);
    }
  }
  for (int j = 0; j < kAlong; ++j) {
    for (int i = 0; i < kAround; ++i) {
      const int a = j * (kAround + 1) + i, above = a + kAround + 1;
      seam.triangles.push_back({a, a + 1, above});
      seam.triangles.push_back({a + 1, above + 1, above});
    }
  }
  EXPECT_GT(open_edges(seam), 2 * kAround);
  // Only the two ends are open.
  EXPECT_EQ(open_edges(simplified(seam, 100000)), 2 * kAround);
  const TriangleMesh coarse = simplified(seam, 800);
  EXPECT_LT(open_edges(coarse), 2 * kAround);
}

TEST(Simplified, KeepsTheShapeInFewTriangles) {
  const TriangleMesh fine = tube(200, 100);
  const TriangleMesh coarse = simplified(fine, 1500);
  EXPECT_LE(coarse.triangles.size(), 1500U);
  EXPECT_GT(coarse.triangles.size(), 400U);
  for (const Eigen::Vector3d& vertex : coarse.vertices) {
    EXPECT_NEAR(vertex.head<2>().norm(), 0.1, 0.005);
    EXPECT_GT(vertex.z(), -1e-9);
    EXPECT_LT(vertex.z(), 0.3 + 1e-9);
  }
  // A coarse mesh does not change.
  const TriangleMesh same = simplified(coarse, 1500);
  EXPECT_EQ(same.triangles, coarse.triangles);
  EXPECT_EQ(same.vertices, coarse.vertices);
}

}  // namespace
}  // namespace retarget

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>

#include "retarget/scene.h"
#include "retarget/so3.h"
#include "scene/distance_grid.h"
#include "scene/sample_distance.h"
#include "scene_world/mesh_bodies.h"
#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using Type = SceneShape::Type;

std::vector<Vector3d> random_points(int count, double reach) {
  std::mt19937 random(7);
  std::vector<Vector3d> points;
  const auto number = [&] { return reach * (static_cast<double>(random()) / 2147483648.0 - 1.0); };
  for (int i = 0; i < count; ++i) {
    const double x = number(), y = number(), z = number();
    points.emplace_back(x, y, z);
  }
  return points;
}

SceneShape shape_of(Type type) {
  SceneShape shape;
  shape.type = type;
  shape.body_from_shape = {exp_so3({0.4, -0.9, 0.3}), {0.1, -0.2, 0.3}};
  shape.half_size = {0.3, 0.2, 0.1};
  shape.radius = 0.15;
  shape.half_length = 0.25;
  return shape;
}

// Whether a solid contains a point of its own frame.
bool contains(const SceneShape& shape, const Vector3d& p) {
  const double across = p.head<2>().norm(), along = std::abs(p.z());
  switch (shape.type) {
    case Type::kPlane:
      return p.z() <= 0.0;
    case Type::kBox:
      return (p.cwiseAbs() - shape.half_size).maxCoeff() <= 0.0;
    case Type::kSphere:
      return p.norm() <= shape.radius;
    case Type::kCylinder:
      return across <= shape.radius && along <= shape.half_length;
    default:
      return Vector3d(p.x(), p.y(), std::max(0.0, along - shape.half_length)).norm() <=
             shape.radius;
  }
}

constexpr std::array kPrimitives = {Type::kPlane, Type::kBox, Type::kSphere, Type::kCapsule,
                                    Type::kCylinder};

// The foot point along the normal is on the surface, and no point of a dense sample of directions
// is nearer: a sphere of the distance about the point does not cross the surface.
TEST(DistanceField, IsTheDistanceToPrimitives) {
  for (const Type type : kPrimitives) {
    const SceneShape shape = shape_of(type);
    const auto field = value_of(make_distance_field(body_of(shape)));
    const Pose shape_from_body = shape.body_from_shape.inverse();
    const auto directions = random_points(300, 1.0);
    for (const Vector3d& point : random_points(300, 0.8)) {
      const auto [distance, normal] = field.at(point);
      const bool inside = contains(shape, shape_from_body * point);
      EXPECT_EQ(distance < 0.0, inside) << static_cast<int>(type);
      const Vector3d foot = point - distance * normal;
      EXPECT_TRUE(contains(shape, shape_from_body * (foot - 1e-9 * normal)));
      EXPECT_FALSE(contains(shape, shape_from_body * (foot + 1e-9 * normal)));
      for (const Vector3d& direction : directions) {
        const Vector3d near = point + 0.999 * std::abs(distance) * direction.normalized();
        ASSERT_EQ(contains(shape, shape_from_body * near), inside) << static_cast<int>(type);
      }
    }
  }
}

TEST(DistanceField, NormalsArePrimitivesGradients) {
  for (const Type type : kPrimitives) {
    const auto field = value_of(make_distance_field(body_of(shape_of(type))));
    constexpr double kStep = 1e-6;
    for (const Vector3d& point : random_points(300, 0.8)) {
      const auto [distance, normal] = field.at(point);
      EXPECT_NEAR(normal.norm(), 1.0, 1e-12);
      if (distance < 1e-3) continue;  // Inside are edges of the gradient.
      for (int axis = 0; axis < 3; ++axis) {
        const Vector3d step = kStep * Vector3d::Unit(axis);
        EXPECT_NEAR(
            (field.at(point + step).distance - field.at(point - step).distance) / (2.0 * kStep),
            normal[axis], 1e-5)
            << static_cast<int>(type);
      }
    }
  }
}

TEST(DistanceField, IsDefinedAtCentres) {
  for (const Type type : kPrimitives) {
    SceneShape shape = shape_of(type);
    shape.body_from_shape = {};
    const auto field = value_of(make_distance_field(body_of(shape)));
    for (const Vector3d& point : {Vector3d(0, 0, 0), Vector3d(0, 0, 0.25), Vector3d(0, 0, -0.25)}) {
      const auto found = field.at(point);
      EXPECT_TRUE(std::isfinite(found.distance));
      EXPECT_NEAR(found.normal.norm(), 1.0, 1e-12);
    }
  }
}

TEST(DistanceField, UsesTheNearestShape) {
  SceneBody body;
  for (int i = 0; i < 5; ++i) {
    SceneShape shape = shape_of(kPrimitives[static_cast<std::size_t>(1 + i % 4)]);
    shape.body_from_shape.translation.x() = 0.5 * i - 1.0;
    body.shapes.push_back(shape);
  }
  const auto field = value_of(make_distance_field(body));
  for (const Vector3d& point : random_points(500, 2.0)) {
    double nearest = 1e9;
    for (const SceneShape& shape : body.shapes) {
      nearest = std::min(nearest, make_distance_field(body_of(shape))->at(point).distance);
    }
    EXPECT_DOUBLE_EQ(field.at(point).distance, nearest);
  }
}

TEST(DistanceField, ReportsItsReachAndLowestPoint) {
  for (const Type type : {Type::kBox, Type::kSphere, Type::kCapsule, Type::kCylinder}) {
    const SceneShape shape = shape_of(type);
    const auto field = value_of(make_distance_field(body_of(shape)));
    const Eigen::Quaterniond turn = exp_so3({-1.1, 0.5, 0.2});
    const double lowest = field.lowest(turn);
    const Vector3d up = turn.conjugate() * Vector3d::UnitZ();
    double found = 1e9;
    for (const Vector3d& point : random_points(20000, 1.0)) {
      const double distance = field.at(point).distance;
      const Vector3d surface = point - distance * field.at(point).normal;
      EXPECT_LE(surface.norm(), field.reach() + 1e-9);
      found = std::min(found, up.dot(surface));
    }
    EXPECT_GE(found, lowest - 1e-9) << static_cast<int>(type);
    EXPECT_LE(found, lowest + 0.01) << static_cast<int>(type);
  }
  EXPECT_TRUE(std::isinf(make_distance_field(body_of(shape_of(Type::kPlane)))->reach()));
}

TEST(DistanceField, SphereMeshApproximatesTheSphere) {
  const TriangleMesh mesh = ellipsoid_mesh(Vector3d::Constant(0.3));
  const auto layout = grid_layout(mesh);
  const auto field = make_distance_field(body_of(mesh));
  ASSERT_TRUE(layout && field);
  for (const Vector3d& point : random_points(5000, 0.5)) {
    const auto found = field->at(point);
    // Beyond the grid, the surface point may be a neighbour of the nearest one.
    const double beyond = (point.cwiseAbs().maxCoeff() > 0.38) ? 0.03 * found.distance : 0.0;
    EXPECT_NEAR(found.distance, point.norm() - 0.3, 0.5 * layout->spacing + beyond);
    if (point.norm() > 0.2) {
      // The facets of the mesh are tilted by up to 3 degrees.
      EXPECT_GT(found.normal.dot(point.normalized()), beyond > 0.0 ? 0.98 : 0.995);
    }
  }
}

TEST(DistanceField, BoxMeshApproximatesTheBox) {
  const Vector3d half(0.3, 0.2, 0.1);
  const TriangleMesh mesh = box_mesh(half);
  SceneShape box;
  box.half_size = half;
  const auto exact = make_distance_field(body_of(box));
  const auto layout = grid_layout(mesh);
  const auto field = make_distance_field(body_of(mesh));
  ASSERT_TRUE(layout && field && exact);
  for (const Vector3d& point : random_points(5000, 0.36)) {
    EXPECT_NEAR(field->at(point).distance, exact->at(point).distance, 0.5 * layout->spacing)
        << point.transpose();
  }
  TriangleMesh inward = mesh;
  for (auto& triangle : inward.triangles) std::swap(triangle[1], triangle[2]);
  const auto same = make_distance_field(body_of(inward));
  EXPECT_EQ(same->at(Vector3d(0.01, 0.02, 0.03)).distance,
            field->at(Vector3d(0.01, 0.02, 0.03)).distance);
}

TEST(DistanceField, GivesAnOpenBoxAnInside) {
  const TriangleMesh mesh = box_mesh({0.2, 0.2, 0.2}, false);
  const auto field = value_of(make_distance_field(body_of(mesh)));
  EXPECT_NEAR(field.at({0, 0, -0.15}).distance, -0.05, 0.003);
  EXPECT_NEAR(field.at({0.15, 0, -0.05}).distance, -0.05, 0.003);
  EXPECT_NEAR(field.at({0.25, 0, 0}).distance, 0.05, 0.003);
  EXPECT_GT(field.at({0, 0, 0.35}).distance, 0.15);
  // Continuous across the opening.
  double last = field.at({0, 0, 0.0}).distance;
  for (double z = 0.0; z < 0.4; z += 0.001) {
    const double next = field.at({0, 0, z}).distance;
    EXPECT_NEAR(next, last, 0.02);
    last = next;
  }
}

TEST(DistanceField, IsSmoothAcrossCellsAndTheBorderOfItsGrid) {
  const TriangleMesh mesh = ellipsoid_mesh({0.3, 0.2, 0.15});
  const auto layout = grid_layout(mesh);
  const auto field = make_distance_field(body_of(mesh));
  ASSERT_TRUE(layout && field);
  constexpr double kStep = 1e-9;
  for (const Vector3d& point : random_points(500, 0.25)) {
    const Vector3d cells = ((point - layout->origin) / layout->spacing).array().round();
    for (int axis = 0; axis < 3; ++axis) {
      Vector3d at = point;
      at[axis] = layout->origin[axis] + layout->spacing * cells[axis];
      const auto before = field->at(at - kStep * Vector3d::Unit(axis));
      const auto after = field->at(at + kStep * Vector3d::Unit(axis));
      EXPECT_NEAR(before.distance, after.distance, 1e-7);
      EXPECT_LT((before.normal - after.normal).norm(), 1e-5);
      at[axis] = layout->origin[axis];
      EXPECT_LT((field->at(at - kStep * Vector3d::Unit(axis)).normal -
                 field->at(at + kStep * Vector3d::Unit(axis)).normal)
                    .norm(),
                1e-5);
    }
  }
}

// Sum of the solid angles of all triangles (van Oosterom and Strackee 1983), over 4 pi.
double winding_number_of(const TriangleMesh& mesh, const Vector3d& point) {
  double angle = 0.0;
  for (const auto& triangle : mesh.triangles) {
    std::array<Vector3d, 3> to;
    for (std::size_t k = 0; k < 3; ++k) {
      to[k] = mesh.vertices[static_cast<std::size_t>(triangle[k])] - point;
    }
    const double a = to[0].norm(), b = to[1].norm(), c = to[2].norm();
    angle += 2.0 * std::atan2(to[0].dot(to[1].cross(to[2])), a * b * c + to[0].dot(to[1]) * c +
                                                                 to[1].dot(to[2]) * a +
                                                                 to[2].dot(to[0]) * b);
  }
  return angle / (4.0 * std::numbers::pi);
}

double distance_to(const TriangleMesh& mesh, const Vector3d& point) {
  const auto corner = [&](int i) { return mesh.vertices[static_cast<std::size_t>(i)]; };
  double square = 1e9;
  for (const auto& [a, b, c] : mesh.triangles) {
    square = std::min(
        square,
        (nearest_on_triangle(point, corner(a), corner(b), corner(c)) - point).squaredNorm());
  }
  return std::sqrt(square);
}

TEST(TriangleTree, AgreesWithAllTriangles) {
  const TriangleMesh mesh = ellipsoid_mesh({0.3, 0.2, 0.15});
  const TriangleTree tree(mesh);
  for (const Vector3d& point : random_points(300, 0.5)) {
    EXPECT_NEAR(tree.winding_number(point), winding_number_of(mesh, point), 0.05);
  }
}

TEST(SampleDistance, IsExactUpToAFractionOfACell) {
  const TriangleMesh mesh = ellipsoid_mesh({0.3, 0.2, 0.15});
  const auto layout = value_of(grid_layout(mesh));
  const auto values = sample_distance(mesh, layout);
  std::mt19937 random(3);
  for (int i = 0; i < 3000; ++i) {
    const auto node = random() % values.size();
    const auto row = static_cast<std::size_t>(layout.nodes[0]);
    const auto rows = static_cast<std::size_t>(layout.nodes[1]);
    const Vector3d place(static_cast<double>(node % row), static_cast<double>(node / row % rows),
                         static_cast<double>(node / (row * rows)));
    const Vector3d point = layout.origin + layout.spacing * place;
    EXPECT_NEAR(std::abs(values[node]), distance_to(mesh, point), 0.1 * layout.spacing);
  }
}

TEST(GridLayout, RejectsMeshesThatAreTooLarge) {
  EXPECT_TRUE(grid_layout(box_mesh({5, 5, 0.5})));
  const auto layout = grid_layout(box_mesh({100, 100, 100}));
  ASSERT_FALSE(layout);
  EXPECT_THAT(layout.error().message, ::testing::HasSubstr("200 m"));
}

TEST(GridCache, KeepsGridsAndIgnoresDamagedOnes) {
  const TemporaryFolder folder;
  const std::string cache = (folder.path() / "new" / "grids").string();
  const SceneBody body = body_of(box_mesh({0.1, 0.05, 0.02}));
  const auto first = value_of(make_distance_field(body, cache));
  std::vector<std::filesystem::path> files(std::filesystem::directory_iterator(cache), {});
  ASSERT_EQ(files.size(), 1U);
  const Vector3d point(0.07, 0.06, 0.01);
  const auto read = [&] { return make_distance_field(body, cache)->at(point).distance; };
  EXPECT_EQ(read(), first.at(point).distance);

  std::ifstream in(files[0], std::ios::binary);
  const std::string good(std::istreambuf_iterator<char>(in), {});
  const auto layout = grid_layout(*body.shapes[0].mesh);
  ASSERT_TRUE(read_grid(files[0].string(), *layout));
  for (const std::size_t at : {std::size_t{0}, std::size_t{9}, good.size() / 2, good.size() - 1}) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 1);
    std::ofstream(files[0], std::ios::binary) << bad;
    EXPECT_FALSE(read_grid(files[0].string(), *layout)) << at;
  }
  for (const std::string& bad : {std::string(), good.substr(0, 100), good + "x"}) {
    std::ofstream(files[0], std::ios::binary) << bad;
    EXPECT_FALSE(read_grid(files[0].string(), *layout));
  }
  EXPECT_EQ(read(), first.at(point).distance);
  // The damaged file was replaced.
  EXPECT_TRUE(read_grid(files[0].string(), *layout));
}

TEST(GridCache, WorksWithoutAFolder) {
  EXPECT_TRUE(make_distance_field(body_of(box_mesh({0.1, 0.05, 0.02})), "/dev/null/grids"));
}

}  // namespace
}  // namespace retarget

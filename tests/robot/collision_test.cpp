// Distances of primitives, compared with MuJoCo and with the definition of a distance.

#include "robot/model/collision.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <array>
#include <map>
#include <random>
#include <sstream>

#include "retarget/so3.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Type = CollisionShape::Type;

CollisionShape sphere(double radius) {
  CollisionShape shape;
  shape.radius = radius;
  return shape;
}

CollisionShape capsule(double radius, double half_length) {
  CollisionShape shape = sphere(radius);
  shape.type = Type::kCapsule;
  shape.half_length = half_length;
  return shape;
}

CollisionShape box(const Vector3d& half_size) {
  CollisionShape shape;
  shape.type = Type::kBox;
  shape.half_size = half_size;
  return shape;
}

Pose at(double x, double y, double z, const Vector3d& turn = Vector3d::Zero()) {
  return {exp_so3(turn), {x, y, z}};
}

ShapeDistance distance_of(const CollisionShape& a, const Pose& world_from_a,
                          const CollisionShape& b, const Pose& world_from_b) {
  return shape_distance(place(a, world_from_a), place(b, world_from_b));
}

TEST(ShapeDistance, SphereSphere) {
  const auto found = distance_of(sphere(0.1), at(0, 0, 0), sphere(0.2), at(0, 1, 0));
  EXPECT_DOUBLE_EQ(found.distance, 0.7);
  EXPECT_TRUE(found.normal.isApprox(Vector3d(0, 1, 0)));
  EXPECT_TRUE(found.on_a.isApprox(Vector3d(0, 0.1, 0)));
  EXPECT_TRUE(found.on_b.isApprox(Vector3d(0, 0.8, 0)));
  EXPECT_DOUBLE_EQ(distance_of(sphere(0.1), at(0, 0, 0), sphere(0.2), at(0, 0, 0)).distance,
                   -0.1 - 0.2);
}

TEST(ShapeDistance, CapsuleCapsule) {
  const CollisionShape limb = capsule(0.05, 0.2);
  // Side by side, one beyond the other's end, crossed, crossed with touching axes.
  EXPECT_NEAR(distance_of(limb, at(0, 0, 0), limb, at(0.15, 0, 0.1)).distance, 0.05, 1e-15);
  EXPECT_NEAR(distance_of(limb, at(0, 0, 0), limb, at(0, 0, 0.7)).distance, 0.2, 1e-15);
  const Vector3d quarter_about_x(1.5707963267948966, 0, 0);
  EXPECT_NEAR(distance_of(limb, at(0, 0, 0), limb, at(0.3, 0, 0, quarter_about_x)).distance, 0.2,
              1e-15);
  const auto crossed = distance_of(limb, at(0, 0, 0), limb, at(0, 0, 0, quarter_about_x));
  EXPECT_NEAR(crossed.distance, -0.1, 1e-15);
  EXPECT_NEAR(std::abs(crossed.normal.x()), 1.0, 1e-12);
}

TEST(ShapeDistance, BoxContainingSphere) {
  const auto found =
      distance_of(box({0.3, 0.2, 0.1}), at(0, 0, 0), sphere(0.05), at(0, 0.05, 0.08));
  EXPECT_NEAR(found.distance, -0.07, 1e-15);
  EXPECT_TRUE(found.normal.isApprox(Vector3d(0, 0, 1)));
  EXPECT_NEAR((found.on_a - Vector3d(0, 0.05, 0.1)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((found.on_b - Vector3d(0, 0.05, 0.03)).norm(), 0.0, 1e-15);
}

TEST(ShapeDistance, BoxBoxFaceOverlap) {
  const auto found =
      distance_of(box({0.3, 0.2, 0.1}), at(0, 0, 0), box({0.1, 0.1, 0.1}), at(0.39, 0, 0.05));
  EXPECT_NEAR(found.distance, -0.01, 1e-15);
  EXPECT_TRUE(found.normal.isApprox(Vector3d(1, 0, 0)));
}

TEST(ShapeDistance, FindsLowestPoints) {
  EXPECT_DOUBLE_EQ(lowest_point(place(sphere(0.1), at(1, 2, 3))).z(), 2.9);
  EXPECT_NEAR(lowest_point(place(capsule(0.1, 0.5), at(0, 0, 1, {0.5, 0, 0}))).z(),
              1.0 - 0.1 - 0.5 * std::cos(0.5), 1e-15);
  const Pose tilted = at(0, 0, 1, {0.4, -0.3, 0.7});
  const Vector3d lowest = lowest_point(place(box({0.3, 0.2, 0.1}), tilted));
  double min = 10.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d signs((corner & 1) ? 1 : -1, (corner & 2) ? 1 : -1, (corner & 4) ? 1 : -1);
    min = std::min(min, (tilted * signs.cwiseProduct(Vector3d(0.3, 0.2, 0.1))).z());
  }
  EXPECT_NEAR(lowest.z(), min, 1e-15);
}

// Two floating shapes for MuJoCo.
class TwoShapes {
 public:
  TwoShapes(const CollisionShape& a, const CollisionShape& b) {
    const std::string xml = "<mujoco><worldbody>" + body(a) + body(b) + "</worldbody></mujoco>";
    mjSpec* spec = mj_parseXMLString(xml.c_str(), nullptr, nullptr, 0);
    model_.reset(mj_compile(spec, nullptr));
    mj_deleteSpec(spec);
    data_ = mj_makeData(model_.get());
  }
  ~TwoShapes() { mj_deleteData(data_); }
  TwoShapes(const TwoShapes&) = delete;
  TwoShapes& operator=(const TwoShapes&) = delete;

  void place(const Pose& world_from_a, const Pose& world_from_b) {
    int i = 0;
    for (const Pose* pose : {&world_from_a, &world_from_b}) {
      for (int axis = 0; axis < 3; ++axis) data_->qpos[i++] = pose->translation[axis];
      data_->qpos[i++] = pose->rotation.w();
      data_->qpos[i++] = pose->rotation.x();
      data_->qpos[i++] = pose->rotation.y();
      data_->qpos[i++] = pose->rotation.z();
    }
    mj_kinematics(model_.get(), data_);
    mj_comPos(model_.get(), data_);
  }
  // Distance between separate shapes.
  double distance() const {
    mjtNum points[6];
    return mj_geomDistance(model_.get(), data_, 0, 1, 100.0, points);
  }
  // Depth of the deepest contact; 0 without one.
  double depth() const {
    mj_collision(model_.get(), data_);
    double deepest = 0.0;
    for (int i = 0; i < data_->ncon; ++i) deepest = std::max(deepest, -data_->contact[i].dist);
    return deepest;
  }

 private:
  static std::string body(const CollisionShape& shape) {
    std::ostringstream text;
    text.precision(17);
    text << "<body><freejoint/><geom mass='1' ";
    if (shape.type == Type::kBox) {
      text << "type='box' size='" << shape.half_size.transpose() << "'";
    } else if (shape.type == Type::kCapsule) {
      text << "type='capsule' size='" << shape.radius << " " << shape.half_length << "'";
    } else {
      text << "type='sphere' size='" << shape.radius << "'";
    }
    return text.str() + "/></body>";
  }

  ModelPtr model_;
  mjData* data_ = nullptr;
};

class RandomShapes {
 public:
  double number(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  Vector3d vector(double size) {
    return {number(-size, size), number(-size, size), number(-size, size)};
  }
  CollisionShape shape(Type type) {
    switch (type) {
      case Type::kSphere:
        return sphere(number(0.02, 0.1));
      case Type::kCapsule:
        return capsule(number(0.02, 0.1), number(0.02, 0.2));
      case Type::kBox:
        return box({number(0.02, 0.2), number(0.02, 0.2), number(0.02, 0.2)});
    }
    return {};
  }
  // Sometimes rotated by quarter turns, so that faces and edges are parallel.
  Pose pose(double spread) {
    const Vector3d turn = number(0, 1) < 0.2
                              ? Vector3d(0, 0, 1.5707963267948966 * std::floor(number(0, 4)))
                              : vector(3.0);
    return {exp_so3(turn), vector(spread)};
  }

 private:
  std::mt19937 engine_{20};
};

constexpr std::array<Type, 3> kTypes = {Type::kSphere, Type::kCapsule, Type::kBox};

TEST(ShapeDistance, MatchesMujocoOutsideAndForRoundShapesInside) {
  RandomShapes random;
  for (const Type type_a : kTypes) {
    for (const Type type_b : kTypes) {
      const bool boxes = type_a == Type::kBox || type_b == Type::kBox;
      int apart = 0, inside = 0;
      for (int set = 0; set < 20; ++set) {
        const CollisionShape a = random.shape(type_a), b = random.shape(type_b);
        TwoShapes mujoco(a, b);
        for (int i = 0; i < 50; ++i) {
          const Pose world_from_a = random.pose(0.25), world_from_b = random.pose(0.25);
          mujoco.place(world_from_a, world_from_b);
          const ShapeDistance found = distance_of(a, world_from_a, b, world_from_b);
          EXPECT_NEAR(found.normal.norm(), 1.0, 1e-12);
          EXPECT_NEAR((found.on_b - found.on_a - found.distance * found.normal).norm(), 0.0, 1e-9);
          if (found.distance > 1e-4) {
            ++apart;
            // MuJoCo's convex distance stops at its ccd_tolerance, 1e-6.
            EXPECT_NEAR(found.distance, mujoco.distance(), boxes ? 2e-6 : 1e-9)
                << static_cast<int>(type_a) << " " << static_cast<int>(type_b);
            EXPECT_EQ(mujoco.depth(), 0.0);
          } else if (!boxes) {
            ++inside;
            EXPECT_NEAR(-found.distance, mujoco.depth(), 1e-9);
          }
        }
      }
      EXPECT_GT(apart, 100);
      EXPECT_GT(inside, boxes ? -1 : 20);
    }
  }
}

// Moved by slightly more than the depth along the normal, the shapes are separate; moved by less
// than the depth in any direction, they still overlap.
TEST(ShapeDistance, BoxDepthIsTheShortestSeparation) {
  RandomShapes random;
  int inside = 0;
  for (int i = 0; i < 900; ++i) {
    const Type other = kTypes[i % 3];
    const CollisionShape a = random.shape(Type::kBox), b = random.shape(other);
    const Pose world_from_a = random.pose(0.15), world_from_b = random.pose(0.15);
    const ShapeDistance found = distance_of(a, world_from_a, b, world_from_b);
    if (found.distance >= 0.0) continue;
    ++inside;
    const auto moved = [&](const Vector3d& by) {
      return distance_of(a, world_from_a, b, {world_from_b.rotation, world_from_b.translation + by})
          .distance;
    };
    EXPECT_NEAR(moved(-found.distance * found.normal), 0.0, 3e-9);
    EXPECT_GT(moved((1e-6 - found.distance) * found.normal), 0.9e-6);
    for (int direction = 0; direction < 20; ++direction) {
      EXPECT_LT(moved(-0.999 * found.distance * random.vector(1.0).normalized()), 1e-9);
    }
  }
  EXPECT_GT(inside, 150);
}

TEST(ShapeDistance, NormalIsTheGradient) {
  RandomShapes random;
  int checked = 0;
  for (int i = 0; i < 900; ++i) {
    const CollisionShape a = random.shape(kTypes[i % 3]), b = random.shape(kTypes[i / 3 % 3]);
    const Pose world_from_a = random.pose(0.2), world_from_b = random.pose(0.2);
    const ShapeDistance found = distance_of(a, world_from_a, b, world_from_b);
    Vector3d slope;
    const double step = 1e-6;
    for (int axis = 0; axis < 3; ++axis) {
      const auto moved = [&](double by) {
        const Vector3d to = world_from_b.translation + by * Vector3d::Unit(axis);
        return distance_of(a, world_from_a, b, {world_from_b.rotation, to});
      };
      slope[axis] = (moved(step).distance - moved(-step).distance) / (2.0 * step);
    }
    // If two separations are equally short, the slope is between them.
    if (std::abs(slope.norm() - 1.0) > 1e-4) continue;
    ++checked;
    EXPECT_NEAR((slope - found.normal).norm(), 0.0, 1e-3) << i << " " << found.distance;
  }
  EXPECT_GT(checked, 850);
}

// MJCF of a chain: base - link - (rigid) bracket - hand, and a head on the base.
constexpr const char* kChain = R"(
<mujoco>
  <worldbody>
    <body name="base">
      <freejoint/>
      <geom size="0.1"/>
      <body name="link">
        <joint name="a"/>
        <geom size="0.1"/>
        <geom type="capsule" size="0.1 0.2"/>
        <body name="bracket">
          <geom size="0.1"/>
          <body name="hand"><joint name="b"/><geom size="0.1"/></body>
        </body>
      </body>
      <body name="head"><joint name="c"/><geom size="0.1"/></body>
    </body>
  </worldbody>
</mujoco>)";

TEST(CollisionModel, TestsAllPairsExceptRelatives) {
  const auto robot = robot_from_text(kChain);
  const CollisionModel model(*robot);
  std::vector<std::pair<std::string, std::string>> found;
  for (const ShapePair& pair : model.pairs()) {
    EXPECT_LT(pair.a, pair.b);
    found.emplace_back(robot->bodies()[model.shapes()[pair.a].body].name,
                       robot->bodies()[model.shapes()[pair.b].body].name);
  }
  const std::vector<std::pair<std::string, std::string>> expected = {
      {"base", "hand"}, {"link", "head"}, {"link", "head"}, {"bracket", "head"}, {"hand", "head"}};
  EXPECT_EQ(found, expected);
}

TEST(CollisionModel, ExcludesAllowedPairs) {
  const auto g1 = load_g1();
  const CollisionModel model(*g1);
  EXPECT_EQ(model.shapes().size(), 66u);
  for (const ShapePair& pair : model.pairs()) {
    const std::pair<int, int> bodies(model.shapes()[pair.a].body, model.shapes()[pair.b].body);
    for (const auto& allowed : g1->profile().allowed_self_contact) {
      EXPECT_NE(bodies, allowed);
      EXPECT_NE(std::pair(bodies.second, bodies.first), allowed);
    }
  }
}

// Finds exactly MuJoCo's contacts between bodies that may not touch, with their depths; pairs with
// boxes are deep where MuJoCo's are.
TEST(CollisionModel, MatchesMujocoContactsOfTheG1) {
  const auto g1 = load_g1();
  const CollisionModel model(*g1);
  RandomShapes random;
  mjData* data = mj_makeData(g1->model());
  std::vector<Pose> world_from_body(g1->bodies().size());
  std::vector<RoundedShape> placed(model.shapes().size());
  std::vector<ShapePair> near;
  int contacts = 0;
  for (int sample = 0; sample < 200; ++sample) {
    std::vector<double> qpos = g1->zero_configuration();
    for (std::size_t j = 0; j < g1->joints().size(); ++j) {
      qpos[g1->joints()[j].qpos_address] =
          random.number(g1->model_limits().lower[j], g1->model_limits().upper[j]);
    }
    std::copy(qpos.begin(), qpos.end(), data->qpos);
    mj_kinematics(g1->model(), data);
    mj_comPos(g1->model(), data);
    mj_collision(g1->model(), data);
    std::map<std::pair<int, int>, double> expected;
    for (int i = 0; i < data->ncon; ++i) {
      const mjContact& contact = data->contact[i];
      const int a = std::min(contact.geom[0], contact.geom[1]);
      const int b = std::max(contact.geom[0], contact.geom[1]);
      double& depth = expected[{a, b}];
      depth = std::max(depth, -contact.dist);
    }
    forward_kinematics(*g1, qpos, world_from_body);
    model.place(world_from_body, placed);
    model.near_pairs(placed, 0.0, near);
    for (const ShapePair& pair : near) {
      const double depth = -shape_distance(placed[pair.a], placed[pair.b]).distance;
      // The G1's shapes are all its geoms, in order.
      const auto found = expected.find({pair.a, pair.b});
      if (depth < 1e-9) {
        EXPECT_TRUE(found == expected.end() || found->second < 1e-8);
        continue;
      }
      ++contacts;
      ASSERT_TRUE(found != expected.end());
      const bool boxes =
          model.shapes()[pair.a].type == Type::kBox || model.shapes()[pair.b].type == Type::kBox;
      if (!boxes) {
        EXPECT_NEAR(depth, found->second, 1e-9);
      }
    }
  }
  EXPECT_GT(contacts, 100);
  mj_deleteData(data);
}

}  // namespace
}  // namespace retarget

#pragma once

#include <array>
#include <random>
#include <string>
#include <vector>

#include "formats/smpl/smpl_body.h"
#include "support/npz_builder.h"

namespace retarget {

/// Numbers between -1 and 1, the same on every machine.
class Numbers {
 public:
  explicit Numbers(unsigned seed) : engine_(seed) {}
  double next() { return static_cast<double>(engine_()) / (0.5 * 4294967295.0) - 1.0; }
  std::vector<double> list(std::size_t count, double scale = 1.0) {
    std::vector<double> values(count);
    for (double& value : values) value = scale * next();
    return values;
  }

 private:
  std::mt19937 engine_;
};

/// An artificial body model: random points around a body, random shapes, joints that mix a few
/// vertices each. It contains no data of a real person.
struct MadeUpModel {
  std::size_t vertex_count = 40;
  std::size_t joint_count = 24;
  std::size_t beta_count = 3;
  std::vector<double> vertices, directions, regressor;
  std::vector<std::uint32_t> tree;

  MadeUpModel(std::size_t joints, std::size_t betas) : joint_count(joints), beta_count(betas) {
    Numbers numbers(7);
    for (std::size_t i = 0; i < vertex_count; ++i) {
      vertices.insert(vertices.end(),
                      {0.6 * numbers.next(), 0.7 * numbers.next(), 0.1 * numbers.next()});
    }
    const auto set = [this](std::size_t vertex, std::array<double, 3> place) {
      std::copy(place.begin(), place.end(), vertices.begin() + static_cast<long>(3 * vertex));
    };
    set(0, {0.01, 0.8, 0.0});    // top of the head
    set(1, {0.1, -0.88, 0.2});   // left toes
    set(2, {-0.1, -0.88, 0.2});  // right toes
    set(3, {0.9, 0.4, 0.0});     // left fingers
    set(4, {-0.9, 0.4, 0.0});    // right fingers
    set(5, {0.05, -0.9, 0.0});   // The lowest vertex.
    set(6, {0.02, 0.1, 0.35});   // the belly: further forward than the toes
    directions = numbers.list(3 * vertex_count * beta_count, 0.01);
    regressor.assign(joint_count * vertex_count, 0.0);
    for (std::size_t joint = 0; joint < joint_count; ++joint) {
      regressor[joint * vertex_count + joint % vertex_count] += 0.75;
      regressor[joint * vertex_count + (5 * joint + 11) % vertex_count] += 0.25;
    }
    for (std::size_t joint = 0; joint < joint_count; ++joint) {
      const int parent = joint < kSmplParents.size() ? kSmplParents[joint] : 20;
      // The parent of the root is -1, as unsigned.
      tree.push_back(static_cast<std::uint32_t>(parent));
    }
    for (std::size_t joint = 0; joint < joint_count; ++joint) {
      tree.push_back(static_cast<std::uint32_t>(joint));
    }
  }

  [[nodiscard]] NpzBuilder builder_without(const std::string& left_out) const {
    NpzBuilder builder;
    const auto add = [&](const std::string& name, const std::string& bytes) {
      if (name != left_out) builder.add(name, bytes);
    };
    add("f", npy("|O", "()", "never looked at"));
    add("v_template", npy_doubles({vertex_count, 3}, vertices));
    add("shapedirs", npy_doubles({vertex_count, 3, beta_count}, directions));
    add("J_regressor", npy_doubles({joint_count, vertex_count}, regressor));
    add("kintree_table", npy("<u4", shape_of({2, joint_count}), element_bytes(tree)));
    return builder;
  }
  [[nodiscard]] std::string bytes() const { return builder_without("").build(); }

  /// One coordinate of a vertex of the shaped mesh.
  [[nodiscard]] double shaped(std::size_t vertex, std::size_t axis,
                              const std::vector<double>& betas) const {
    double value = vertices[3 * vertex + axis];
    for (std::size_t i = 0; i < betas.size(); ++i) {
      value += betas[i] * directions[(3 * vertex + axis) * beta_count + i];
    }
    return value;
  }

  /// Regressed joint position over all vertices of the shaped mesh.
  [[nodiscard]] Eigen::Vector3d joint(std::size_t joint, const std::vector<double>& betas) const {
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < vertex_count; ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        place[static_cast<long>(axis)] +=
            regressor[joint * vertex_count + i] * shaped(i, axis, betas);
      }
    }
    return place;
  }
};

}  // namespace retarget

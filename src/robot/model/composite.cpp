#include "robot/model/composite.h"

#include <algorithm>
#include <vector>

namespace retarget {
namespace {

constexpr int kBaseDofs = KinematicTree::kBaseDofs;

// The base translates along world axes and rotates about its own axes.
void fill_base_rows(const Composite& base, const Eigen::Matrix3d& world_from_base,
                    const int* row_begin, std::span<double> hessian, std::span<double> gradient) {
  const Eigen::Matrix3d turned_mixed = world_from_base.transpose() * base.mixed.transpose();
  const Eigen::Matrix3d turned_angular =
      world_from_base.transpose() * base.angular * world_from_base;
  const Eigen::Vector3d turned_torque = world_from_base.transpose() * base.torque;
  for (int i = 0; i < 3; ++i) {
    double* const linear = hessian.data() + row_begin[i];
    for (int j = 0; j <= i; ++j) linear[j] = base.linear(i, j);
    double* const angular = hessian.data() + row_begin[3 + i];
    for (int j = 0; j < 3; ++j) angular[j] = turned_mixed(i, j);
    for (int j = 0; j <= i; ++j) angular[3 + j] = turned_angular(i, j);
    gradient[i] = base.force[i];
    gradient[3 + i] = turned_torque[i];
  }
}

}  // namespace

void assemble(const TreeState& state, std::span<Composite> composites, std::span<double> hessian,
              std::span<double> gradient) {
  // Pointers, because the containers' bounds checks would take a sixth of the time.
  const KinematicTree::Link* const links = state.tree->links().data();
  const int* const row_begin = state.tree->row_begin().data();
  const Eigen::Vector3d *const linear = state.linear.data(), *const angular = state.angular.data();
  const Eigen::Matrix3d world_from_base = state.world_from_link[0].rotation.toRotationMatrix();
  for (int link = static_cast<int>(composites.size()) - 1; link > 0; --link) {
    const int dof = KinematicTree::dof_of(link);
    const Composite& composite = composites.data()[link];
    const Eigen::Vector3d &v = linear[dof], &w = angular[dof];
    const Eigen::Vector3d force = composite.linear * v + composite.mixed * w;
    const Eigen::Vector3d torque = composite.mixed.transpose() * v + composite.angular * w;
    const Eigen::Vector3d base_torque = world_from_base.transpose() * torque;
    double* const row = hessian.data() + row_begin[dof];
    for (int i = 0; i < 3; ++i) {
      row[i] = force[i];
      row[3 + i] = base_torque[i];
    }
    double* entry = hessian.data() + row_begin[dof + 1];
    for (int j = link; j > 0; j = links[j].parent) {
      const int carrier = KinematicTree::dof_of(j);
      *--entry = linear[carrier].dot(force) + angular[carrier].dot(torque);
    }
    gradient.data()[dof] = v.dot(composite.force) + w.dot(composite.torque);
    composites.data()[links[link].parent] += composite;
  }
  fill_base_rows(composites[0], world_from_base, row_begin, hessian, gradient);
}

void write_lower_triangle(const KinematicTree& tree, std::span<const double> rows, double* matrix,
                          int stride) {
  const std::ptrdiff_t size = tree.dof_count();
  std::fill_n(matrix, size * stride, 0.0);
  const int* const row_begin = tree.row_begin().data();
  const int* const columns = tree.carriers(0).data();
  for (std::ptrdiff_t i = 0; i < size; ++i) {
    double* const row = matrix + i * stride;
    for (int k = row_begin[i]; k < row_begin[i + 1]; ++k) row[columns[k]] = rows.data()[k];
  }
}

}  // namespace retarget

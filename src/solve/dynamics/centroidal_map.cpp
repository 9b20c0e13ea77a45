#include "solve/dynamics/centroidal_map.h"

#include <Eigen/Geometry>

namespace retarget {

using Eigen::Matrix3d;
using Eigen::Vector3d;

CentroidalMap::CentroidalMap(const KinematicTree& tree, const Inertias& inertias)
    : tree_(&tree),
      inertias_(&inertias),
      carried_(tree.links().size()),
      rows_(Rows::Zero(6, tree.dof_count())) {}

void CentroidalMap::update(const TreeState& state) {
  for (std::size_t i = 0; i < carried_.size(); ++i) {
    const LinkInertia& link = inertias_->links[i];
    const Matrix3d axes = state.world_from_link[i].rotation.toRotationMatrix();
    const Vector3d com = state.world_from_link[i].translation + axes * link.com - state.origin();
    carried_[i] = {link.mass, link.mass * com,
                   axes * link.about_com * axes.transpose() + point_inertia(link.mass, com)};
  }
  for (std::size_t i = carried_.size() - 1; i > 0; --i) {
    Carried& parent = carried_[static_cast<std::size_t>(tree_->links()[i].parent)];
    parent.mass += carried_[i].mass;
    parent.first_moment += carried_[i].first_moment;
    parent.inertia += carried_[i].inertia;
  }
  const Vector3d centre = carried_[0].first_moment / inertias_->mass;
  com_ = state.origin() + centre;
  for (int dof = 0; dof < tree_->dof_count(); ++dof) {
    const int link = dof < KinematicTree::kBaseDofs ? 0 : dof - KinematicTree::dof_of(0);
    const Carried& moved = carried_[static_cast<std::size_t>(link)];
    const Vector3d &v = state.linear[static_cast<std::size_t>(dof)],
                   &w = state.angular[static_cast<std::size_t>(dof)];
    const Vector3d momentum = moved.mass * v + w.cross(moved.first_moment);
    const Vector3d spin = moved.first_moment.cross(v) + moved.inertia * w;
    rows_.col(dof) << momentum / inertias_->mass, spin - centre.cross(momentum);
  }
}

}  // namespace retarget

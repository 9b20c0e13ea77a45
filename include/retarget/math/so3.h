#pragma once
#include <Eigen/Geometry>
namespace retarget {
inline Eigen::Quaterniond exp_so3(const Eigen::Vector3d& w) {
  double t = w.norm();
  if (t < 1e-12) return Eigen::Quaterniond(1, w.x() / 2, w.y() / 2, w.z() / 2);
  return Eigen::Quaterniond(Eigen::AngleAxisd(t, w / t));
}
inline Eigen::Vector3d log_so3(const Eigen::Quaterniond& q0) {
  Eigen::Quaterniond q = q0;
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  double n = q.vec().norm();
  if (n < 1e-10) return Eigen::Vector3d::Zero();
  return 2 * std::atan2(n, q.w()) * q.vec() / n;
}
}  // namespace retarget

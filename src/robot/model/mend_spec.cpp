#include "robot/model/mend_spec.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace retarget {
namespace {

std::string element_name(mjsElement* element) {
  return mjs_getString(mjs_getName(element));
}

int joints_below(mjsBody* body) {
  int count = 0;
  for (mjsElement* e = mjs_firstChild(body, mjOBJ_JOINT, 1); e != nullptr;
       e = mjs_nextChild(body, e, 1)) {
    ++count;
  }
  return count;
}

std::vector<mjsJoint*> joints_of(mjsBody* body) {
  std::vector<mjsJoint*> joints;
  for (mjsElement* e = mjs_firstChild(body, mjOBJ_JOINT, 0); e != nullptr;
       e = mjs_nextChild(body, e, 0)) {
    joints.push_back(mjs_asJoint(e));
  }
  return joints;
}

// Returns the child body if it is the only one, otherwise null.
mjsBody* only_child(mjsBody* body) {
  mjsElement* first = mjs_firstChild(body, mjOBJ_BODY, 0);
  if (first == nullptr || mjs_nextChild(body, first, 0) != nullptr) return nullptr;
  return mjs_asBody(first);
}

bool is_sound(const mjsBody& body) {
  if (!std::isfinite(body.mass) || body.mass < 0.0) return false;
  const auto finite = [](const double* values, int count) {
    return std::all_of(values, values + count, [](double v) { return std::isfinite(v); });
  };
  if (!finite(body.inertia, 3) ||
      std::ranges::any_of(body.inertia, [](double v) { return v < 0; })) {
    return false;
  }
  const double* full = body.fullinertia;
  // NaN means that no full inertia is given.
  if (std::isnan(full[0])) return true;
  if (!finite(full, 6)) return false;
  Eigen::Matrix3d inertia;
  inertia << full[0], full[3], full[4], full[3], full[1], full[5], full[4], full[5], full[2];
  constexpr double kLeast = 1e-12;  // Above MuJoCo's threshold for zero.
  // MuJoCo can raise a zero inertia to its minimum.
  if (inertia.norm() < kLeast) return true;
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia).eigenvalues().minCoeff() > kLeast;
}

std::optional<std::string> body_named(mjSpec* spec, mjtObj kind, const std::string& name) {
  if (name.empty()) return std::nullopt;
  mjsElement* element = mjs_findElement(spec, kind, name.c_str());
  if (element == nullptr) return std::nullopt;
  mjsBody* body = kind == mjOBJ_BODY ? mjs_asBody(element) : mjs_getParent(element);
  return body == nullptr ? std::nullopt : std::optional(element_name(body->element));
}

}  // namespace

std::vector<mjsElement*> elements_of(mjSpec* spec, mjtObj kind) {
  std::vector<mjsElement*> elements;
  for (mjsElement* e = mjs_firstElement(spec, kind); e != nullptr; e = mjs_nextElement(spec, e)) {
    elements.push_back(e);
  }
  return elements;
}

std::vector<std::string> mend_inertias(mjSpec* spec) {
  constexpr double kSmall = 1e-6;
  std::vector<std::string> mended;
  for (mjsElement* element : elements_of(spec, mjOBJ_BODY)) {
    mjsBody& body = *mjs_asBody(element);
    if (is_sound(body)) continue;
    mended.push_back(element_name(element));
    if (!std::isfinite(body.mass) || body.mass < 0.0) body.mass = kSmall;
    std::ranges::fill(body.fullinertia, std::numeric_limits<double>::quiet_NaN());
    std::ranges::fill(body.inertia, kSmall);
  }
  return mended;
}

mjsBody* robot_base(mjSpec* spec) {
  mjsBody* world = mjs_findBody(spec, "world");
  mjsBody* base = nullptr;
  for (mjsElement* e = mjs_firstChild(world, mjOBJ_BODY, 0); e != nullptr;
       e = mjs_nextChild(world, e, 0)) {
    mjsBody* body = mjs_asBody(e);
    if (base == nullptr || joints_below(body) > joints_below(base)) base = body;
  }
  return base;
}

std::vector<std::string> free_sliding_root(mjSpec* spec) {
  std::vector<mjsJoint*> root;
  bool slides = false;
  for (mjsBody* body = robot_base(spec); body != nullptr; body = only_child(body)) {
    const std::vector<mjsJoint*> joints = joints_of(body);
    const bool first_slides = !joints.empty() && joints.front()->type == mjJNT_SLIDE;
    slides = slides || first_slides;
    // A root that turns before it slides may be a waist.
    if (!joints.empty() && !slides) break;
    root.insert(root.end(), joints.begin(), joints.end());
  }
  std::vector<std::string> names;
  for (mjsJoint* joint : root) {
    names.push_back(element_name(joint->element));
    mjs_delete(spec, joint->element);
  }
  return names;
}

std::vector<std::string> hold_loose_balls(mjSpec* spec) {
  std::vector<std::string> names;
  for (mjsElement* element : elements_of(spec, mjOBJ_JOINT)) {
    if (mjs_asJoint(element)->type != mjJNT_BALL) continue;
    mjsBody* body = mjs_getParent(element);
    if (body == nullptr || joints_below(body) > 1) continue;
    names.push_back(element_name(element));
    mjs_delete(spec, element);
  }
  return names;
}

std::vector<TiedBodies> tied_bodies(mjSpec* spec) {
  std::vector<TiedBodies> tied;
  for (mjsElement* element : elements_of(spec, mjOBJ_EQUALITY)) {
    const mjsEquality& equality = *mjs_asEquality(element);
    if (equality.type != mjEQ_CONNECT && equality.type != mjEQ_WELD) continue;
    const mjtObj kind = equality.objtype == mjOBJ_SITE ? mjOBJ_SITE : mjOBJ_BODY;
    const auto first = body_named(spec, kind, mjs_getString(equality.name1));
    const auto second = body_named(spec, kind, mjs_getString(equality.name2));
    if (first && second && *first != "world" && *second != "world")
      tied.push_back({*first, *second});
  }
  return tied;
}

}  // namespace retarget

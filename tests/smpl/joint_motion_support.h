#pragma once

#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

#include "base/option_name.h"
#include "formats/smpl/joint_motion.h"
#include "formats/smpl/read_smpl.h"

namespace retarget {

/// 0, 1, 2, ...
inline std::vector<double> counted(std::size_t count) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<double>(i);
  return values;
}

inline JointMotion joints_of(const std::string& bytes, const ArrayReadOptions& options = {}) {
  Result<ArrayMotion> motion = read_array_motion(bytes, "joints", options);
  if (motion && std::holds_alternative<JointMotion>(*motion)) return std::get<JointMotion>(*motion);
  ADD_FAILURE() << (motion ? "a motion of SMPL" : describe(motion.error()));
  return {};
}

inline std::string joint_error(const std::string& bytes, const ArrayReadOptions& options = {}) {
  const Result<ArrayMotion> motion = read_array_motion(bytes, "joints.npy", options);
  if (motion) return "no error";
  EXPECT_EQ(motion.error().kind, ErrorKind::kInput);
  EXPECT_EQ(motion.error().location.file, "joints.npy");
  return describe(motion.error(), option_as_flag);
}

}  // namespace retarget

#pragma once

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdint>
#include <string>
#include <vector>

#include "formats/containers/npz.h"
#include "formats/containers/pickle.h"
#include "formats/smpl/read_smpl.h"
#include "smpl_test_support.h"
#include "support/load_smpl.h"
#include "support/torch_builder.h"
#include "support/value_of.h"

namespace retarget {

inline constexpr std::size_t kPartFrames = 5;

// Numbers that floats represent exactly, so that files of floats and of doubles are equal.
inline std::vector<double> float_numbers(unsigned seed, std::size_t count, double scale) {
  std::vector<double> values = Numbers(seed).list(count, scale);
  for (double& value : values) value = static_cast<float>(value);
  return values;
}

inline std::vector<float> floats_of(const std::vector<double>& values) {
  return {values.begin(), values.end()};
}

// The parts of an SMPL motion.
struct Parts {
  std::vector<double> root = float_numbers(11, kPartFrames * 3, 1.5);
  std::vector<double> body = float_numbers(12, kPartFrames * 63, 0.8);
  std::vector<double> trans = float_numbers(13, kPartFrames * 3, 1.0);
  std::vector<double> betas = {1, 0.5, -2};

  [[nodiscard]] std::string npz(double fps = 30) const {
    NpzBuilder builder;
    builder.add("root_orient", npy_doubles({kPartFrames, 3}, root));
    builder.add("pose_body", npy_doubles({kPartFrames, 63}, body));
    builder.add("trans", npy_doubles({kPartFrames, 3}, trans));
    builder.add("betas", npy_doubles({betas.size()}, betas));
    builder.add("gender", npy_text("neutral"));
    builder.add("fps", npy_doubles({}, {fps}));
    return builder.build();
  }

  // In the form of GVHMR's results; every array in another layout.
  [[nodiscard]] std::string gvhmr(const std::string& name = "smpl_params_global") const {
    TorchBuilder builder;
    const auto frames = static_cast<std::int64_t>(kPartFrames);
    std::vector<float> columns;  // a transposed view
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t frame = 0; frame < kPartFrames; ++frame) {
        columns.push_back(static_cast<float>(trans[3 * frame + axis]));
      }
    }
    const std::string storage = builder.storage("FloatStorage", element_bytes(columns), 3 * frames);
    const std::string betas_once =
        builder.storage("FloatStorage", element_bytes(floats_of(betas)), 3);
    const std::string motion = TorchBuilder::dictionary(
        {{"body_pose", builder.floats({frames, 63}, floats_of(body))},
         {"betas", TorchBuilder::rebuilt(betas_once, {{frames, 3}, 0, {0, 1}})},
         {"global_orient", builder.floats({frames, 3}, floats_of(root))},
         {"transl", TorchBuilder::rebuilt(storage, {{frames, 3}, 0, {1, frames}})}});
    return builder.build(
        TorchBuilder::dictionary({{name, motion}, {"K_fullimg", builder.floats({1}, {1})}}));
  }

  [[nodiscard]] std::string pickle(bool packed = false) const {
    PickleWriter pickle;
    pickle.begin_dict();
    const auto add = [&](const char* name, const std::vector<double>& values, std::size_t width) {
      pickle.text(name);
      pickle.array(float64_array(values, {values.size() / width, width}));
    };
    add("global_orient", root, 3);
    add("body_pose", body, 63);
    add("transl", trans, 3);
    add("betas", betas, betas.size());
    pickle.text("gender");
    pickle.text("neutral");
    pickle.text("fps");
    pickle.integer(30);
    pickle.end_dict();
    const std::string bytes = pickle.finish();
    if (!packed) return bytes;
    std::string small(compressBound(bytes.size()), '\0');
    uLongf size = small.size();
    compress2(reinterpret_cast<Bytef*>(small.data()), &size,
              reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), 6);
    small.resize(size);
    return small;
  }
};

inline SmplMotion motion_of(const std::string& bytes, const ArrayReadOptions& options = {}) {
  return value_of(read_smpl(bytes, "walk", options));
}

inline std::string error_of(const std::string& bytes) {
  const Result<SmplMotion> motion = read_smpl(bytes, "walk.pt");
  if (motion) return "no error";
  EXPECT_EQ(motion.error().kind, ErrorKind::kInput);
  EXPECT_EQ(motion.error().location.file, "walk.pt");
  return describe(motion.error());
}

inline std::string warnings_of(const SmplMotion& motion) {
  std::string text;
  for (const Warning& warning : motion.warnings) text += warning.message + "\n";
  return text;
}

// @param world  rotation of the clip's world relative to the expected one
inline void expect_same_motion(const SmplMotion& found, const SmplMotion& expected,
                               double tolerance = 0.0,
                               const Eigen::Quaterniond& world = Eigen::Quaterniond::Identity()) {
  ASSERT_EQ(found.clip.frame_count(), expected.clip.frame_count());
  EXPECT_EQ(found.clip.rate(), expected.clip.rate());
  EXPECT_EQ(found.gender, expected.gender);
  EXPECT_NEAR(found.height, expected.height, tolerance);
  const bool turned = world.w() < 1.0;
  for (int frame = 0; frame < found.clip.frame_count(); ++frame) {
    for (int joint = 0; joint < kSmplJointCount; ++joint) {
      Eigen::Quaterniond rotation = expected.clip.rotations(frame)[joint];
      Eigen::Vector3d place = expected.clip.translation(frame, joint);
      if (turned && joint == 0) rotation = world * rotation;
      if (turned && joint == 0) place = world * place;
      EXPECT_LE((found.clip.rotations(frame)[joint].coeffs() - rotation.coeffs()).norm(),
                tolerance);
      EXPECT_LE((found.clip.translation(frame, joint) - place).norm(), tolerance);
    }
  }
}

}  // namespace retarget

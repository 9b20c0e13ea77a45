#include "formats/smpl/read_smpl.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <span>
#include <utility>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/smpl/motion_arrays.h"
#include "motion/clip.h"
#include "retarget/text.h"

namespace retarget {
namespace {

bool is_positive(std::optional<double> value) {
  return !value || (std::isfinite(*value) && *value > 0.0);
}

Result<SmplRestBody> generic_rest_body(const ArraySource& file, const std::vector<double>& betas) {
  const double guess = smpl_height_of_betas(betas);
  if (is_human_height(guess)) return generic_smpl_rest_body(guess);
  return file.array_failure("betas",
                            "the first one, " + std::to_string(betas.front()) +
                                ", would give a body height of " + std::to_string(guess) + " m",
                            "check the file, or give the body model with " OPTION("smpl-model"));
}

// Evaluates the model with the motion's betas if both belong to the same family.
SmplRestBody model_rest_body(const SmplBody& body, MotionArrays& arrays) {
  const auto warn = [&arrays](std::string message) {
    arrays.warnings.push_back({0, 0, std::move(message)});
  };
  const bool other_family = arrays.family != SmplFamily::kUnknown &&
                            body.family != SmplFamily::kUnknown && arrays.family != body.family;
  if (other_family && !arrays.betas.empty()) {
    warn(std::string("the betas belong to ") +
         (arrays.family == SmplFamily::kSmplx ? "SMPL-X" : "SMPL or SMPL+H") +
         ", the body model to another family: using its average shape");
    return smpl_rest_body(body, {});
  }
  const auto known = static_cast<std::ptrdiff_t>(
      std::min(arrays.betas.size(), static_cast<std::size_t>(body.beta_count())));
  const bool lost = std::any_of(arrays.betas.begin() + known, arrays.betas.end(),
                                [](double beta) { return beta != 0.0; });
  if (lost) {
    warn("the body model has " + std::to_string(known) + " betas, the motion " +
         std::to_string(arrays.betas.size()) + ": the extra ones are ignored");
  }
  return smpl_rest_body(body, arrays.betas);
}

// Chooses the user's model, the file's own bones or the generic body, in this order. Without betas
// the model's shape is arbitrary, so the file's own bones take precedence.
Result<SmplRestBody> rest_body_of(const ArraySource& file, MotionArrays& arrays,
                                  const ArrayReadOptions& options) {
  const bool has_own = arrays.body.has_value();
  if (options.body != nullptr && !(has_own && arrays.betas.empty())) {
    return model_rest_body(*options.body, arrays);
  }
  if (has_own) return *arrays.body;
  return generic_rest_body(file, arrays.betas);
}

// @param y_is_up  the file's world has Y up; the motion is rotated to Z up
Clip clip_of(const MotionArrays& arrays, const SmplRestBody& body, bool y_is_up) {
  const bool fingers = !arrays.hand_rotations.empty();
  Clip clip(smpl_skeleton(body, fingers), arrays.rate, arrays.frame_count);
  const std::vector<int> order = smpl_skeleton_order(fingers);
  for (int frame = 0; frame < arrays.frame_count; ++frame) {
    const auto row = static_cast<std::size_t>(frame);
    const auto rotations =
        std::span(arrays.rotations).subspan(row * kSmplJointCount, kSmplJointCount);
    std::span<const Eigen::Vector3d> hands;
    if (fingers) {
      hands =
          std::span(arrays.hand_rotations).subspan(row * kSmplHandJointCount, kSmplHandJointCount);
    }
    // The models rotate about the pelvis, so its rest position is not rotated.
    Eigen::Vector3d& pelvis = clip.translations(frame)[0];
    pelvis = arrays.translations[row] + body.joints[0];
    pose_smpl_skeleton(order, rotations, hands, y_is_up, clip.rotations(frame), pelvis);
  }
  return clip;
}

Result<SmplMotion> read_smpl_motion(const MotionFile& opened, const ArrayReadOptions& options) {
  const ArraySource& file = *opened.arrays;
  TRY_ASSIGN(auto arrays, read_motion_arrays(file, opened.kind, options.source_fps));
  arrays.warnings.insert(arrays.warnings.end(), opened.warnings.begin(), opened.warnings.end());
  const bool own_body = arrays.body.has_value();
  TRY_ASSIGN(const auto body, rest_body_of(file, arrays, options));
  const std::size_t needed = static_cast<std::size_t>(arrays.frame_count) *
                             frame_bytes(*smpl_skeleton(body, !arrays.hand_rotations.empty()));
  if (needed > options.max_clip_bytes) {
    return file.file_failure(
        std::to_string(arrays.frame_count) + " frames take " +
            number_text(static_cast<double>(needed) / 1e6, 1) + " MB of memory, at most " +
            number_text(static_cast<double>(options.max_clip_bytes) / 1e6, 1) + " MB are allowed",
        OPTION("memory") " allows more; or split the motion");
  }
  if (const auto unit = find_translation_unit(arrays, body)) {
    for (Eigen::Vector3d& place : arrays.translations) place *= unit->metres;
    arrays.warnings.push_back({0, 0, unit->reason});
  }
  Clip clip = clip_of(arrays, body, opened.kind.y_is_up);
  return SmplMotion{std::move(clip),
                    arrays.family,
                    std::move(arrays.gender),
                    std::move(arrays.betas),
                    options.body == nullptr && !own_body,
                    body.height,
                    std::move(arrays.warnings),
                    opened.kind.up};
}

Result<ArrayMotion> read_motion(std::string_view bytes, const std::string& file_name,
                                const ArrayReadOptions& options) {
  TRY_ASSIGN(const auto opened, open_motion_file(bytes, file_name, options));
  ArrayReadOptions of_motion = options;
  if (opened.took) of_motion.take.clear();
  if (opened.content == MotionContent::kJoints) {
    TRY_ASSIGN(auto motion, read_joint_motion(*opened.arrays, of_motion));
    return ArrayMotion(std::move(motion));
  }
  if (!of_motion.take.empty() && of_motion.take != "1") {
    return opened.arrays->file_failure("the file has only one motion", "omit " OPTION("take"));
  }
  TRY_ASSIGN(auto motion, read_smpl_motion(opened, options));
  return ArrayMotion(std::move(motion));
}

}  // namespace

Result<ArrayMotion> read_array_motion(std::string_view bytes, const std::string& file_name,
                                      const ArrayReadOptions& options) {
  if (!is_positive(options.source_fps)) {
    return usage_failure("the source frame rate must be a finite number above 0");
  }
  try {
    return read_motion(bytes, file_name, options);
  } catch (const std::bad_alloc&) {
    return run_failure(file_name, "not enough memory for the motion in this file");
  }
}

}  // namespace retarget

#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/smpl.h"

namespace retarget {

/// Models that share one shape space (betas).
enum class SmplFamily : std::uint8_t {
  kUnknown,
  kSmpl,   ///< SMPL and SMPL+H.
  kSmplx,  ///< SMPL-X, with other betas than SMPL.
};

/// The user's body model, reduced to the data that joints need. Each point is linear in the betas.
struct SmplBody {
  std::string file;
  SmplFamily family = SmplFamily::kUnknown;
  /// x, y, z of the joints, the tips, the lowest vertex and, if the model has them, the hand
  /// joints; metres, with all betas zero.
  Eigen::VectorXd points;
  /// Derivative of `points` with respect to the betas, one column per beta.
  Eigen::MatrixXd shape_directions;

  [[nodiscard]] int beta_count() const { return static_cast<int>(shape_directions.cols()); }
};

/// Reads a model file of SMPL-X or SMPL+H: an NPZ with v_template (V, 3), shapedirs (V, 3, B),
/// J_regressor (J, V) as a dense array and kintree_table (2, J). Other arrays are ignored.
///
/// Joints are J_regressor * (v_template + shapedirs * betas), which is valid for the rest mesh
/// only. Tips are vertices at the extremes of the unshaped mesh. The first 300 of SMPL-X's
/// shapedirs belong to betas (10 in old files with fewer than 400), the others to the face.
///
/// Errors (kConfig): not an NPZ file (for example SMPL's pickles, which are never unpickled),
/// arrays that are missing, hold objects (a sparse J_regressor), have other shapes or are not
/// finite, joints other than SMPL's, a mesh that is not a body in metres.
/// @param bytes      the whole file.
/// @param file_name  name given by the user, for messages.
[[nodiscard]] Result<SmplBody> read_smpl_body(std::string_view bytes, const std::string& file_name);

/// Reads a body model from a file; see read_smpl_body.
[[nodiscard]] Result<SmplBody> load_smpl_body(const std::string& path);

/// Evaluates the model for these betas. Missing betas count as zero, extra ones are ignored.
[[nodiscard]] SmplRestBody smpl_rest_body(const SmplBody& body, std::span<const double> betas);

/// A finger of average proportions, in metres for a body 1.75 m tall. Palm axes: x along the hand,
/// y to the thumb's side, z out of the palm; the origin is the wrist.
struct GenericFinger {
  Eigen::Vector3d knuckle;        ///< Knuckle position; for the thumb, its base at the wrist.
  Eigen::Vector3d direction;      ///< Unit vector along the straight finger.
  std::array<double, 3> bones{};  ///< Bone lengths from the knuckle; the last includes the soft
                                  ///< tip.
};

/// A hand of average proportions, indexed by Finger. docs/hands.md has the table and its sources;
/// no data comes from a body model.
[[nodiscard]] const std::array<GenericFinger, kFingerCount>& generic_hand();

}  // namespace retarget

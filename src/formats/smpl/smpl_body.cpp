#include "formats/smpl/smpl_body.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

#include "base/try.h"
#include "formats/containers/npy.h"
#include "formats/containers/npz.h"
#include "retarget/file.h"

namespace retarget {
namespace {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr std::string_view kSaveHint =
    "save v_template, shapedirs, J_regressor (as a dense array) and kintree_table of the model "
    "with numpy.savez; docs/smpl.md has the lines";

// A few times the size of the largest model.
constexpr std::size_t kMaxFileBytes = std::size_t{1} << 30U;
constexpr int kSmplxJointCount = 55, kSmplhJointCount = 52;
constexpr int kSole = kSmplTipCount;  // The lowest vertex, after the tips.
constexpr int kPointCount = kSmplJointCount + kSmplTipCount + 1;

// The vertex with the highest score on a side (-1 right, 1 left, 0 both); -1 if there is none.
template <typename Score>
Eigen::Index best_vertex(const RowMatrix& vertices, int side, const Score& score) {
  Eigen::Index best = -1;
  double best_score = -std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < vertices.rows(); ++i) {
    if (vertices(i, 0) * side < 0.0) continue;
    const double value = score(Eigen::Vector3d(vertices.row(i)));
    if (value <= best_score) continue;
    best = i;
    best_score = value;
  }
  return best;
}

class BodyReader {
 public:
  explicit BodyReader(const NpzFile& file) : file_(file) {}

  Result<SmplBody> read(const std::string& file_name) {
    TRY(read_arrays());
    TRY(find_landmarks());

    SmplBody body;
    body.file = file_name;
    body.family = regressor_.rows() == kSmplxJointCount ? SmplFamily::kSmplx : SmplFamily::kSmpl;
    if (body.family == SmplFamily::kSmplx) {
      // The remaining columns are facial expressions.
      const Eigen::Index shapes = directions_.cols() / 3 < 400 ? 10 : 300;
      beta_count_ = std::min(beta_count_, shapes);
    }
    const bool has_hands =
        regressor_.rows() == kSmplxJointCount || regressor_.rows() == kSmplhJointCount;
    const int count = kPointCount + (has_hands ? kSmplHandJointCount : 0);
    body.points = Eigen::VectorXd::Zero(3 * count);
    body.shape_directions = Eigen::MatrixXd::Zero(3 * count, beta_count_);
    const auto add_joint = [&](int point, Eigen::Index joint) {
      for (Eigen::Index i = 0; i < vertices_.rows(); ++i) {
        add_vertex(body, point, regressor_(joint, i), i);
      }
    };
    for (int joint = 0; joint < kSmplJointCount; ++joint) add_joint(joint, joint);
    // The hand joints are the last joints of the models.
    for (int i = kPointCount; i < count; ++i) add_joint(i, regressor_.rows() - count + i);
    for (int i = 0; i <= kSole; ++i) add_vertex(body, kSmplJointCount + i, 1.0, landmarks_[i]);
    return body;
  }

 private:
  Result<void> read_arrays() {
    if (!file_.has("v_template") && (file_.has("poses") || file_.has("pose_body"))) {
      return file_.file_failure("expected a body model, found a motion");
    }
    const auto take = [this](const char* name, RowMatrix& target,
                             std::vector<std::optional<std::size_t>> shape) -> Result<void> {
      TRY_ASSIGN(target, read_matrix(name, std::move(shape)));
      return {};
    };
    constexpr std::nullopt_t any = std::nullopt;
    TRY(take("v_template", vertices_, {any, 3}));
    const auto vertex_count = static_cast<std::size_t>(vertices_.rows());
    TRY(take("J_regressor", regressor_, {any, vertex_count}));
    const auto joint_count = static_cast<std::size_t>(regressor_.rows());
    TRY(take("kintree_table", tree_, {2, joint_count}));
    TRY(check_joints());
    TRY(take("shapedirs", directions_, {vertex_count, 3, any}));
    beta_count_ = directions_.cols() / 3;
    return {};
  }

  Result<void> check_joints() {
    bool smpl = tree_.cols() >= kSmplJointCount;
    for (int joint = 1; smpl && joint < kSmplJointCount; ++joint) {
      smpl = tree_(0, joint) == kSmplParents[joint];
    }
    if (smpl) return {};
    return file_.array_failure(
        "kintree_table",
        fmt::format("its joints do not match SMPL, SMPL+H or SMPL-X (expected at least 22, found "
                    "{})",
                    tree_.cols()),
        "hand, head and animal models (MANO, FLAME, ...) are not supported");
  }

  Result<void> find_landmarks() {
    constexpr double kLowestBody = 0.3;
    constexpr double kHighestBody = 3.0;
    const double lowest = vertices_.col(1).minCoeff();
    const double height = vertices_.col(1).maxCoeff() - lowest;
    if (height < kLowestBody || height > kHighestBody) {
      return file_.array_failure("v_template", "a body that is " + std::to_string(height) +
                                                   " high along y is not in metres");
    }
    // Toes extend forward, but so may the belly; penalise height to select the toes.
    constexpr double kCostOfHeight = 4.0;
    const auto up = [](const Eigen::Vector3d& v) { return v.y(); };
    const auto forward = [&](const Eigen::Vector3d& v) {
      return v.z() - kCostOfHeight * (v.y() - lowest);
    };
    landmarks_[kHeadTop] = best_vertex(vertices_, 0, up);
    landmarks_[kLeftToes] = best_vertex(vertices_, 1, forward);
    landmarks_[kRightToes] = best_vertex(vertices_, -1, forward);
    landmarks_[kLeftFingers] =
        best_vertex(vertices_, 1, [](const Eigen::Vector3d& v) { return v.x(); });
    landmarks_[kRightFingers] =
        best_vertex(vertices_, -1, [](const Eigen::Vector3d& v) { return -v.x(); });
    landmarks_[kSole] = best_vertex(vertices_, 0, [](const Eigen::Vector3d& v) { return -v.y(); });
    if (std::ranges::find(landmarks_, -1) != landmarks_.end()) {
      return file_.array_failure("v_template", "the body lies entirely on one side of x = 0");
    }
    return {};
  }

  // NumPy stores a sparse SciPy matrix as an object; give a specific hint for it.
  Result<NpyArray> read_array(const char* name) const {
    Result<NpyArray> array = file_.read(name);
    if (array) return array;
    const Result<std::string> type = file_.has(name) ? file_.type_of(name) : std::string();
    if (type && type->find('O') != std::string::npos) {
      return file_.array_failure(
          name,
          "it contains Python objects (perhaps a sparse matrix), which would require unpickling",
          std::string(kSaveHint));
    }
    return array;
  }

  // Rows are the first index, columns all others. An empty element of `shape` means any size above
  // 0.
  Result<RowMatrix> read_matrix(const char* name, std::vector<std::optional<std::size_t>> shape) {
    TRY_ASSIGN(const auto array, read_array(name));
    bool fits = array.is_number() && array.shape.size() == shape.size();
    for (std::size_t i = 0; fits && i < shape.size(); ++i) {
      fits = array.shape[i] > 0 && array.shape[i] == shape[i].value_or(array.shape[i]);
    }
    if (!fits) {
      std::vector<std::string> wanted;
      wanted.reserve(shape.size());
      for (const auto& size : shape) wanted.push_back(size ? std::to_string(*size) : "any");
      return file_.array_failure(
          name, fmt::format("expected numbers of shape ({}), found {}{}", fmt::join(wanted, ", "),
                            array.is_text() ? "text of " : "", shape_text(array.shape)));
    }
    const std::vector<double> values = array.numbers();
    const auto bad = std::ranges::find_if(values, [](double v) { return !std::isfinite(v); });
    if (bad != values.end()) return file_.array_failure(name, "a number is not finite");
    const Eigen::Index rows = static_cast<Eigen::Index>(array.shape.front());
    return RowMatrix(Eigen::Map<const RowMatrix>(values.data(), rows,
                                                 static_cast<Eigen::Index>(values.size()) / rows));
  }

  void add_vertex(SmplBody& body, int point, double weight, Eigen::Index vertex) const {
    if (weight == 0.0) return;
    body.points.segment<3>(3 * point) += weight * vertices_.row(vertex).transpose();
    for (int axis = 0; axis < 3; ++axis) {
      body.shape_directions.row(3 * point + axis) +=
          weight * directions_.block(vertex, axis * (directions_.cols() / 3), 1, beta_count_);
    }
  }

  const NpzFile& file_;
  RowMatrix vertices_;    // V x 3
  RowMatrix directions_;  // V x 3B: for each coordinate all betas.
  RowMatrix regressor_;   // J x V
  RowMatrix tree_;        // 2 x J
  Eigen::Index beta_count_ = 0;
  std::array<Eigen::Index, kSmplTipCount + 1> landmarks_{};
};

}  // namespace

Result<SmplBody> read_smpl_body(std::string_view bytes, const std::string& file_name) {
  try {
    NpzReadOptions options;
    options.error_kind = ErrorKind::kConfig;
    Result<NpzFile> file = NpzFile::open(bytes, file_name, options);
    if (!file) {
      Error error = std::move(file.error());
      // Not an archive, so most likely one of the pickles in which SMPL is distributed.
      if (!bytes.starts_with("PK")) error.hint = kSaveHint;
      return failure(std::move(error));
    }
    return BodyReader(*file).read(file_name);
  } catch (const std::bad_alloc&) {
    return run_failure(file_name, "not enough memory for this body model");
  }
}

Result<SmplBody> load_smpl_body(const std::string& path) {
  TRY_ASSIGN(const auto bytes, read_file(path, ErrorKind::kConfig, kMaxFileBytes));
  return read_smpl_body(bytes.view(), path);
}

SmplRestBody smpl_rest_body(const SmplBody& body, std::span<const double> betas) {
  const auto used =
      std::min<Eigen::Index>(body.shape_directions.cols(), static_cast<Eigen::Index>(betas.size()));
  const Eigen::VectorXd points =
      body.points +
      body.shape_directions.leftCols(used) * Eigen::Map<const Eigen::VectorXd>(betas.data(), used);
  SmplRestBody rest;
  for (int i = 0; i < kSmplJointCount; ++i) rest.joints[i] = points.segment<3>(3 * i);
  for (int i = 0; i < kSmplTipCount; ++i) {
    rest.tips[i] = points.segment<3>(3 * (kSmplJointCount + i));
  }
  for (Eigen::Index i = 3 * kPointCount; i < points.size(); i += 3) {
    rest.hands.emplace_back(points.segment<3>(i));
  }
  const Eigen::Vector3d sole = points.segment<3>(3 * (kSmplJointCount + kSole));
  rest.height = rest.tips[kHeadTop].y() - sole.y();
  return rest;
}

}  // namespace retarget

// Motions in a single array of NumPy: Motion-X, PHUMA; and what other arrays are.

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/npy_stream.h"
#include "base/npz_writer.h"
#include "base/number_text.h"
#include "base/try.h"
#include "smpl/motion_file.h"

namespace retarget {
namespace {

// where a kind of array has its columns; its rotations are those of AMASS's SMPL-X files
struct Columns {
  std::size_t width;
  std::size_t root_orient, pose_body, trans;
  std::size_t betas, beta_count;  // none: 0 of them
};

constexpr std::size_t kMotionXWidth = 322;
constexpr Columns kMotionX = {kMotionXWidth, 0, 3, 309, 312, 10};
constexpr Columns kPhuma = {69, 3, 6, 0, 0, 0};
constexpr std::size_t kBodyWidth = 63, kHandWidth = 90;
constexpr std::size_t kHumanMlFeatures = 263;

Failure at_file(Error error, const std::string& file_name) {
  error.kind = ErrorKind::kInput;
  error.location.file = file_name;
  return failure(std::move(error));
}

// the header of an array; what follows it is left
Result<NpyHeader> take_header(std::string_view& bytes) {
  return read_npy_header([&bytes](std::size_t size) -> Result<std::string> {
    if (size > bytes.size()) {
      return format_failure("the array is cut off within its header",
                            "the file was cut off: download or copy it again");
    }
    std::string taken(bytes.substr(0, size));
    bytes.remove_prefix(size);
    return taken;
  });
}

// the array that is the rest of the file
Result<NpyArray> read_array(const NpyHeader& header, std::string_view bytes,
                            std::size_t max_number_bytes) {
  TRY_ASSIGN(auto layout, npy_layout(header));
  if (layout.data_size != bytes.size()) {
    return format_failure(
        fmt::format("its shape {} of {} needs {}, found {}", shape_text(header.shape), header.type,
                    count_text(layout.data_size, "byte"), bytes.size()),
        "the file was cut off: download or copy it again");
  }
  if (layout.data_size / layout.array.item_size > max_number_bytes / sizeof(double)) {
    return format_failure(
        fmt::format("its shape {} needs more memory than is allowed", shape_text(header.shape)),
        "split the motion");
  }
  return npy_with_data(std::move(layout), std::string(bytes), header.fortran_order);
}

NpyArray columns_of(const std::vector<double>& values, std::size_t width, std::size_t first,
                    std::size_t count) {
  const std::size_t rows = values.size() / width;
  std::vector<double> taken;
  taken.reserve(rows * count);
  for (std::size_t row = 0; row < rows; ++row) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(row * width + first);
    taken.insert(taken.end(), begin, begin + static_cast<std::ptrdiff_t>(count));
  }
  return float64_array(taken, {rows, count});
}

MotionKind kind_of_columns(const Columns& columns) {
  const bool motion_x = columns.width == kMotionXWidth;
  MotionKind kind;
  kind.fps = 30.0;
  kind.fps_reason = fmt::format("the file states no frame rate: 30 fps, as {} has, are assumed",
                                motion_x ? "Motion-X" : "PHUMA");
  kind.gender = "neutral";
  kind.has_no_betas = columns.beta_count == 0;
  kind.family = SmplFamily::kSmplx;
  kind.y_is_up = !motion_x;
  return kind;
}

Failure no_motion(const NpyArray& array, const std::string& file_name) {
  const std::string found =
      "expected a motion of SMPL, found an array of shape " + shape_text(array.shape) + ": ";
  if (array.shape.size() == 2 && array.shape[1] == kHumanMlFeatures) {
    return input_failure(file_name, found + "HumanML3D's features are not read",
                         "give the places of joints that they were made of, or are turned back "
                         "into by recover_from_ric: new_joints, (frames, 22, 3)");
  }
  return input_failure(file_name,
                       found +
                           "Motion-X has 322 columns, PHUMA 69, and places of joints are "
                           "(frames, joints, 3)",
                       "put the arrays of a motion into one file with numpy.savez");
}

}  // namespace

Result<MotionFile> open_array_motion(std::string_view bytes, const std::string& file_name,
                                     const OpenOptions& options) {
  const Result<NpyHeader> header = take_header(bytes);
  if (!header) return at_file(header.error(), file_name);
  // what numpy.save makes of a dictionary, as MDM saves its results
  if (header->type.ends_with('O')) return open_pickled_motion(bytes, file_name, options);
  const Result<NpyArray> array = read_array(*header, bytes, options.max_number_bytes);
  if (!array) return at_file(array.error(), file_name);
  const std::size_t dimensions = array->shape.size();
  const bool may_be_places = dimensions == 3 || dimensions == 4;
  if (array->is_number() && (may_be_places || (dimensions == 2 && options.has_names))) {
    auto places = std::make_unique<MadeArrays>(file_name);
    places->add("positions", *array);
    return MotionFile{std::move(places), {}, {}, MotionContent::kJoints};
  }
  const bool is_table = array->is_number() && dimensions == 2;
  const Columns* columns = nullptr;
  for (const Columns* known : {&kMotionX, &kPhuma}) {
    if (is_table && array->shape[1] == known->width) columns = known;
  }
  if (columns == nullptr) return no_motion(*array, file_name);

  const std::vector<double> values = array->numbers();
  auto arrays = std::make_unique<MadeArrays>(file_name);
  const auto add = [&](const char* name, std::size_t first, std::size_t count) {
    arrays->add(name, columns_of(values, columns->width, first, count));
  };
  add("root_orient", columns->root_orient, 3);
  add("pose_body", columns->pose_body, kBodyWidth);
  // Motion-X has the hands next
  if (columns == &kMotionX) add("pose_hand", columns->pose_body + kBodyWidth, kHandWidth);
  add("trans", columns->trans, 3);
  if (columns->beta_count > 0) add("betas", columns->betas, columns->beta_count);
  MotionFile file{std::move(arrays), kind_of_columns(*columns), {}};
  if (columns == &kMotionX) {
    file.warnings.push_back(
        {0, 0,
         "a clip of Motion-X may stand in the axes of its own camera: look whether up is right"});
  }
  return file;
}

}  // namespace retarget

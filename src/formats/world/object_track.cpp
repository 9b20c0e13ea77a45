// Tracks of objects: NPZ, NPY, CSV and InterMimic's tensors.

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "base/faults.h"
#include "base/try.h"
#include "formats/containers/file_kind.h"
#include "formats/containers/npy.h"
#include "formats/containers/npz.h"
#include "formats/containers/torch_file.h"
#include "formats/smpl/motion_arrays.h"
#include "retarget/csv_table.h"
#include "retarget/file.h"
#include "retarget/scene.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Poses = std::vector<Pose>;

constexpr std::size_t kMaxBytes = std::size_t{1} << 30U;
constexpr double kMaxPlace = 1e5;  // Metres.

/// Indices of x, y, z, qw, qx, qy, qz in seven numbers.
using Order = std::array<std::size_t, 7>;
constexpr Order kScalarFirst = {0, 1, 2, 3, 4, 5, 6};
constexpr Order kScalarLast = {0, 1, 2, 6, 3, 4, 5};

// Reads poses from a table with one row per frame, which starts at its first column.
Result<Poses> poses_of(const std::vector<double>& values, std::size_t width, const Order& order) {
  Poses poses;
  if (values.empty()) return input_failure("", "the track has no frames");
  poses.reserve(values.size() / width);
  for (std::size_t at = 0; at + width <= values.size(); at += width) {
    const auto value = [&](std::size_t which) { return values[at + order[which]]; };
    const Eigen::Vector3d position(value(0), value(1), value(2));
    // Negated comparisons also reject NaN.
    if (!(position.cwiseAbs().maxCoeff() <= kMaxPlace)) {
      return input_failure(
          "", fmt::format("frame {}: the position is not plausible in metres", poses.size()));
    }
    const Eigen::Quaterniond rotation(value(3), value(4), value(5), value(6));
    constexpr double kMinNorm = 1e-6, kMaxNorm = 1e6;
    const double norm = rotation.norm();
    if (!(norm >= kMinNorm && norm <= kMaxNorm)) {
      return input_failure("", fmt::format("frame {}: the quaternion is {}", poses.size(),
                                           norm < kMinNorm ? "zero" : "not a rotation"));
    }
    poses.push_back({rotation.normalized(), position});
  }
  return poses;
}

// Rows of one object of an array (frames, objects, width).
std::vector<double> rows_of_object(const NpyArray& array, std::size_t object) {
  const std::vector<double> all = array.numbers();
  const std::size_t width = array.shape[2];
  std::vector<double> rows;
  for (std::size_t row = object * width; row < all.size(); row += array.shape[1] * width) {
    rows.insert(rows.end(), all.begin() + static_cast<std::ptrdiff_t>(row),
                all.begin() + static_cast<std::ptrdiff_t>(row + width));
  }
  return rows;
}

// The array under the first of these names that the file has. Errors: a wrong shape.
// @param object  index, in files with several objects (object_names).
Result<std::optional<std::vector<double>>> find_table(const NpzFile& file,
                                                      std::span<const std::string_view> names,
                                                      std::size_t width, std::size_t object) {
  for (const std::string_view name : names) {
    if (!file.has(name)) continue;
    TRY_ASSIGN(const NpyArray array, file.read(name));
    if (array.is_number() && array.shape.size() == 3 && array.shape[1] > object &&
        array.shape[2] == width) {
      return rows_of_object(array, object);
    }
    if (!array.is_number() || array.shape.size() != 2 || array.shape[1] != width) {
      return file.array_failure(name, fmt::format("expected the shape (frames, {}), found {}",
                                                  width, shape_text(array.shape)));
    }
    return array.numbers();
  }
  return std::optional<std::vector<double>>();
}

Result<std::optional<FrameRate>> rate_of(const NpzFile& file) {
  if (!file.has("fps")) return std::optional<FrameRate>();
  TRY_ASSIGN(const NpyArray array, file.read("fps"));
  const double fps = array.is_number() && array.element_count() == 1 ? array.numbers()[0] : 0.0;
  constexpr double kMaxFps = 1e5;
  if (!(fps > 0.0 && fps <= kMaxFps)) {
    return file.array_failure("fps", "expected a positive number of frames per second");
  }
  return std::optional(frame_rate_from_fps(fps));
}

// Index of an object in a robot motion file, which may have several.
// @param body  name; empty: the only one.
Result<std::size_t> object_of(const NpzFile& file, const std::string& body) {
  if (!file.has("object_names")) return std::size_t{0};
  TRY_ASSIGN(const NpyArray array, file.read("object_names"));
  if (!array.is_text()) return file.array_failure("object_names", "expected names");
  const std::vector<std::string> names = array.texts();
  if (names.size() == 1) return std::size_t{0};
  const auto found = std::ranges::find(names, body);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  return file.file_failure(
      (body.empty() ? "the file has several objects" : "the file has no object \"" + body + "\"") +
          std::string(": ") + list_names(names, 12),
      "give BODY=FILE with the name of one of them");
}

// Reads the contacts of a track: `contacts` (frames, parts) and `contact_parts`. Parts that are not
// listed do not touch.
Result<std::vector<StatedContact>> contacts_of(const NpzFile& file, std::size_t frames) {
  std::vector<StatedContact> contacts;
  if (!file.has("contacts") || !file.has("contact_parts")) return contacts;
  TRY_ASSIGN(const NpyArray names, file.read("contact_parts"));
  TRY_ASSIGN(const NpyArray array, file.read("contacts"));
  const std::vector<std::string> parts =
      names.is_text() ? names.texts() : std::vector<std::string>();
  if (!array.is_number() || array.shape.size() != 2 || array.shape[0] != frames ||
      array.shape[1] != parts.size()) {
    return file.array_failure(
        "contacts", fmt::format("expected the shape ({}, {}): one column for each name of "
                                "\"contact_parts\"; found {}",
                                frames, parts.size(), shape_text(array.shape)));
  }
  const std::vector<double> labels = array.numbers();
  for (const std::string_view name : kSupportNames) {
    StatedContact& stated = contacts.emplace_back();
    stated.part = name;
    stated.touches.assign(frames, 0);
  }
  for (std::size_t column = 0; column < parts.size(); ++column) {
    const auto known = std::ranges::find(contacts, parts[column], &StatedContact::part);
    if (known == contacts.end()) {
      return file.array_failure(
          "contact_parts", fmt::format("unknown part \"{}\": parts are {}",
                                       printable(parts[column]), fmt::join(kSupportNames, ", ")));
    }
    for (std::size_t frame = 0; frame < frames; ++frame) {
      if (labels[frame * parts.size() + column] > 0.5) known->touches[frame] = 1;
    }
  }
  return contacts;
}

Result<ObjectTrack> read_npz_track(std::string_view bytes, const std::string& file_name,
                                   const std::string& body) {
  constexpr std::array<std::string_view, 5> kPositions = {"position", "pos", "obj_pos",
                                                          "object_pos_w", "trans"};
  constexpr std::array<std::string_view, 4> kQuaternions = {"quaternion", "quat", "obj_quat",
                                                            "object_quat_w"};
  constexpr std::array<std::string_view, 1> kPoses = {"pose"};
  TRY_ASSIGN(const NpzFile file, NpzFile::open(bytes, file_name));
  ObjectTrack track;
  TRY_ASSIGN(track.rate, rate_of(file));
  TRY_ASSIGN(const std::size_t object, object_of(file, body));
  TRY_ASSIGN(auto table, find_table(file, kPoses, 7, object));
  if (!table) {
    TRY_ASSIGN(const auto positions, find_table(file, kPositions, 3, object));
    TRY_ASSIGN(const auto quaternions, find_table(file, kQuaternions, 4, object));
    if (!positions || !quaternions) {
      return file.file_failure(fmt::format("the file has no track of an object: its arrays are {}",
                                           list_names(file.names(), 12)),
                               "a track has the arrays \"position\" (frames, 3) and \"quaternion\" "
                               "(frames, 4; w first), "
                               "or \"pose\" (frames, 7)");
    }
    const std::size_t frames = positions->size() / 3;
    if (quaternions->size() / 4 != frames) {
      return file.file_failure(fmt::format("the file has {} but {}", count_text(frames, "position"),
                                           count_text(quaternions->size() / 4, "quaternion")));
    }
    table.emplace();
    for (std::size_t i = 0; i < frames; ++i) {
      table->insert(table->end(), positions->begin() + 3 * i, positions->begin() + 3 * i + 3);
      table->insert(table->end(), quaternions->begin() + 4 * i, quaternions->begin() + 4 * i + 4);
    }
  }
  TRY_ASSIGN(track.world_from_body, poses_of(*table, 7, kScalarFirst));
  TRY_ASSIGN(track.contacts, contacts_of(file, track.world_from_body.size()));
  return track;
}

Result<ObjectTrack> read_npy_track(std::string_view bytes) {
  TRY_ASSIGN(const NpyHeader header, take_npy_header(bytes));
  TRY_ASSIGN(const NpyArray array, read_npy_rest(header, bytes, kMaxBytes));
  if (!array.is_number() || array.shape.size() != 2 || array.shape[1] != 7) {
    return input_failure(
        "", "expected the shape (frames, 7): x y z qw qx qy qz; found " + shape_text(array.shape));
  }
  ObjectTrack track;
  TRY_ASSIGN(track.world_from_body, poses_of(array.numbers(), 7, kScalarFirst));
  return track;
}

// Finds the columns by their names, or uses the usual order if there are no names.
Result<Order> order_of(const std::vector<std::string>& names) {
  constexpr std::array<std::string_view, 7> kNames = {"x", "y", "z", "qw", "qx", "qy", "qz"};
  if (names.empty()) return kScalarFirst;
  Order order{};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const auto found = std::ranges::find_if(
        names, [&](const std::string& name) { return lower_case(name) == kNames[i]; });
    if (found == names.end()) {
      return input_failure(
          "",
          fmt::format("no column is named \"{}\": the columns are {}", kNames[i],
                      list_names(names, 12)),
          "name the columns x, y, z, qw, qx, qy, qz in any order, or leave out the "
          "header");
    }
    order[i] = static_cast<std::size_t>(found - names.begin());
  }
  return order;
}

Result<ObjectTrack> read_csv_track(std::string_view bytes, const std::string& file) {
  TRY_ASSIGN(const CsvTable table, read_csv_table(bytes, file));
  TRY_ASSIGN(const Order order, order_of(table.header));
  if (table.header.empty() && table.columns != 7) {
    return input_failure(
        file, fmt::format("expected 7 columns (x y z qw qx qy qz), found {}", table.columns));
  }
  ObjectTrack track;
  TRY_ASSIGN(track.world_from_body, poses_of(table.values, table.columns, order));
  return track;
}

// The bodies of a part in the order of InterMimic's model: [first, last].
struct LabelledPart {
  std::string_view part;
  std::size_t first, last;
};

// The labels state which of the 52 bodies of SMPL-X touches the object; a hand consists of its
// wrist and fingers. Files without any contact do not have labels.
std::vector<StatedContact> intermimic_contacts(const std::vector<double>& table) {
  constexpr std::size_t kFirstLabel = 331;
  constexpr std::array<LabelledPart, 8> kParts = {{{"left_knee", 2, 2},
                                                   {"right_knee", 6, 6},
                                                   {"left_elbow", 16, 16},
                                                   {"right_elbow", 35, 35},
                                                   {"left_hand", 17, 32},
                                                   {"right_hand", 36, 51},
                                                   {"seat", 0, 0},
                                                   {"back", 9, 11}}};
  std::vector<StatedContact> contacts;
  bool any = false;
  for (const LabelledPart& part : kParts) {
    StatedContact& stated = contacts.emplace_back();
    stated.part = part.part;
    for (std::size_t row = 0; row < table.size(); row += kInterMimicColumns) {
      const auto labels =
          std::span(table).subspan(row + kFirstLabel + part.first, part.last - part.first + 1);
      const bool touches = std::ranges::any_of(labels, [](double label) { return label > 0.5; });
      stated.touches.push_back(touches ? 1 : 0);
      any = any || touches;
    }
  }
  if (!any) contacts.clear();
  return contacts;
}

Result<ObjectTrack> read_intermimic_track(std::string_view bytes, const std::string& file) {
  // Position of the object and its quaternion, x first (docs/smpl.md).
  constexpr std::size_t kFirst = 318;
  TRY_ASSIGN(const TorchFile torch, TorchFile::open(bytes, file, {.max_number_bytes = kMaxBytes}));
  const PickleNode& root = torch.document().root();
  const bool is_tensor = root.kind == PickleNode::Kind::kTensor;
  if (!is_tensor || torch.document().tensor(root).shape.size() != 2 ||
      torch.document().tensor(root).shape[1] != kInterMimicColumns) {
    return input_failure(file, fmt::format("the file is not a tensor of InterMimic: expected the "
                                           "shape (frames, {})",
                                           kInterMimicColumns));
  }
  TRY_ASSIGN(const NpyArray table, torch.read(root, "data"));
  Order order = kScalarLast;
  for (std::size_t& column : order) column += kFirst;
  ObjectTrack track;
  const std::vector<double> numbers = table.numbers();
  TRY_ASSIGN(track.world_from_body, poses_of(numbers, kInterMimicColumns, order));
  track.contacts = intermimic_contacts(numbers);
  track.rate = FrameRate{30, 1};
  return track;
}

Result<ObjectTrack> read_track(const std::string& file, const std::string& body) {
  TRY_ASSIGN(const auto content, read_file(file, ErrorKind::kInput, kMaxBytes));
  const std::string_view bytes = content.view();
  const FileType type = file_type(bytes);
  switch (type.kind) {
    case FileKind::kNpz:
      return read_npz_track(bytes, file, body);
    case FileKind::kNpy:
      return read_npy_track(bytes);
    case FileKind::kTorch:
      return read_intermimic_track(bytes, file);
    case FileKind::kOther:
      return read_csv_track(bytes, file);
    default:
      return input_failure(file, "found " + std::string(type.what) + ": expected a track",
                           "tracks are NPZ, NPY, CSV, or tensors of InterMimic (.pt)");
  }
}

}  // namespace

std::string object_track_file(const std::string& spec) {
  const std::size_t equals = spec.find('=');
  return equals == spec.npos || is_file(spec) ? spec : spec.substr(equals + 1);
}

Result<ObjectTrack> load_object_track(const std::string& spec) {
  const std::string file = object_track_file(spec);
  const bool has_body = file.size() < spec.size();
  const std::string body = has_body ? spec.substr(0, spec.size() - file.size() - 1) : std::string();
  if (has_body && (body.empty() || file.empty())) {
    return input_failure("", "a track must be FILE or BODY=FILE, found \"" + spec + "\"");
  }
  auto track = read_track(file, body);
  if (!track) track.error().kind = ErrorKind::kInput;
  if (track) track->body = body;
  return located(std::move(track), file);
}

}  // namespace retarget

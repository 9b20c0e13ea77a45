// SONIC's reference motions: a folder of CSVs with headers, columns in Isaac Lab's order.

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/robot_motion/motion_writers.h"
#include "formats/robot_motion/raw_motion.h"
#include "formats/robot_motion/trainer_arrays.h"
#include "retarget/clip.h"
#include "retarget/file.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/robot.h"
#include "retarget/text.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Bodies tracked by SONIC's policies for the G1. For other robots all bodies are written.
constexpr std::array<std::string_view, 14> kTrackedOfG1 = {"pelvis",
                                                           "left_hip_roll_link",
                                                           "left_knee_link",
                                                           "left_ankle_roll_link",
                                                           "right_hip_roll_link",
                                                           "right_knee_link",
                                                           "right_ankle_roll_link",
                                                           "torso_link",
                                                           "left_shoulder_roll_link",
                                                           "left_elbow_link",
                                                           "left_wrist_yaw_link",
                                                           "right_shoulder_roll_link",
                                                           "right_elbow_link",
                                                           "right_wrist_yaw_link"};

constexpr FrameRate kSonicRate{50, 1};

// The files with one row per frame, and how they name their columns: NAME_0, NAME_1, ... for
// joints, body_0NAME_x, ... for bodies.
struct SonicFile {
  const char* name;
  std::string_view columns, axes;  // No axes: joints.
  std::vector<double> TrackingMotion::*values;
};
constexpr SonicFile kSonicFiles[] = {
    {"joint_pos.csv", "joint", "", &TrackingMotion::joint_pos},
    {"joint_vel.csv", "joint_vel", "", &TrackingMotion::joint_vel},
    {"body_pos.csv", "", "xyz", &TrackingMotion::body_pos},
    {"body_quat.csv", "", "wxyz", &TrackingMotion::body_quat},
    {"body_lin_vel.csv", "_vel", "xyz", &TrackingMotion::body_lin_vel},
    {"body_ang_vel.csv", "_angvel", "xyz", &TrackingMotion::body_ang_vel}};
constexpr const char* kMetadata = "metadata.txt";
constexpr const char* kContacts = "contacts.csv";

std::vector<std::size_t> tracked_bodies_of(const TrackingMotion& motion) {
  std::vector<std::size_t> tracked;
  for (const std::string_view name : kTrackedOfG1) {
    const auto found = std::ranges::find(motion.body_names, name);
    if (found == motion.body_names.end()) break;
    tracked.push_back(static_cast<std::size_t>(found - motion.body_names.begin()));
  }
  if (tracked.size() == kTrackedOfG1.size()) return tracked;
  tracked.clear();
  for (std::size_t b = 0; b < motion.body_names.size(); ++b) tracked.push_back(b);
  return tracked;
}

// Formats selected columns of an array; each column has `width` numbers.
std::string csv_of(const std::vector<double>& values, std::size_t frames, std::size_t columns,
                   const std::vector<std::size_t>& chosen, std::size_t width,
                   const std::vector<std::string>& header) {
  std::string text = fmt::format("{}\n", fmt::join(header, ","));
  for (std::size_t frame = 0; frame < frames; ++frame) {
    std::string_view comma;
    for (const std::size_t column : chosen) {
      for (std::size_t i = 0; i < width; ++i) {
        const double value = values[(frame * columns + column) * width + i];
        // Adding 0.0 removes negative zeros.
        text += fmt::format("{}{:.9f}", comma, value + 0.0);
        comma = ",";
      }
    }
    text += '\n';
  }
  return text;
}

std::vector<std::string> header_of(const SonicFile& file, std::size_t count) {
  std::vector<std::string> header;
  for (std::size_t i = 0; i < count; ++i) {
    if (file.axes.empty()) header.push_back(fmt::format("{}_{}", file.columns, i));
    for (const char axis : file.axes) {
      header.push_back(fmt::format("body_{}{}_{}", i, file.columns, axis));
    }
  }
  return header;
}

std::string metadata_of(const TrackingMotion& motion, const std::vector<std::size_t>& bodies,
                        const std::string& name) {
  return fmt::format(
      "Metadata for: {}\n==============================\n\nBody part indexes:\n[ {}]\n\n"
      "Total timesteps: {}\n",
      name.empty() ? "motion" : name, fmt::join(bodies, " "), motion.frames);
}

// A CSV with rows of equal length, usually below a header line.
struct NumberTable {
  std::size_t rows = 0, columns = 0;
  std::vector<double> values;
};

// SONIC's reader skips the first line of each file, but some files begin with numbers.
bool is_sonic_header(std::string_view line) {
  return !parse_number<double>(line.substr(0, line.find(',')));
}

Result<NumberTable> read_table(const std::string& path, std::size_t max_bytes) {
  TRY_ASSIGN(const auto content, read_file(path, ErrorKind::kInput, max_bytes));
  NumberTable table;
  std::string_view text = content.view();
  std::size_t line_number = 0;
  while (!text.empty()) {
    std::string_view line = take_until(text, '\n');
    if (line.ends_with('\r')) line.remove_suffix(1);
    ++line_number;
    if (line.empty() || (line_number == 1 && is_sonic_header(line))) continue;
    std::size_t count = 0;
    for (std::size_t begin = 0; begin <= line.size(); ++count) {
      const std::size_t end = std::min(line.find(',', begin), line.size());
      const auto number = parse_number<double>(line.substr(begin, end - begin));
      if (!number) {
        return failure({ErrorKind::kInput,
                        {path, line_number, 0},
                        fmt::format("column {} is not a number", count + 1),
                        {},
                        {}});
      }
      table.values.push_back(*number);
      begin = end + 1;
    }
    if (table.rows == 0) table.columns = count;
    if (count != table.columns) {
      return failure({ErrorKind::kInput,
                      {path, line_number, 0},
                      fmt::format("expected {} numbers, found {}", table.columns, count),
                      {},
                      {}});
    }
    ++table.rows;
  }
  return table;
}

// The robot, or its variant that has this number of joints: the order of the columns is its own.
Result<std::shared_ptr<const Robot>> robot_of_folder(const std::shared_ptr<const Robot>& robot,
                                                     std::size_t joints, const RawMotion& raw,
                                                     const std::string& path,
                                                     const std::string& variant) {
  TRY_ASSIGN(const auto found, joints_by_count(*robot, joints, raw, path, variant));
  if (found == robot->output_joints()) return robot;
  return robot_variant(robot, variants_by_count(*robot, joints, raw.format, variant).front());
}

// Indices into the layout of the bodies in the files: those of the metadata, otherwise all bodies
// or the tracked ones, by their number. Empty: unknown.
std::vector<std::size_t> bodies_of_folder(const std::string& path, const Robot& robot,
                                          const TrackingLayout& layout, std::size_t count) {
  std::vector<std::size_t> indices;
  constexpr std::size_t kMaxMetadata = std::size_t{1} << 20U;
  const auto content =
      read_file((fs::path(path) / kMetadata).string(), ErrorKind::kInput, kMaxMetadata);
  if (content) {
    std::string_view text = content->view();
    text.remove_prefix(std::min(text.find('['), text.size()));
    text = text.substr(0, text.find(']'));
    while (!text.empty()) {
      text.remove_prefix(std::min(text.find_first_of("0123456789"), text.size()));
      const std::size_t end = std::min(text.find_first_not_of("0123456789"), text.size());
      if (const auto index = parse_number<std::size_t>(text.substr(0, end))) {
        indices.push_back(*index);
      }
      text.remove_prefix(end);
    }
  }
  if (indices.empty()) {
    TrackingMotion names;
    for (const int body : layout.bodies) names.body_names.push_back(robot.bodies()[body].name);
    indices = tracked_bodies_of(names);
  }
  const bool fits = indices.size() == count && std::ranges::all_of(indices, [&](std::size_t i) {
                      return i < layout.bodies.size();
                    });
  return fits ? indices : std::vector<std::size_t>();
}

}  // namespace

MotionFiles write_sonic_folder(const RobotClip& clip, MotionFormat format,
                               const WriteMotionOptions& options) {
  TRY_ASSIGN(const auto motion, tracking_with_contacts(clip, format, options, options.tracking));
  const std::vector<std::size_t> tracked = tracked_bodies_of(motion);
  std::vector<FormattedFile> files;
  for (const SonicFile& file : kSonicFiles) {
    const std::vector<double>& values = motion.*file.values;
    if (file.axes.empty()) {
      const std::size_t joints = motion.joint_names.size();
      files.push_back(
          {file.name, csv_of(values, motion.frames, 1, {0}, joints, header_of(file, joints))});
    } else {
      files.push_back({file.name, csv_of(values, motion.frames, motion.body_names.size(), tracked,
                                         file.axes.size(), header_of(file, tracked.size()))});
    }
  }
  files.push_back({kMetadata, metadata_of(motion, tracked, options.name)});
  if (motion.contacts) {
    files.push_back({kContacts, format_contacts_csv(*motion.contacts, motion.rate)});
  }
  return files;
}

std::vector<std::string> sonic_losses(const RobotClip& /*motion*/, const FrameRate& rate) {
  if (same_rate(rate, kSonicRate)) return {};
  return {"csv-sonic stores no rate: its readers assume 50 fps, this motion has " + to_text(rate) +
          "; " OPTION("npz-fps") " 50 writes the expected rate"};
}

std::vector<std::string> sonic_file_names() {
  std::vector<std::string> names;
  for (const SonicFile& file : kSonicFiles) names.emplace_back(file.name);
  names.insert(names.end(), {kMetadata, kContacts});
  return names;
}

bool is_sonic_folder(const std::string& path) {
  return is_file(fs::path(path) / "joint_pos.csv") && is_file(fs::path(path) / "body_quat.csv");
}

Result<RawMotion> read_sonic_folder(std::string_view /*bytes*/,
                                    const std::shared_ptr<const Robot>& robot,
                                    const std::string& path, const ReadMotionOptions& options) {
  const auto table = [&](const char* name) {
    return read_table((fs::path(path) / name).string(), options.max_bytes);
  };
  TRY_ASSIGN(auto joints, table("joint_pos.csv"));
  TRY_ASSIGN(auto places, table("body_pos.csv"));
  TRY_ASSIGN(const auto turns, table("body_quat.csv"));
  if (joints.rows == 0) return input_failure(path, "the motion has no frames");
  if (places.rows != joints.rows || turns.rows != joints.rows || places.columns < 3 ||
      turns.columns < 4) {
    return input_failure(path, "its files have different numbers of frames or bodies");
  }
  RawMotion raw;
  raw.format = MotionFormat::kCsvSonic;
  TRY_ASSIGN(const auto variant,
             robot_of_folder(robot, joints.columns, raw, path, options.variant));
  const TrackingLayout layout = tracking_layout(*variant, MotionFormat::kCsvSonic);
  raw.rate = kSonicRate;
  raw.order = raw.usual = QuaternionOrder::kWxyz;
  set_units_of_format(raw);
  raw.frames = joints.rows;
  raw.joint_count = joints.columns;
  raw.joint_indices = joints_among(*robot, *variant, layout.joints);
  raw.joints = std::move(joints.values);
  for (std::size_t frame = 0; frame < raw.frames; ++frame) {
    // The first body is the root.
    for (std::size_t i = 0; i < 3; ++i) {
      raw.position.push_back(places.values[frame * places.columns + i]);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      raw.rotation.push_back(turns.values[frame * turns.columns + i]);
    }
  }
  if (places.columns % 3 == 0) {
    std::size_t column = 0;
    for (const std::size_t i : bodies_of_folder(path, *variant, layout, places.columns / 3)) {
      const auto body = robot->find_body(variant->bodies()[layout.bodies[i]].name);
      if (body) raw.places.bodies.push_back({column, {*body, Eigen::Vector3d::Zero()}});
      ++column;
    }
    raw.places.positions = std::move(places.values);
  }
  if (is_file(fs::path(path) / kContacts)) {
    TRY_ASSIGN(const auto flags, table(kContacts));
    const std::size_t first = flags.columns - std::min(flags.columns, kContactNames.size());
    if (flags.rows == raw.frames && flags.columns >= kContactNames.size()) {
      raw.contacts.emplace();
      for (std::size_t i = 0; i < flags.values.size(); ++i) {
        if (i % flags.columns < first) continue;
        raw.contacts->planted.push_back(flags.values[i] > 0.5 ? 1 : 0);
      }
    }
  }
  return raw;
}

}  // namespace retarget

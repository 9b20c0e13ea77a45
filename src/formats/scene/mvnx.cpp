#include "formats/scene/read_scene.h"

#include <fmt/format.h>
#include <tinyxml2.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "base/parse_xml.h"
#include "base/try.h"
#include "formats/scene/clip_builder.h"
#include "motion/clip.h"
#include "retarget/bvh.h"
#include "retarget/statistics.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using tinyxml2::XMLElement;

constexpr std::size_t kMaxSegments = 1000;

std::string_view text_of(const XMLElement* element) {
  const char* text = element == nullptr ? nullptr : element->GetText();
  return text == nullptr ? std::string_view() : std::string_view(text);
}

// Parses finite numbers separated by blanks. Returns nothing for other text.
std::optional<std::vector<double>> numbers_of(std::string_view text) {
  std::vector<double> numbers;
  for (auto word = take_word(text); !word.empty(); word = take_word(text)) {
    const auto number = parse_number<double>(word);
    if (!number || !std::isfinite(*number) || std::abs(*number) > 1e9) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

// The part before the slash, such as `Pelvis` in `Pelvis/jL5S1`.
std::string segment_of(const XMLElement* connector) {
  const std::string_view text = text_of(connector);
  return std::string(text.substr(0, text.find('/')));
}

// A frame of an MVNX file as its attributes `time` and `index` place it.
struct MvnxStamp {
  std::optional<double> time;   // Milliseconds, rounded or truncated.
  std::optional<double> index;  // Number of the frame.
  std::size_t line = 0;
};

// Tolerance for the rounding of times to milliseconds.
constexpr double kRoundedMs = 1.01;
// Relative difference between a stated and a measured rate. MVN states 60 for 59.94.
constexpr double kSameMvnxRate = 0.01;

// The values of an attribute; empty if frames lack it or all are equal.
std::vector<double> values_of(const std::vector<MvnxStamp>& stamps,
                              std::optional<double> MvnxStamp::*attribute) {
  std::vector<double> values;
  for (const MvnxStamp& stamp : stamps) {
    if (!(stamp.*attribute)) return {};
    values.push_back(*(stamp.*attribute));
  }
  const bool is_constant =
      std::ranges::all_of(values, [&](double value) { return value == values.front(); });
  return is_constant ? std::vector<double>() : values;
}

// The first frame that does not follow the one before by the usual step; 0 if all do. A single
// late or early value changes two adjacent steps, which together are as long as usual.
std::size_t odd_frame(const std::vector<double>& values, double usual, double rounding) {
  const double allowed = std::max(0.51 * usual, rounding);
  const auto is_odd = [&](std::size_t from, std::size_t to) {
    const double expected = static_cast<double>(to - from) * usual;
    return std::abs(values[to] - values[from] - expected) > allowed;
  };
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] <= values[i - 1]) return i;
    if (!is_odd(i - 1, i)) continue;
    if (i > 1 && !is_odd(i - 2, i)) continue;
    if (i + 1 < values.size() && !is_odd(i - 1, i + 1)) continue;
    return i;
  }
  return 0;
}

double median_step(const std::vector<double>& values) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) steps.push_back(values[i] - values[i - 1]);
  return median_in_place(steps);
}

// Compares the stamps of frames with even frames. Times and indices count if all frames have them
// and they are not all equal.
// @param fps  stated rate, Hz; nothing: only the evenness is checked.
// @return empty without a contradiction.
std::optional<Warning> mvnx_clock_fault(const std::vector<MvnxStamp>& stamps,
                                        const std::optional<double>& fps) {
  const std::vector<double> times = values_of(stamps, &MvnxStamp::time);
  if (!times.empty()) {
    const double usual = median_step(times);
    if (const std::size_t frame = odd_frame(times, usual, kRoundedMs); frame > 0) {
      return Warning{
          stamps[frame].line, 0,
          fmt::format("the times are not uniform: frame {} comes {:g} ms after the frame before, "
                      "not {:g} ms as usual; frames may be missing",
                      frame, times[frame] - times[frame - 1], usual)};
    }
  }
  const std::vector<double> indices = values_of(stamps, &MvnxStamp::index);
  if (!indices.empty()) {
    const double usual = median_step(indices);
    if (const std::size_t frame = odd_frame(indices, usual, 0.0); frame > 0) {
      return Warning{
          stamps[frame].line, 0,
          fmt::format("the frame numbers are not uniform: frame {} has index {:g} after {:g}; "
                      "frames may be missing",
                      frame, indices[frame], indices[frame - 1])};
    }
  }
  if (times.empty() || !fps) return std::nullopt;
  const double length = times.back() - times.front();
  const double expected = 1000.0 * static_cast<double>(times.size() - 1) / *fps;
  if (std::abs(length - expected) <= 2.0 * kRoundedMs + kSameMvnxRate * expected) {
    return std::nullopt;
  }
  const double found = 1000.0 * static_cast<double>(times.size() - 1) / length;
  return Warning{
      0, 0,
      fmt::format("the file states {:g} fps, but the times of its frames increase by {:.4g} ms, "
                  "which is {:.4g} fps",
                  *fps, 1000.0 / found, found)};
}

class MvnxReader {
 public:
  MvnxReader(const std::string& file_name, const SceneReadOptions& options)
      : file_name_(file_name), options_(options) {}

  Result<Clip> read(std::string_view bytes) {
    tinyxml2::XMLDocument document;
    if (const auto parsed = parse_xml(bytes, document); !parsed) {
      const std::string& message = parsed.error().message;
      return fault(document.Error() ? "the XML is broken or cut off (" + message + ")" : message,
                   parsed.error().location.line);
    }
    const XMLElement* root = document.FirstChildElement("mvnx");
    TRY_ASSIGN(const XMLElement* subject, choose_subject(root));
    TRY(find_segments(*subject));
    TRY(order_segments());
    TRY(find_frames(*subject));
    return make_clip(*subject, bytes.size());
  }

 private:
  Failure fault(std::string what, std::size_t line = 0) const {
    Error error{ErrorKind::kInput, {file_name_, line, 0}, {}, {}, {}};
    error.hint = "the file may be cut off or damaged: export it again from MVN";
    error.message = "the MVNX file cannot be read: " + std::move(what);
    return failure(std::move(error));
  }

  // The subject that is requested by its label or its number from 1; without a request the first.
  Result<const XMLElement*> choose_subject(const XMLElement* root) {
    if (root == nullptr) return fault("it has no subject");
    const std::vector<const XMLElement*> subjects = children_of(*root, "subject");
    if (subjects.empty()) return fault("it has no subject");
    std::vector<std::string> labels, names;  // Names: labels, or numbers from 1 without them.
    for (const XMLElement* each : subjects) {
      labels.push_back(printable(attribute_of(each, "label")));
      names.push_back(labels.back().empty() ? std::to_string(labels.size()) : labels.back());
    }
    if (!options_.take.empty() && options_.take != "1") {
      return usage_failure("expected no take (" OPTION("take") "): \"" + file_name_ +
                               "\" is an MVNX file, which contains one",
                           OPTION("root") " NAME selects one of several subjects");
    }
    std::size_t chosen = 0;
    if (!options_.root.empty()) {
      const auto label = std::ranges::find(labels, printable(options_.root));
      const auto number = parse_number<std::size_t>(options_.root);
      if (label != labels.end()) {
        chosen = static_cast<std::size_t>(label - labels.begin());
      } else if (number && *number >= 1 && *number <= subjects.size()) {
        chosen = *number - 1;
      } else {
        return usage_failure("expected a subject \"" + printable(options_.root) +
                             "\" (" OPTION("root") "), found " + list_names(names, 8));
      }
    } else if (subjects.size() > 1) {
      warnings_.push_back({0, 0,
                           fmt::format("the file has {} subjects ({}), and only the first is read; "
                                       "" OPTION("root") " NAME|N reads another",
                                       subjects.size(), list_names(names, 8))});
    }
    if (subjects.size() > 1) {
      subject_ = fmt::format("subject {} of {}, ", chosen + 1, subjects.size());
    }
    return subjects[chosen];
  }

  Result<void> find_segments(const XMLElement& subject) {
    const XMLElement* segments = subject.FirstChildElement("segments");
    const XMLElement* joints = subject.FirstChildElement("joints");
    if (segments == nullptr || joints == nullptr) return fault("it has no segments or no joints");
    std::map<std::string, int> numbers;
    for (const XMLElement* each : children_of(*segments, "segment")) {
      const std::string name = attribute_of(each, "label");
      if (!numbers.emplace(name, static_cast<int>(names_.size())).second) {
        return fault("two segments have the name \"" + printable(name) + "\"");
      }
      names_.push_back(name);
      if (names_.size() > kMaxSegments) return fault("it has more than 1000 segments");
    }
    parents_.assign(names_.size(), -1);
    for (const XMLElement* each : children_of(*joints, "joint")) {
      const auto parent = numbers.find(segment_of(each->FirstChildElement("connector1")));
      const auto child = numbers.find(segment_of(each->FirstChildElement("connector2")));
      if (parent == numbers.end() || child == numbers.end()) {
        return fault("a joint connects unknown segments",
                     static_cast<std::size_t>(each->GetLineNum()));
      }
      parents_[static_cast<std::size_t>(child->second)] = parent->second;
    }
    return {};
  }

  // Orders segments depth first with parents first. Only the tree of the first segment without
  // parent is used; others are props.
  Result<void> order_segments() {
    const auto root = std::ranges::find(parents_, -1);
    if (root == parents_.end()) return fault("its segments form a cycle instead of a tree");
    std::vector<std::pair<int, int>> waiting = {{static_cast<int>(root - parents_.begin()), -1}};
    while (!waiting.empty()) {
      const auto [segment, parent] = waiting.back();
      waiting.pop_back();
      const int place = static_cast<int>(segments_.size());
      segments_.push_back(segment);
      places_.push_back(parent);
      for (int child = static_cast<int>(parents_.size()); child-- > 0;) {
        if (parents_[static_cast<std::size_t>(child)] == segment)
          waiting.emplace_back(child, place);
      }
    }
    return {};
  }

  Result<void> find_frames(const XMLElement& subject) {
    const XMLElement* frames = subject.FirstChildElement("frames");
    if (frames == nullptr) return fault("it has no frames");
    for (const XMLElement* each : children_of(*frames, "frame")) {
      const std::string type = attribute_of(each, "type");
      if (type.empty() || type == "normal") {
        frames_.push_back(each);
      } else {
        calibration_.emplace(std::string(type), each);
      }
    }
    if (frames_.empty() && !options_.skeleton_only)
      return fault("it has no frames of type \"normal\"");
    return {};
  }

  Result<std::vector<Pose>> poses_of(const XMLElement& frame) const {
    const auto rotations = numbers_of(text_of(frame.FirstChildElement("orientation")));
    const auto positions = numbers_of(text_of(frame.FirstChildElement("position")));
    const auto line = static_cast<std::size_t>(frame.GetLineNum());
    // Fingers and props may follow the body.
    if (!rotations || !positions || rotations->size() < 4 * names_.size() ||
        positions->size() < 3 * names_.size()) {
      return fault(
          fmt::format("a frame lacks orientations or positions for its {} segments", names_.size()),
          line);
    }
    std::vector<Pose> poses;
    poses.reserve(segments_.size());
    for (const int segment : segments_) {
      const double* q = rotations->data() + 4 * static_cast<std::size_t>(segment);
      const double* p = positions->data() + 3 * static_cast<std::size_t>(segment);
      const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
      if (!(std::abs(rotation.norm() - 1.0) < 0.1)) {
        return fault("a frame has an orientation that is not a unit quaternion", line);
      }
      poses.push_back({rotation.normalized(), {p[0], p[1], p[2]}});
    }
    return poses;
  }

  Result<std::vector<WorldJoint>> rest_joints() {
    std::vector<Pose> rest(segments_.size());
    const std::array<const char*, 3> kPoses = {"tpose", "identity", "npose"};
    const auto* pose =
        std::ranges::find_if(kPoses, [&](const char* name) { return calibration_.contains(name); });
    if (pose != kPoses.end()) {
      rest_name_ = *pose;
      TRY_ASSIGN(rest, poses_of(*calibration_.at(*pose)));
    } else if (!frames_.empty()) {
      TRY_ASSIGN(const auto first, poses_of(*frames_.front()));
      for (std::size_t i = 1; i < rest.size(); ++i) {
        const auto parent = static_cast<std::size_t>(places_[i]);
        rest[i].translation =
            rest[parent].translation +
            first[parent].rotation.conjugate() * (first[i].translation - first[parent].translation);
      }
    }
    std::vector<std::string> names;
    for (const int segment : segments_) names.push_back(names_[static_cast<std::size_t>(segment)]);
    names = plain_joint_names(std::move(names));
    std::vector<WorldJoint> joints;
    for (std::size_t i = 0; i < segments_.size(); ++i)
      joints.push_back({names[i], places_[i], rest[i]});
    return joints;
  }

  Result<FrameRate> rate_of(const XMLElement& subject) const {
    if (options_.source_fps) return frame_rate_from_fps(*options_.source_fps);
    const auto fps = parse_number<double>(attribute_of(&subject, "frameRate"));
    if (!fps || !is_plausible_rate(*fps)) {
      return input_failure(file_name_, "the MVNX file has no frame rate",
                           OPTION("source-fps") " N gives it");
    }
    return frame_rate_from_fps(*fps);
  }

  // Rejects frames that are not even or have another rate than the file states. With a requested
  // rate, missing frames are a warning.
  Result<void> check_clock(const FrameRate& rate) {
    std::vector<MvnxStamp> stamps;
    for (const XMLElement* frame : frames_) {
      stamps.push_back({parse_number<double>(attribute_of(frame, "time")),
                        parse_number<double>(attribute_of(frame, "index")),
                        static_cast<std::size_t>(frame->GetLineNum())});
    }
    const bool is_requested = options_.source_fps.has_value();
    auto found = mvnx_clock_fault(stamps, is_requested ? std::nullopt : std::optional(rate.fps()));
    if (!found) return {};
    if (is_requested) {
      warnings_.push_back({found->line, 0, found->message + "; this is ignored"});
      return {};
    }
    Error error{ErrorKind::kInput, {file_name_, found->line, 0}, {}, {}, {}};
    error.message = std::move(found->message);
    error.hint = OPTION("source-fps") " N reads the frames as even, N per second";
    return failure(std::move(error));
  }

  Result<Clip> make_clip(const XMLElement& subject, std::size_t file_bytes) {
    TRY_ASSIGN(const FrameRate rate, rate_of(subject));
    TRY(check_clock(rate));
    TRY_ASSIGN(auto joints, rest_joints());
    const std::size_t most = options_.max_clip_bytes / ClipBuilder::frame_bytes(joints.size());
    if (frames_.size() > std::min<std::size_t>(most, std::numeric_limits<int>::max())) {
      return input_failure(file_name_, "the motion exceeds the memory limit", kLargeFileHint);
    }
    ClipBuilder builder(std::move(joints), rate, static_cast<int>(frames_.size()));
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      TRY_ASSIGN(const auto poses, poses_of(*frames_[i]));
      builder.set_frame(static_cast<int>(i), poses);
    }
    Clip clip = builder.build();
    ClipOrigin origin;
    origin.name = file_name_;
    origin.bytes = file_bytes;
    origin.warnings = std::move(warnings_);
    origin.metres_per_unit = 1.0;
    origin.up = Eigen::Vector3d::UnitZ();
    origin.choices = "MVNX, " + subject_;
    origin.choices += rest_name_.empty() ? "no calibration frame"
                                         : "its frame \"" + rest_name_ + "\" is the zero pose";
    clip.set_origin(std::move(origin));
    return clip;
  }

  const std::string& file_name_;
  const SceneReadOptions& options_;
  std::vector<std::string> names_;  // Of all segments, in document order.
  std::vector<int> parents_;        // Of all segments, in document order; -1: none.
  std::vector<int> segments_;       // Segments of the body, parents first.
  std::vector<int> places_;         // Index of each one's parent in segments_.
  std::vector<const XMLElement*> frames_;
  std::map<std::string, const XMLElement*> calibration_;
  std::string rest_name_;
  std::string subject_;  // Of several, for the summary.
  std::vector<Warning> warnings_;
};

}  // namespace

Result<Clip> read_mvnx(std::string_view bytes, const std::string& file_name,
                       const SceneReadOptions& options) {
  return MvnxReader(file_name, options).read(bytes);
}

}  // namespace retarget

// Writes the poses of all joints and end sites as CSV.

#include <array>
#include <charconv>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/inspect.h"
#include "retarget/pose.h"
#include "retarget/skeleton_points.h"

namespace retarget {
namespace {

void append_number(std::string& text, double value) {
  std::array<char, 40> digits;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  text.append(digits.data(), end);
}

// Quotes names with a comma, a quote or a line end, as RFC 4180 requires.
std::string csv_field(const std::string& field) {
  if (field.find_first_of(",\"\r\n") == std::string::npos) return field;
  std::string quoted = "\"";
  for (const char c : field) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

std::string positions_csv(const Clip& clip) {
  const std::vector<SkeletonPoint> points = skeleton_points(clip.skeleton());
  std::string text = "frame,time";
  for (const SkeletonPoint& point : points) {
    for (const char* column : {".x", ".y", ".z", ".qx", ".qy", ".qz", ".qw"}) {
      text += "," + csv_field(point.name + column);
    }
  }
  text += "\n";
  std::vector<Pose> world_from_joint(clip.skeleton().joint_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    forward_kinematics(clip, frame, world_from_joint);
    text += std::to_string(frame) + ",";
    append_number(text, clip.rate().time_of(frame));
    for (const SkeletonPoint& point : points) {
      const Pose pose = world_from_point(point, world_from_joint);
      const Eigen::Vector4d xyzw = pose.rotation.coeffs();
      for (const double value : {pose.translation.x(), pose.translation.y(), pose.translation.z(),
                                 xyzw[0], xyzw[1], xyzw[2], xyzw[3]}) {
        text += ',';
        append_number(text, value);
      }
    }
    text += '\n';
  }
  return text;
}

}  // namespace retarget

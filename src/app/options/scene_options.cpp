#include "app/options/scene_options.h"

#include <fmt/format.h>
#include <cmath>
#include <numbers>
#include <string_view>

#include "app/options/checked_text.h"
#include "base/option_name.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// To judge or show a motion, its scene must be that of the run that made it.
constexpr OptionUse kOfScene = OptionUse::kMeasure | OptionUse::kShow | OptionUse::kShowBatch;

// Steps and slopes that legs can climb, metres and degrees.
constexpr double kMinRise = 0.005, kMaxRise = 0.5, kMinTread = 0.1, kMaxTread = 2.0;
constexpr double kMinSlope = 0.5, kMaxSlope = 30.0, kMaxSteps = 200.0;
constexpr double kMinSceneScale = 0.5, kMaxSceneScale = 2.0;
constexpr double kMaxShift = 2.0;  // Metres.

bool is_within(double value, double min, double max) {
  return value >= min && value <= max;
}

std::optional<TerrainShape> stairs_in(std::string_view text) {
  const auto numbers = numbers_from_text(text, 'x');
  if (!numbers || numbers->size() < 2 || numbers->size() > 3) return std::nullopt;
  TerrainShape shape{(*numbers)[0], (*numbers)[1]};
  if (!is_within(shape.rise, kMinRise, kMaxRise) || !is_within(shape.tread, kMinTread, kMaxTread)) {
    return std::nullopt;
  }
  if (numbers->size() == 3) {
    const double count = numbers->back();
    if (!is_within(count, 1.0, kMaxSteps) || count != std::round(count)) return std::nullopt;
    shape.count = static_cast<int>(count);
  }
  return shape;
}

}  // namespace

Result<std::optional<TerrainShape>> terrain_from_text(const std::string& text) {
  constexpr std::string_view kStairs = "stairs:", kSlope = "slope:";
  const std::string_view view = text;
  if (text.empty()) return std::optional<TerrainShape>();
  if (view.starts_with(kStairs)) {
    if (auto shape = stairs_in(view.substr(kStairs.size()))) return shape;
  }
  if (view.starts_with(kSlope)) {
    const auto degrees = parse_number<double>(view.substr(kSlope.size()));
    if (degrees && is_within(*degrees, kMinSlope, kMaxSlope)) {
      TerrainShape shape;
      shape.slope = *degrees * std::numbers::pi / 180.0;
      return std::optional(shape);
    }
  }
  // In the message, because the command line has its own hint for values of options.
  return usage_failure(fmt::format(
      "expected stairs:RISExTREAD, stairs:RISExTREADxCOUNT or slope:DEGREES (a rise of {} to {} m, "
      "a tread of {} to {} m, at most {} steps, a slope of {} to {} degrees), found \"{}\"",
      kMinRise, kMaxRise, kMinTread, kMaxTread, kMaxSteps, kMinSlope, kMaxSlope, text));
}

Result<Vector3d> terrain_scale_from_text(const std::string& text) {
  if (text.empty()) return Vector3d(1.0, 1.0, 1.0);
  const bool heights = text.starts_with("z=");
  const auto factor = parse_number<double>(std::string_view(text).substr(heights ? 2 : 0));
  if (factor && is_within(*factor, kMinSceneScale, kMaxSceneScale)) {
    return heights ? Vector3d(1.0, 1.0, *factor) : Vector3d(*factor, *factor, *factor);
  }
  return usage_failure(
      fmt::format("expected a number from {} to {}, or z= and such a number, found "
                  "\"{}\"",
                  kMinSceneScale, kMaxSceneScale, text));
}

Result<Vector3d> object_shift_from_text(const std::string& text) {
  if (text.empty()) return Vector3d(0.0, 0.0, 0.0);
  const auto numbers = numbers_from_text(text, ',');
  if (numbers && numbers->size() == 3) {
    const Vector3d shift((*numbers)[0], (*numbers)[1], (*numbers)[2]);
    if (shift.norm() <= kMaxShift) return shift;
  }
  return usage_failure(fmt::format("expected X,Y,Z in metres, at most {} m in total, found \"{}\"",
                                   kMaxShift, text));
}

OptionTable scene_table(SolveOptions& options) {
  const OptionInfo judged{.uses = kOfScene}, change{.uses = kOfScene, .recorded_if_given = true};
  return {
      option("scene", options.scene, kRobotGroup, "FILE",
             "Scene around the human, in addition to the floor: boxes, terrain, furniture, "
             "objects, as MJCF, URDF, OBJ, STL or a JSON list of primitives, in metres with z up "
             "(docs/world.md)",
             {.file = OptionFile::kContent, .uses = kOfScene}),
      option("object-track", options.object_tracks, kRobotGroup, "[BODY=]FILE,...",
             "Paths of moving bodies of " OPTION(
                 "scene") ": NPZ, NPY, CSV, or InterMimic's tensor with human and object",
             judged),
      option("scene-axes", options.scene_axes, kRobotGroup, "",
             "Unit and axes of the scene and its tracks: human: metres, z up; clip: those of the "
             "clip's file",
             judged),
      checked_text<terrain_from_text>(
          "terrain", options.terrain, kRobotGroup, "stairs:RISExTREAD|slope:DEGREES",
          "Add stairs or a slope below a walk on a flat floor, along the human's path; in "
          "metres of the robot's world; xCOUNT limits the number of steps",
          change),
      checked_text<terrain_scale_from_text>(
          "terrain-scale", options.terrain_scale, kRobotGroup, "S|z=S",
          "Scale the static bodies of the scene about the origin, or only their heights; "
          "the human's contacts follow (default: 1)",
          change),
      checked_text<object_shift_from_text>(
          "object-shift", options.object_shift, kRobotGroup, "X,Y,Z",
          "Move the moving bodies of the scene, metres; hands that touch them follow", change),
      option("object-scale", options.object_scale, kRobotGroup, "S",
             "Scale the moving bodies of the scene; hands that touch them follow",
             {.min = kMinSceneScale, .max = kMaxSceneScale, .uses = kOfScene}),
      option("object-motion", options.object_motion, kRobotGroup, "",
             "Paths of the moving bodies of the scene: given: those of their tracks; fitted: "
             "adapted to the hands that hold them, if these would lose contact",
             change)};
}

}  // namespace retarget

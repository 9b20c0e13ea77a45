#include "solve/robot_setup/describe_robot.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "retarget/kinematic_tree.h"
#include "retarget/shape_distance.h"
#include "solve/robot_setup/check_profile.h"
#include "solve/robot_setup/format_model.h"

namespace retarget {
namespace {

constexpr double kOff = 5.0 * std::numbers::pi / 180.0;  // T-pose error for a note.
constexpr double kOddAngle =
    15.0 * std::numbers::pi / 180.0;  // Limb angle in the self-test for a note.

std::string body_name(const RobotFindings& findings, int body) {
  return findings.robot.bodies()[body].name;
}

std::string metres(double length) {
  return number_text(rounded(length, 3)) + " m";
}

std::string default_speeds(const RobotFindings& findings) {
  std::vector<int> joints(findings.robot.joints().size());
  std::iota(joints.begin(), joints.end(), 0);
  return default_speeds_text(findings.robot, joints);
}

// Reports soles that are not at one height in the T-pose, and bodies that reach below them: the
// robot cannot stand level on its feet.
void note_heights(const RobotFindings& findings, std::vector<std::string>& notes) {
  constexpr double kApart = 0.01, kBelow = 0.005;  // Metres.
  const Robot& robot = findings.robot;
  const std::vector<Sole>& soles = findings.shapes.soles;
  if (soles.size() != 2) return;
  const TreeState posed(robot.tree(), findings.t_pose.qpos);
  std::array<double, 2> heights{HUGE_VAL, HUGE_VAL};
  for (std::size_t side = 0; side < 2; ++side) {
    for (const Eigen::Vector3d& point : soles[side].points) {
      heights[side] =
          std::min(heights[side], (posed.world_from_body(soles[side].body) * point).z());
    }
  }
  const double apart = heights[0] - heights[1], floor = std::min(heights[0], heights[1]);
  if (std::abs(apart) > kApart) {
    notes.push_back(fmt::format("in the T-pose the {} sole is {} lower than the other one",
                                apart < 0.0 ? "left" : "right", metres(std::abs(apart))));
  }
  std::map<int, double> below;  // Height of the lowest shape, by body.
  for (const RoughShape& rough : findings.shapes.shapes) {
    const int body = rough.shape.body;
    const bool is_foot = std::ranges::any_of(soles, [&](const Sole& sole) {
      return robot.tree().attachment(sole.body).link == robot.tree().attachment(body).link;
    });
    if (is_foot) continue;
    const double height = lowest_point(place(rough.shape, posed.world_from_body(body))).z();
    if (height > floor - kBelow) continue;
    double& lowest = below.emplace(body, height).first->second;
    lowest = std::min(lowest, height);
  }
  for (const auto& [body, height] : below) {
    notes.push_back(fmt::format("in the T-pose \"{}\" reaches {} below the soles",
                                body_name(findings, body), metres(floor - height)));
  }
}

std::string sureness(const Limb& limb) {
  std::string text = limb.clarity >= kClearMiddle ? "sure" : "another joint fits nearly as well";
  if (!limb.flexion_is_sure) text += ", bends both ways";
  if (limb.lower_is_estimated) text += ", end estimated from its mass";
  return text;
}

std::string chain_text(const RobotFindings& findings, const Limb& limb) {
  std::string text =
      body_name(findings, limb.upper.body) + " - " + body_name(findings, limb.lower.body);
  if (limb.end) text += " - " + body_name(findings, limb.end->body);
  return text;
}

std::string limbs_section(const RobotFindings& findings) {
  const RobotAnatomy& limbs = findings.limbs;
  std::string text =
      "## Limbs\n\n| part | bodies | bends at | lengths | confidence |\n|---|---|---|---|---|\n";
  text += fmt::format(
      "| {} | {} | | | {} |\n| torso | {}{} | | | carries both arms |\n",
      limbs.has_legs ? "pelvis" : "base", body_name(findings, limbs.pelvis),
      limbs.has_legs ? "carries both legs" : "fixed base", body_name(findings, limbs.torso),
      limbs.torso == limbs.pelvis ? (limbs.has_legs ? " (the pelvis)" : " (the base)") : "");
  for (const bool is_leg : {true, false}) {
    if (is_leg && !limbs.has_legs) continue;
    for (std::size_t side = 0; side < 2; ++side) {
      const Limb& limb = is_leg ? limbs.legs[side] : limbs.arms[side];
      const int middle = limb.joints[limb.middle];
      text += fmt::format("| {} {} | {} | {} | {}, {} | {} |\n", side == 0 ? "left" : "right",
                          is_leg ? "leg" : "arm", chain_text(findings, limb),
                          findings.robot.joints()[middle].name, metres(limb.upper_length),
                          metres(limb.lower_length), sureness(limb));
    }
  }
  if (limbs.head) text += "| head | " + body_name(findings, limbs.head->body) + " | | | |\n";
  return text +
         fmt::format(
             "\nBodies are listed from the trunk outwards: the last body before the knee or elbow, "
             "the body after it, foot or hand. The robot faces {} {} (x y) in its zero "
             "configuration{}.\n",
             number_text(rounded(limbs.forward.x(), 2)), number_text(rounded(limbs.forward.y(), 2)),
             limbs.facing_is_sure ? "" : ", which is uncertain");
}

std::string t_pose_section(const RobotFindings& findings) {
  std::string text =
      "## T-pose\n\nThe pose is `t_pose` in robot.json. Remaining error per bone, degrees:\n\n"
      "| bone | body | direction | twist |\n|---|---|---|---|\n";
  for (const TPoseResidual& residual : findings.t_pose.residuals) {
    text +=
        fmt::format("| {} | {} | {} | {} |\n", residual.bone, body_name(findings, residual.body),
                    degrees_text(residual.direction), degrees_text(residual.twist));
  }
  text +=
      "\nRotation offsets refer to the exact T-pose; they are correct even if joint limits prevent "
      "a limb from reaching it.\n";
  return text;
}

std::string self_test_section(const SelfTest& test) {
  std::string text = fmt::format(
      "## Self-test\n\nArms hang, bend, reach forwards and up; legs step and squat. Mean angle "
      "between the robot's and the human's limbs, degrees ({} over all):\n\n| limb | degrees "
      "|\n|---|---|\n",
      degrees_text(test.mean));
  for (const TestedSegment& segment : test.segments) {
    text += fmt::format("| {} | {} |\n", segment.segment, degrees_text(segment.mean));
  }
  return text;
}

std::string rest_section(const RobotFindings& findings) {
  const DerivedScales scales = derive_scales(findings.limbs);
  const auto count = [&](ShapeSource source) {
    return std::ranges::count(findings.shapes.shapes, source, &RoughShape::source);
  };
  const auto shapes_text = fmt::format(
      "* Collision shapes: {} from the model, {} fitted to meshes, {} estimated. Neighbours in the "
      "tree and shapes that overlap in the model may touch.\n* Speed limits: {} of {} joints from "
      "the model, otherwise {}.\n",
      count(ShapeSource::kModel), count(ShapeSource::kMesh), count(ShapeSource::kEstimated),
      findings.speeds.size(), findings.robot.joints().size(), default_speeds(findings));
  if (!findings.limbs.has_legs) {
    return "## Base, shapes, speeds\n\n* The base is fixed: limbs rotate like the human's, "
           "relative to the human's " +
           std::string(findings.limbs.torso == findings.limbs.pelvis ? "chest" : "hips") + ".\n" +
           shapes_text;
  }
  return fmt::format(
      "## Scales\n\nLegs are {} of the human's, arms {}: a straight human leg maps to a straight "
      "robot leg, and likewise for arms.\n\n## Soles, shapes, speeds\n\n* Soles: {}. The ankles "
      "stand {} above them.\n"
      "{}",
      number_text(rounded(scales.leg, 3)), number_text(rounded(scales.arm, 3)),
      findings.shapes.sole_note, metres(findings.shapes.ankle_height), shapes_text);
}

// The section about hands; empty without hands.
std::string hands_section(const RobotFindings& findings) {
  const Robot& robot = findings.robot;
  std::string rows;
  for (const auto& hand : findings.hands) {
    if (!hand) continue;
    for (const RobotFinger& finger : hand->fingers) {
      const int first = hand->joints[finger.joints.front()].joint;
      const int last = hand->joints[finger.joints.back()].joint;
      rows += fmt::format("| {} {} | {} - {} | {} | {} |\n",
                          hand->side == Side::kLeft ? "left" : "right", finger_name(finger.finger),
                          robot.bodies()[robot.joints()[first].body].name,
                          robot.bodies()[robot.joints()[last].body].name, finger.joints.size(),
                          finger.is_named ? "its name" : "its position and direction");
    }
  }
  if (rows.empty()) return {};
  return "## Hands\n\n| finger | branch | joints | identified by |\n|---|---|---|---|\n" + rows +
         "\nIf a branch is another finger, rename its first body in model.xml (and in robot.json "
         "and "
         "ik.json, if they name it) so that the name contains thumb, index, middle, ring or "
         "little. "
         "Name at least two branches of a hand, or only the thumb.\n\n";
}

// The section about overlaps; empty without overlaps.
std::string overlaps_section(const RobotFindings& findings) {
  if (findings.overlaps.empty()) return {};
  std::string text = "## Overlaps\n\nContacts of these bodies are ignored:\n\n";
  for (const std::string& overlap : findings.overlaps) text += "* " + overlap + "\n";
  return text + "\n";
}

}  // namespace

std::string degrees_text(double radians) {
  std::string text = number_text(rounded(radians * 180.0 / std::numbers::pi, 1));
  if (text.find('.') == std::string::npos) text += ".0";
  return text;
}

std::vector<std::string> notes_about(const RobotFindings& findings) {
  std::vector<std::string> notes = findings.limbs.notes;
  notes.insert(notes.end(), findings.limbs.doubts.begin(), findings.limbs.doubts.end());
  for (const TPoseResidual& residual : findings.t_pose.residuals) {
    if (std::max(residual.direction, residual.twist) < kOff) continue;
    notes.push_back(
        fmt::format("in the T-pose \"{}\" is {} degrees off in direction and {} in twist: its "
                    "limits or its kinematics do not allow less, or its foot or hand points "
                    "elsewhere in the zero configuration",
                    body_name(findings, residual.body), degrees_text(residual.direction),
                    degrees_text(residual.twist)));
  }
  if (findings.self_test.worst.mean > kOddAngle) {
    notes.push_back(self_test_text(findings.self_test));
  }
  if (findings.shapes.sole_source == ShapeSource::kEstimated) {
    notes.push_back("the soles are " + findings.shapes.sole_note +
                    ": add the outlines of the feet to robot.json");
  }
  note_heights(findings, notes);
  if (findings.speeds.empty()) {
    notes.push_back("no speed limits are known: using " + default_speeds(findings) +
                    " for every joint");
  }
  if (auto odd = odd_speeds_text(findings.robot, findings.speeds)) notes.push_back(std::move(*odd));
  return notes;
}

std::vector<std::string> summary_of(const RobotFindings& findings) {
  const RobotAnatomy& limbs = findings.limbs;
  const DerivedScales scales = derive_scales(limbs);
  double worst = 0.0;
  for (const TPoseResidual& residual : findings.t_pose.residuals) {
    worst = std::max({worst, residual.direction, residual.twist});
  }
  const SelfTest& test = findings.self_test;
  const std::string self_test =
      fmt::format("self-test: limbs within {} degrees on average, {} at most ({})",
                  degrees_text(test.mean), degrees_text(test.worst.mean), test.worst.segment);
  if (!limbs.has_legs) {
    return {"base: " + body_name(findings, limbs.pelvis) + " (fixed)",
            "left arm: " + chain_text(findings, limbs.arms[0]),
            "T-pose: every bone within " + degrees_text(worst) + " degrees", self_test};
  }
  return {"trunk: " + body_name(findings, limbs.pelvis) +
              (limbs.torso == limbs.pelvis ? "" : ", " + body_name(findings, limbs.torso)),
          "left leg: " + chain_text(findings, limbs.legs[0]),
          "left arm: " + chain_text(findings, limbs.arms[0]),
          "T-pose: every bone within " + degrees_text(worst) + " degrees",
          self_test,
          fmt::format("scales: legs {}, arms {} of a human's", number_text(rounded(scales.leg, 3)),
                      number_text(rounded(scales.arm, 3))),
          "soles: " + findings.shapes.sole_note};
}

std::string decisions_text(const RobotFindings& findings, const std::vector<std::string>& notes) {
  std::string text = fmt::format(
      "# {}\n\nMade from {}: {} joints. This file lists the decisions and their confidence.\n\n## "
      "Please check\n\n",
      findings.robot.name(), findings.source, findings.robot.joints().size());
  if (notes.empty()) text += "Nothing stands out.\n";
  for (const std::string& note : notes) text += "* " + note + "\n";
  return text + "\n" + limbs_section(findings) + "\n" + t_pose_section(findings) + "\n" +
         self_test_section(findings.self_test) + "\n" + hands_section(findings) +
         overlaps_section(findings) + rest_section(findings);
}

}  // namespace retarget

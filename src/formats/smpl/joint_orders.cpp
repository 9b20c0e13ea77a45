#include "formats/smpl/joint_motion.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "retarget/text.h"

namespace retarget {
namespace {

// Joint orders from the sources of the programs and data sets. SMPL, SMPL+H and SMPL-X: smplx
// (HumanML3D and MDM use the first 22 of SMPL). 52 joints depth first and 53 of optical motion
// capture: holosoma, whose LAFAN1 begins with the right leg. Key points: COCO, Human3.6M,
// MediaPipe's pose landmarks, OpenPose's BODY_25 and Halpe's body. SOMA's 77 and 30 joints: Kimodo.
constexpr std::string_view kSmpl =
    "pelvis left_hip right_hip spine1 left_knee right_knee spine2 left_ankle right_ankle spine3 "
    "left_foot right_foot neck left_collar right_collar head left_shoulder right_shoulder "
    "left_elbow right_elbow left_wrist right_wrist";
constexpr std::string_view kSmpl24 =
    "pelvis left_hip right_hip spine1 left_knee right_knee spine2 left_ankle right_ankle spine3 "
    "left_foot right_foot neck left_collar right_collar head left_shoulder right_shoulder "
    "left_elbow right_elbow left_wrist right_wrist left_hand right_hand";
constexpr std::string_view kSmplh =
    "pelvis left_hip right_hip spine1 left_knee right_knee spine2 left_ankle right_ankle spine3 "
    "left_foot right_foot neck left_collar right_collar head left_shoulder right_shoulder "
    "left_elbow right_elbow left_wrist right_wrist left_* right_*";
constexpr std::string_view kSmplx =
    "pelvis left_hip right_hip spine1 left_knee right_knee spine2 left_ankle right_ankle spine3 "
    "left_foot right_foot neck left_collar right_collar head left_shoulder right_shoulder "
    "left_elbow right_elbow left_wrist right_wrist jaw left_eye_smplhf right_eye_smplhf left_* "
    "right_*";
constexpr std::string_view kSmplhDepthFirst =
    "pelvis left_hip left_knee left_ankle left_foot right_hip right_knee right_ankle right_foot "
    "spine1 spine2 spine3 neck head left_collar left_shoulder left_elbow left_wrist left_* "
    "right_collar right_shoulder right_elbow right_wrist right_*";
constexpr std::string_view kMocap =
    "Hips Spine Spine1 Neck Head LeftShoulder LeftArm LeftForeArm LeftHand LeftHand* RightShoulder "
    "RightArm RightForeArm RightHand RightHand* LeftUpLeg LeftLeg LeftFoot LeftToeBase RightUpLeg "
    "RightLeg RightFoot RightToeBase LeftFootMod RightFootMod";
constexpr std::string_view kLafan =
    "Hips LeftUpLeg LeftLeg LeftFoot LeftToe RightUpLeg RightLeg RightFoot RightToe Spine Spine1 "
    "Spine2 Neck Head LeftShoulder LeftArm LeftForeArm LeftHand RightShoulder RightArm "
    "RightForeArm RightHand";
constexpr std::string_view kLafanRightFirst =
    "Hips RightUpLeg RightLeg RightFoot RightToeBase LeftUpLeg LeftLeg LeftFoot LeftToeBase Spine "
    "Spine1 Spine2 Neck Head RightShoulder RightArm RightForeArm RightHand LeftShoulder LeftArm "
    "LeftForeArm LeftHand";
constexpr std::string_view kCoco =
    "nose left_eye right_eye left_ear right_ear left_shoulder right_shoulder left_elbow "
    "right_elbow left_wrist right_wrist left_hip right_hip left_knee right_knee left_ankle "
    "right_ankle";
constexpr std::string_view kHuman36m =
    "pelvis right_hip right_knee right_ankle left_hip left_knee left_ankle spine thorax neck head "
    "left_shoulder left_elbow left_wrist right_shoulder right_elbow right_wrist";
constexpr std::string_view kMediaPipe =
    "nose left_eye_inner left_eye left_eye_outer right_eye_inner right_eye right_eye_outer "
    "left_ear right_ear mouth_left mouth_right left_shoulder right_shoulder left_elbow "
    "right_elbow left_wrist right_wrist left_pinky right_pinky left_index right_index left_thumb "
    "right_thumb left_hip right_hip left_knee right_knee left_ankle right_ankle left_heel "
    "right_heel left_foot_index right_foot_index";
constexpr std::string_view kBody25 =
    "nose neck right_shoulder right_elbow right_wrist left_shoulder left_elbow left_wrist mid_hip "
    "right_hip right_knee right_ankle left_hip left_knee left_ankle right_eye left_eye right_ear "
    "left_ear left_big_toe left_small_toe left_heel right_big_toe right_small_toe right_heel";
constexpr std::string_view kHalpe26 =
    "nose left_eye right_eye left_ear right_ear left_shoulder right_shoulder left_elbow "
    "right_elbow left_wrist right_wrist left_hip right_hip left_knee right_knee left_ankle "
    "right_ankle head neck mid_hip left_big_toe right_big_toe left_small_toe right_small_toe "
    "left_heel right_heel";
constexpr std::string_view kSoma77 =
    "Hips Spine1 Spine2 Chest Neck1 Neck2 Head HeadEnd Jaw LeftEye RightEye LeftShoulder LeftArm "
    "LeftForeArm LeftHand LeftHand+ RightShoulder RightArm RightForeArm RightHand RightHand+ "
    "LeftLeg LeftShin LeftFoot LeftToeBase LeftToeEnd RightLeg RightShin RightFoot RightToeBase "
    "RightToeEnd";
constexpr std::string_view kSoma30 =
    "Hips Spine1 Spine2 Chest Neck1 Neck2 Head Jaw LeftEye RightEye LeftShoulder LeftArm "
    "LeftForeArm LeftHand LeftHandThumbEnd LeftHandMiddleEnd RightShoulder RightArm RightForeArm "
    "RightHand RightHandThumbEnd RightHandMiddleEnd LeftLeg LeftShin LeftFoot LeftToeBase RightLeg "
    "RightShin RightFoot RightToeBase";

// SMPL-X's 127 and 144 joints and SMPL's 45 include points on the skin.
constexpr std::array kOrders = {
    JointOrder{"SMPL", kSmpl},
    JointOrder{"LAFAN1", kLafan},
    JointOrder{"LAFAN1, right side first", kLafanRightFirst},
    JointOrder{"SMPL", kSmpl24},
    JointOrder{"SMPL", kSmpl24, 21},
    JointOrder{"SMPL+H", kSmplh},
    JointOrder{"SMPL+H, depth first", kSmplhDepthFirst},
    JointOrder{"optical motion capture (holosoma)", kMocap},
    JointOrder{"SMPL-X", kSmplx},
    JointOrder{"SMPL-X", kSmplx, 72},
    JointOrder{"SMPL-X", kSmplx, 89},
    JointOrder{"COCO", kCoco},
    JointOrder{"Human3.6M", kHuman36m},
    JointOrder{"SOMA", kSoma77},
    JointOrder{"SOMA", kSoma30},
    JointOrder{"MediaPipe", kMediaPipe},
    JointOrder{"OpenPose BODY_25", kBody25},
    JointOrder{"Halpe", kHalpe26},
};
constexpr std::array kKimodo = {JointOrder{"SOMA", kSoma77}, JointOrder{"SOMA", kSoma30},
                                JointOrder{"SMPL-X", kSmpl}};

// Adds the finger joints of a hand in the naming of SMPL, motion capture, or SOMA (with finger
// ends).
void add_fingers(const std::string& hand, bool is_soma, std::vector<std::string>& names) {
  const bool is_smpl = hand.back() == '_';
  constexpr std::array<std::string_view, 5> kSmplFingers = {"index", "middle", "pinky", "ring",
                                                            "thumb"};
  constexpr std::array<std::string_view, 5> kFingers = {"Thumb", "Index", "Middle", "Ring",
                                                        "Pinky"};
  for (const std::string_view finger : is_smpl ? kSmplFingers : kFingers) {
    const int joints = is_soma && finger != "Thumb" ? 4 : 3;
    for (int i = 1; i <= joints; ++i) names.push_back(fmt::format("{}{}{}", hand, finger, i));
    if (is_soma) names.push_back(fmt::format("{}{}End", hand, finger));
  }
}

}  // namespace

std::vector<std::string> JointOrder::names() const {
  std::vector<std::string> names;
  std::string_view rest = joints;
  while (!rest.empty()) {
    const std::string_view word = take_until(rest, ' ');
    const bool has_fingers = word.back() == '*' || word.back() == '+';
    if (has_fingers) {
      add_fingers(std::string(word.substr(0, word.size() - 1)), word.back() == '+', names);
    } else {
      names.emplace_back(word);
    }
  }
  return names;
}

std::span<const JointOrder> joint_orders() {
  return kOrders;
}

std::span<const JointOrder> kimodo_orders() {
  return kKimodo;
}

bool is_tracked(const Eigen::Vector3d& point) {
  return point.allFinite() && point != Eigen::Vector3d::Constant(point.x());
}

namespace {

using Eigen::Vector3d;

// Whether three equal coordinates mark a lost point: 0, or another number that programs write.
bool is_marker(const Vector3d& place) {
  return place.allFinite() && place == Vector3d::Constant(place.x());
}

// Whether a joint has such coordinates in a few frames. A joint that is often there belongs there.
bool leaves_markers(const JointMotion& motion, int joint) {
  constexpr int kShare = 3;
  int marked = 0;
  for (int frame = 0; frame < motion.frame_count; ++frame) {
    marked += is_marker(motion.position(frame, joint)) ? 1 : 0;
  }
  return kShare * marked < motion.frame_count;
}

// The frame in which most joints are tracked.
int fullest_frame(const JointMotion& motion) {
  int fullest = 0, most = -1;
  for (int frame = 0; frame < motion.frame_count; ++frame) {
    int away = 0;
    for (int joint = 0; joint < motion.joint_count; ++joint) {
      away += is_tracked(motion.position(frame, joint)) ? 1 : 0;
    }
    if (away <= most) continue;
    fullest = frame;
    most = away;
  }
  return fullest;
}

// Whether two joints are at the same place where they are tracked, such as the hips
// and the hip joints of CMU's skeletons.
// @param start  first frame of the search
bool coincide(const JointMotion& motion, int first, int second, int start) {
  constexpr double kSamePlace = 1e-3;  // Metres.
  for (int i = 0; i < motion.frame_count; ++i) {
    const int frame = i < motion.frame_count - start ? start + i : start + i - motion.frame_count;
    const Vector3d& a = motion.position(frame, first);
    const Vector3d& b = motion.position(frame, second);
    if (is_tracked(a) && is_tracked(b)) return (a - b).norm() < kSamePlace;
  }
  return false;
}

// The joints with few markers; of joints that coincide only the first.
std::vector<int> distinct_joints(const JointMotion& motion) {
  const int start = fullest_frame(motion);
  std::vector<int> distinct;
  for (int joint = 0; joint < motion.joint_count; ++joint) {
    if (!leaves_markers(motion, joint)) continue;
    const bool is_new = std::ranges::none_of(
        distinct, [&](int other) { return coincide(motion, other, joint, start); });
    if (is_new) distinct.push_back(joint);
  }
  return distinct;
}

// Marks the frames in which several joints that have the coordinates of lost points in few frames,
// and do not coincide elsewhere, have them: all of these joints are lost.
std::vector<char> frames_with_markers(const JointMotion& motion) {
  constexpr int kFewest = 3;
  std::vector<int> counts(static_cast<std::size_t>(motion.frame_count));
  for (const int joint : distinct_joints(motion)) {
    for (int frame = 0; frame < motion.frame_count; ++frame) {
      const bool is_there = is_marker(motion.position(frame, joint));
      counts[static_cast<std::size_t>(frame)] += is_there ? 1 : 0;
    }
  }
  std::vector<char> marks;
  for (const int count : counts) marks.push_back(count >= kFewest ? 1 : 0);
  return marks;
}

class LostPoints {
 public:
  LostPoints(JointMotion& motion, int joint, const std::vector<char>& marked)
      : motion_(motion),
        joint_(joint),
        marked_(marked),
        markers_are_lost_(leaves_markers(motion, joint)) {}

  // Returns the number of lost frames.
  int bridge() {
    int lost = 0;
    for (int begin = 0, end = 0; begin < motion_.frame_count; begin = end) {
      end = begin + 1;
      if (!may_be_lost(begin)) continue;
      while (end < motion_.frame_count && may_be_lost(end)) ++end;
      if (end - begin > kLongestBridge) continue;
      if (begin == 0 || end == motion_.frame_count) {
        lost += hold(begin, end);
        continue;
      }
      if (!is_lost(begin, end)) continue;
      const Vector3d before = place(begin - 1), after = place(end);
      for (int frame = begin; frame < end; ++frame) {
        const double share = (frame - begin + 1.0) / (end - begin + 1.0);
        motion_.positions[motion_.index(frame, joint_)] = before + share * (after - before);
      }
      lost += end - begin;
    }
    return lost;
  }

  // Returns the first gap inside the motion that is too long to be bridged.
  [[nodiscard]] std::optional<FrameRange> long_gap() const {
    for (int begin = 1, end = 0; begin < motion_.frame_count; begin = end) {
      end = begin + 1;
      if (!may_be_lost(begin)) continue;
      while (end < motion_.frame_count && may_be_lost(end)) ++end;
      if (may_be_lost(begin - 1) || end == motion_.frame_count) continue;
      if (end - begin > kLongestBridge && is_lost(begin, end)) return FrameRange{begin, end};
    }
    return std::nullopt;
  }

 private:
  // Whether the joint is lost in a gap inside the motion, rather than at this place: it jumps away
  // and returns.
  [[nodiscard]] bool is_lost(int begin, int end) const {
    constexpr double kFarther = 4.0;  // Than a step at the mean speed across the gap.
    if (!place(begin).allFinite() || is_certain(begin, end)) return true;
    const Vector3d before = place(begin - 1), after = place(end);
    const double jump = std::min((before - place(begin)).norm(), (after - place(begin)).norm());
    return jump > kFarther * (after - before).norm() / (end - begin + 1);
  }

  // Holds the nearest place at the start or end of the motion if the joint jumps to a marker
  // there. NaN stays: it is an error. @return the number of frames
  int hold(int begin, int end) {
    if (begin == 0 && end == motion_.frame_count) return 0;
    const int nearest = begin == 0 ? end : begin - 1, last = begin == 0 ? end - 1 : begin;
    const int length = end - begin;
    const int other =
        std::clamp(begin == 0 ? nearest + length : nearest - length, 0, motion_.frame_count - 1);
    const Vector3d kept = place(nearest);
    if (!place(begin).allFinite() || !place(end - 1).allFinite()) return 0;
    if (!is_certain(begin, end) && !may_be_lost(other) &&
        !((kept - place(last)).norm() > 2.0 * (place(other) - kept).norm()))
      return 0;
    if (!is_certain(begin, end) && !jumps_alone(nearest, last)) return 0;
    for (int frame = begin; frame < end; ++frame) {
      motion_.positions[motion_.index(frame, joint_)] = kept;
    }
    return length;
  }

  // Whether other joints have markers, too, in all of these frames.
  [[nodiscard]] bool is_certain(int begin, int end) const {
    return std::find(marked_.begin() + begin, marked_.begin() + end, 0) == marked_.begin() + end;
  }

  // Whether most other joints move much less: a calibration pose at the origin is a jump of all.
  [[nodiscard]] bool jumps_alone(int from, int to) const {
    const double jump = (place(to) - place(from)).norm();
    int calm = 0;
    for (int joint = 0; joint < motion_.joint_count; ++joint) {
      const Vector3d step = motion_.position(to, joint) - motion_.position(from, joint);
      calm += step.norm() < 0.5 * jump ? 1 : 0;
    }
    return 2 * calm > motion_.joint_count;
  }

  [[nodiscard]] const Vector3d& place(int frame) const { return motion_.position(frame, joint_); }
  [[nodiscard]] bool may_be_lost(int frame) const {
    return place(frame).array().isNaN().all() || (markers_are_lost_ && is_marker(place(frame)));
  }

  JointMotion& motion_;
  int joint_;
  const std::vector<char>& marked_;
  bool markers_are_lost_;
};

}  // namespace

std::optional<LostPoint> bridge_lost_points(JointMotion& motion) {
  std::optional<LostPoint> too_long;
  const std::vector<char> marked = frames_with_markers(motion);
  std::vector<std::string> joints;
  int most = 0;
  for (int joint = 0; joint < motion.joint_count; ++joint) {
    LostPoints points(motion, joint, marked);
    const int lost = points.bridge();
    const auto gap = points.long_gap();
    if (gap && !too_long) too_long = {joint, *gap};
    if (lost == 0) continue;
    const auto at = static_cast<std::size_t>(joint);
    joints.push_back(at < motion.names.size() ? motion.names[at] : std::to_string(joint));
    most = std::max(most, lost);
  }
  if (joints.empty()) return too_long;
  motion.warnings.push_back(
      {0, 0,
       fmt::format(
           "{} untracked (NaN, or three equal coordinates such as 0) in up to {} of {} frames, "
           "interpolated or held: {}",
           count_text(joints.size(), "joint"), most, motion.frame_count, list_names(joints, 8))});
  return too_long;
}

}  // namespace retarget

#include "human/skeleton/source_hands.h"

#include <algorithm>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>

#include "human/skeleton/joint_names.h"
#include "retarget/human_skeleton.h"
#include "retarget/so3.h"

namespace retarget {
namespace {

constexpr double kNoWay = 1e-9;
// Last bone per previous bone, including the soft tip: Buryanov and Kotiuk 2010 (docs/hands.md).
constexpr double kLastBone = 0.9;

struct FingerSigns {
  Finger finger;
  std::vector<std::string_view> words;
};

const std::vector<FingerSigns>& finger_signs() {
  // The Japanese signs mean: parent's, pointing, middle, ring (medicine), little finger.
  static const std::vector<FingerSigns> kSigns = {
      {Finger::kThumb, {"thumb", "\xE8\xA6\xAA\xE6\x8C\x87"}},
      {Finger::kIndex,
       {"index", "\xE4\xBA\xBA\xE6\x8C\x87", "\xE4\xBA\xBA\xE5\xB7\xAE\xE6\x8C\x87",
        "secondproximal", "secondmetacarpal", "secondmc"}},
      {Finger::kMiddle,
       {"middle", "mid", "\xE4\xB8\xAD\xE6\x8C\x87", "thirdproximal", "thirdmetacarpal",
        "thirdmc"}},
      {Finger::kRing,
       {"ring", "\xE8\x96\xAC\xE6\x8C\x87", "fourthproximal", "fourthmetacarpal", "fourthmc"}},
      {Finger::kLittle,
       {"pinky", "little", "pinkie", "\xE5\xB0\x8F\xE6\x8C\x87", "fifthproximal", "fifthmetacarpal",
        "fifthmc"}}};
  return kSigns;
}

std::optional<Finger> finger_by_word(const std::string& base) {
  if (base.find("string") != std::string::npos || base.find("spring") != std::string::npos) {
    return std::nullopt;
  }
  for (const auto& [finger, words] : finger_signs()) {
    for (const std::string_view word : words) {
      if (base.find(word) != std::string::npos) return finger;
    }
  }
  if (base.starts_with("firstmetacarpal") || base.starts_with("firstmc")) return Finger::kThumb;
  return std::nullopt;
}

// Number in `finger0`, `finger21`, `finger3metacarpal`; its first digit is the finger.
std::optional<int> finger_number(const std::string& base) {
  constexpr std::string_view kWord = "finger";
  const std::size_t at = base.find(kWord);
  if (at == std::string::npos || at + kWord.size() >= base.size()) return std::nullopt;
  const char digit = base[at + kWord.size()];
  return digit >= '0' && digit <= '5' ? std::optional(digit - '0') : std::nullopt;
}

bool names_metacarpal(const std::string& base) {
  return base.find("metacarpal") != std::string::npos || base.find("inhand") != std::string::npos;
}

// Joint position relative to the wrist with all rotations zero.
Eigen::Vector3d zero_place(const Skeleton& skeleton, int wrist, int joint) {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  for (; joint != wrist; joint = skeleton.joint(joint).parent) {
    place += skeleton.joint(joint).offset;
  }
  return place;
}

struct Chain {
  SourceFinger finger;
  std::optional<Finger> word;
  std::optional<int> number;
  Eigen::Vector3d base = Eigen::Vector3d::Zero(), way = Eigen::Vector3d::Zero();
};

class FingerFinder {
 public:
  FingerFinder(const Skeleton& skeleton, const std::vector<JointName>& names, int wrist)
      : skeleton_(skeleton),
        names_(names),
        wrist_(wrist),
        children_(static_cast<std::size_t>(skeleton.joint_count())),
        depth_(children_.size(), 1) {
    for (int joint = 1; joint < skeleton.joint_count(); ++joint) {
      children_[static_cast<std::size_t>(skeleton.joint(joint).parent)].push_back(joint);
    }
    // Parents precede their children, so the reverse order visits children first.
    for (int joint = skeleton.joint_count() - 1; joint > 0; --joint) {
      const auto parent = static_cast<std::size_t>(skeleton.joint(joint).parent);
      depth_[parent] = std::max(depth_[parent], depth_[static_cast<std::size_t>(joint)] + 1);
    }
  }

  std::vector<SourceFinger> find();

 private:
  void collect();
  [[nodiscard]] const std::vector<int>& children(int joint) const {
    return children_[static_cast<std::size_t>(joint)];
  }
  [[nodiscard]] std::vector<int> path_from(int first) const;
  [[nodiscard]] bool set_line(Chain& chain) const;
  void drop_metacarpal(Chain& chain) const;
  void name_by_numbers();
  bool name_by_shape();

  const Skeleton& skeleton_;
  const std::vector<JointName>& names_;
  int wrist_;
  std::vector<std::vector<int>> children_;
  std::vector<int> depth_;  // Joints on the longest path down, including the joint itself.
  std::vector<Chain> chains_;
};

std::vector<int> FingerFinder::path_from(int first) const {
  std::vector<int> path = {first};
  while (!children(path.back()).empty()) {
    path.push_back(*std::ranges::max_element(children(path.back()), {}, [&](int child) {
      return depth_[static_cast<std::size_t>(child)];
    }));
  }
  return path;
}

// A chain begins at a joint with a finger's name, or at a branch of a joint with several children.
void FingerFinder::collect() {
  std::vector<int> waiting = children(wrist_);
  for (std::size_t i = 0; i < waiting.size(); ++i) {
    const int joint = waiting[i];
    const std::string& base = names_[static_cast<std::size_t>(joint)].base;
    Chain chain;
    chain.word = finger_by_word(base);
    chain.number = finger_number(base);
    const std::vector<int>& next = children(joint);
    if (chain.word || chain.number || next.size() < 2) {
      chain.finger.joints = path_from(joint);
      chains_.push_back(std::move(chain));
    } else {
      waiting.insert(waiting.end(), next.begin(), next.end());
    }
  }
}

// A first joint much closer to the wrist than the second one is a metacarpal, not a knuckle.
void FingerFinder::drop_metacarpal(Chain& chain) const {
  constexpr double kNearWrist = 0.55;
  std::vector<int>& joints = chain.finger.joints;
  const std::string& base = names_[static_cast<std::size_t>(joints.front())].base;
  if (joints.size() < 3) return;
  const double first = zero_place(skeleton_, wrist_, joints[0]).norm();
  const double second = zero_place(skeleton_, wrist_, joints[1]).norm();
  if (!names_metacarpal(base) && !(first < kNearWrist * second)) return;
  joints.erase(joints.begin());
}

// Finds the end of a chain. Returns false if the chain has no direction.
bool FingerFinder::set_line(Chain& chain) const {
  constexpr std::size_t kBones = 3;  // A fourth joint is the tip.
  constexpr double kBone = 0.15;     // Share of the previous bone; shorter end sites are not tips.
  std::vector<int>& joints = chain.finger.joints;
  if (joints.size() > kBones + 1) joints.resize(kBones + 1);
  const Joint& last = skeleton_.joint(joints.back());
  const Eigen::Vector3d end = farthest_end(last);
  const bool is_tip = joints.size() > kBones;
  chain.finger.end.setZero();
  if (!is_tip && end.norm() > kBone * last.offset.norm()) {
    chain.finger.end = end;
  } else if (!is_tip && joints.size() > 1) {
    chain.finger.end = kLastBone * last.offset;
  }
  chain.base = zero_place(skeleton_, wrist_, joints.front());
  chain.way = zero_place(skeleton_, wrist_, joints.back()) + chain.finger.end - chain.base;
  return joints.size() > 1 && chain.way.norm() > kNoWay;
}

// 3ds Max counts from 0, others from 1. If there is a 0, it is the thumb.
void FingerFinder::name_by_numbers() {
  const bool from_zero =
      std::ranges::any_of(chains_, [](const Chain& chain) { return chain.number == 0; });
  for (Chain& chain : chains_) {
    if (chain.word || !chain.number) continue;
    const int index = *chain.number - (from_zero ? 0 : 1);
    if (index >= 0 && index < static_cast<int>(kFingerCount)) {
      chain.word = kFingers[static_cast<std::size_t>(index)];
    }
  }
}

// Names fingers by shape: the thumb begins nearest to the wrist and points another way.
bool FingerFinder::name_by_shape() {
  if (chains_.size() < 3 || chains_.size() > kFingerCount) return false;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Chain& chain : chains_) mean += chain.way.normalized();
  const auto distinctness = [&](const Chain& chain) {
    return chain.base.norm() / (chain.base + chain.way).norm() +
           chain.way.normalized().dot(mean) / static_cast<double>(chains_.size());
  };
  const auto thumb = std::ranges::min_element(chains_, {}, distinctness);
  std::swap(chains_.front(), *thumb);
  const Eigen::Vector3d from = chains_.front().base + chains_.front().way;
  std::sort(chains_.begin() + 1, chains_.end(), [&](const Chain& a, const Chain& b) {
    return (a.base - from).norm() < (b.base - from).norm();
  });
  for (std::size_t i = 0; i < chains_.size(); ++i) chains_[i].word = kFingers[i];
  return true;
}

std::vector<SourceFinger> FingerFinder::find() {
  collect();
  name_by_numbers();
  const auto is_named = [](const Chain& chain) { return chain.word.has_value(); };
  const bool named = std::ranges::count_if(chains_, is_named) >= 2;
  if (named) std::erase_if(chains_, [&](const Chain& chain) { return !is_named(chain); });
  const auto has_no_line = [&](Chain& chain) { return !set_line(chain); };
  if (!named) {
    std::erase_if(chains_, has_no_line);
    if (!name_by_shape()) return {};
  }
  // A thumb begins at the wrist; the metacarpals of other fingers are not part of them.
  for (Chain& chain : chains_) {
    if (chain.word != Finger::kThumb) drop_metacarpal(chain);
  }
  std::erase_if(chains_, has_no_line);
  std::vector<SourceFinger> fingers;
  for (const Finger finger : kFingers) {
    // If several chains have one name, use the one with the most joints.
    const Chain* best = nullptr;
    for (const Chain& chain : chains_) {
      if (chain.word != finger) continue;
      if (best == nullptr || chain.finger.joints.size() > best->finger.joints.size()) best = &chain;
    }
    if (best == nullptr) continue;
    fingers.push_back(best->finger);
    fingers.back().finger = finger;
  }
  const auto beside_thumb = std::ranges::count_if(
      fingers, [](const SourceFinger& f) { return f.finger != Finger::kThumb; });
  return beside_thumb < 2 ? std::vector<SourceFinger>() : fingers;
}

}  // namespace

SourceHands find_source_hands(const Skeleton& skeleton, const BoneMap& map) {
  SourceHands hands;
  const std::vector<JointName> names = normalise_joint_names(skeleton.names());
  for (std::size_t side = 0; side < hands.size(); ++side) {
    const int wrist = map.joint(side_bone(kSides[side], LimbBone::kHand));
    if (wrist < 0) continue;
    std::vector<SourceFinger> fingers = FingerFinder(skeleton, names, wrist).find();
    if (!fingers.empty()) hands[side] = SourceHand{kSides[side], wrist, std::move(fingers)};
  }
  return hands;
}

Eigen::Vector3d FingerLine::at(double share) const {
  double rest = share * length;
  for (int i = 1; i < point_count; ++i) {
    const Eigen::Vector3d bone = points[i] - points[i - 1];
    const double norm = bone.norm();
    if (rest <= norm || i + 1 == point_count) {
      return points[i - 1] + (norm > 0.0 ? std::min(rest / norm, 1.0) : 0.0) * bone;
    }
    rest -= norm;
  }
  return points[0];
}

HandPoser::HandPoser(const Clip& clip, const SourceHand& hand)
    : clip_(clip),
      hand_(hand),
      place_(static_cast<std::size_t>(clip.skeleton().joint_count()), -1) {
  // Joints between the wrist and the fingers also turn the fingers.
  std::vector<char> needed(place_.size(), 0);
  for (const SourceFinger& finger : hand.fingers) {
    for (int joint = finger.joints.back(); joint != hand.wrist;
         joint = clip.skeleton().joint(joint).parent) {
      needed[static_cast<std::size_t>(joint)] = 1;
    }
  }
  for (std::size_t joint = 0; joint < needed.size(); ++joint) {
    if (needed[joint] == 0) continue;
    place_[joint] = static_cast<int>(joints_.size());
    joints_.push_back(static_cast<int>(joint));
  }
  wrist_from_joint_.resize(joints_.size());
}

bool HandPoser::shape(int frame, HandShape& shape) {
  const Skeleton& skeleton = clip_.skeleton();
  const auto rotations = clip_.rotations(frame);
  const auto pose_of = [&](int joint) -> Pose& {
    return wrist_from_joint_[static_cast<std::size_t>(place_[static_cast<std::size_t>(joint)])];
  };
  for (const int joint : joints_) {
    const int parent = skeleton.joint(joint).parent;
    const Pose local{rotations[static_cast<std::size_t>(joint)], clip_.translation(frame, joint)};
    pose_of(joint) = parent == hand_.wrist ? local : pose_of(parent) * local;
  }
  Eigen::Vector3d knuckles = Eigen::Vector3d::Zero();
  const SourceFinger* first = nullptr;
  int count = 0;
  for (const SourceFinger& finger : hand_.fingers) {
    if (finger.finger == Finger::kThumb) continue;
    knuckles += pose_of(finger.joints.front()).translation;
    if (first == nullptr) first = &finger;
    ++count;
  }
  if (first == nullptr) return false;
  const Eigen::Vector3d along = knuckles / count;
  const Eigen::Vector3d across = pose_of(first->joints.front()).translation -
                                 pose_of(hand_.fingers.back().joints.front()).translation;
  const double side = hand_.side == Side::kLeft ? 1.0 : -1.0;
  const Eigen::Vector3d normal = side * along.cross(across);
  if (!(normal.norm() > 1e-6 * along.squaredNorm())) return false;
  Eigen::Matrix3d axes;
  axes.col(0) = along.normalized();
  axes.col(2) = normal.normalized();
  axes.col(1) = side * axes.col(2).cross(axes.col(0));
  shape = HandShape();
  for (const SourceFinger& finger : hand_.fingers) {
    FingerLine& line = shape.line(finger.finger);
    const auto add = [&](const Eigen::Vector3d& point) {
      line.points[line.point_count] = axes.transpose() * point;
      if (line.point_count > 0) {
        line.length += (line.points[line.point_count] - line.points[line.point_count - 1]).norm();
      }
      ++line.point_count;
    };
    for (const int joint : finger.joints) add(pose_of(joint).translation);
    if (!finger.end.isZero(0.0)) add(pose_of(finger.joints.back()) * finger.end);
  }
  return true;
}

namespace {

// Whether a fingertip is at another place than in another shape of the hand.
bool tips_differ(const HandShape& a, const HandShape& b) {
  constexpr double kDiffers = 0.02;  // Share of the finger's length.
  return std::ranges::any_of(kFingers, [&](Finger finger) {
    const FingerLine &one = a.line(finger), &other = b.line(finger);
    return one.is_there() && other.is_there() &&
           (one.tip() - other.tip()).norm() > kDiffers * one.length;
  });
}

// The sum of a finger's bends at the knuckle, from the direction of the palm, and at the next joint;
// radians. Files without recorded fingers may have any rotation at the last joint.
double inner_bend(const FingerLine& line) {
  Eigen::Vector3d before = Eigen::Vector3d::UnitX();
  double sum = 0.0;
  for (int i = 1; i < std::min(line.point_count, 3); ++i) {
    const Eigen::Vector3d bone = line.points[i] - line.points[i - 1];
    if (!(bone.norm() > 0.0)) continue;
    sum += angle_between(before, bone);
    before = bone;
  }
  return sum;
}

}  // namespace

bool fingers_move(const Clip& clip, const SourceHand& hand, const FrameRange& part) {
  HandPoser poser(clip, hand);
  HandShape start, shape;
  bool has_start = false;
  for (int frame = part.begin; frame < part.end; ++frame) {
    if (!poser.shape(frame, has_start ? shape : start)) continue;
    if (std::exchange(has_start, true) && tips_differ(start, shape)) return true;
  }
  return false;
}

bool fingers_are_closed(const Clip& clip, const SourceHand& hand, int frame) {
  constexpr double kClosed = 110.0 * std::numbers::pi / 180.0;
  HandShape shape;
  if (!HandPoser(clip, hand).shape(frame, shape)) return false;
  return std::ranges::any_of(kFingers, [&](Finger finger) {
    return finger != Finger::kThumb && inner_bend(shape.line(finger)) > kClosed;
  });
}

bool fingers_leave_rest(const Clip& clip, const SourceHand& hand, int frame) {
  const Clip at_rest = clip.empty_like(clip.rate(), 1);
  HandShape rest, shape;
  return HandPoser(at_rest, hand).shape(0, rest) && HandPoser(clip, hand).shape(frame, shape) &&
         tips_differ(shape, rest);
}

}  // namespace retarget

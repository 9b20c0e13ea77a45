#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <tuple>

#include "retarget/contact_plan.h"
#include "retarget/motion_io.h"
#include "retarget/robot.h"
#include "retarget/solve.h"
#include "solve/targets/support_bodies.h"

namespace retarget {
namespace {

constexpr std::array<std::string_view, kSupportBones.size()> kPartNames = {
    "left_knee", "right_knee", "left_elbow", "right_elbow",
    "left_hand", "right_hand", "seat",       "back"};

class LabelMaker {
 public:
  explicit LabelMaker(const Motion& motion) : motion_(motion), robot_(motion.clip.robot()) {
    labels_.frame_count = motion.clip.frame_count();
  }

  ContactLabels make() {
    add_feet();
    if (motion_.scene) add_parts();
    std::ranges::stable_sort(labels_.touches, {}, [](const SurfaceTouch& touch) {
      return std::tuple(rank(touch.part), touch.surface != kFloorName);
    });
    return std::move(labels_);
  }

 private:
  // Feet before other parts, in the order of their tables.
  static std::size_t rank(const std::string& part) {
    const auto foot = std::ranges::find(kContactNames, part);
    if (foot != kContactNames.end()) return static_cast<std::size_t>(foot - kContactNames.begin());
    return kContactNames.size() +
           static_cast<std::size_t>(std::ranges::find(kPartNames, part) - kPartNames.begin());
  }

  [[nodiscard]] std::string surface(int body) const {
    if (body == kFloorBody) return kFloorName;
    return motion_.scene->clip.scene->bodies[static_cast<std::size_t>(body)].name;
  }

  // The body of a foot's sole; empty: the robot has none on this side.
  [[nodiscard]] std::string foot(std::string_view side) const {
    for (const Sole& sole : robot_.profile().soles) {
      if (sole.side == side) return robot_.bodies()[static_cast<std::size_t>(sole.body)].name;
    }
    return {};
  }

  void add(const SurfaceTouch& touch) {
    const int end = std::min(touch.end, labels_.frame_count);
    if (touch.begin >= end) return;
    labels_.touches.push_back(touch);
    labels_.touches.back().end = end;
  }

  void add_feet() {
    for (std::size_t end = 0; end < kContactNames.size(); ++end) {
      const std::string part(kContactNames[end]);
      const std::string link = foot(part.substr(0, part.find('_')));
      if (link.empty()) continue;
      const auto& phases = motion_.contacts[end];
      for (std::size_t i = 0; i < phases.size(); ++i) {
        const bool known = motion_.scene && i < motion_.scene->under_feet[end].size();
        add({part, link, surface(known ? motion_.scene->under_feet[end][i] : kFloorBody),
             phases[i].begin, phases[i].end});
      }
    }
  }

  // The fit holds contacts of parts that the robot has.
  void add_parts() {
    for (const SupportBody& body : support_bodies(robot_, motion_.plan.config)) {
      const auto link = static_cast<std::size_t>(body.link);
      const auto of_link = static_cast<std::size_t>(robot_.tree().links()[link].body);
      for (const auto* contacts : {&motion_.scene->on_floor, &motion_.scene->contacts}) {
        for (const SceneContact& contact : *contacts) {
          if (contact.part != kSupportBones[body.support]) continue;
          add({std::string(kPartNames[body.support]), robot_.bodies()[of_link].name,
               surface(contact.body), contact.begin, contact.end, contact.slides});
        }
      }
    }
  }

  const Motion& motion_;
  const Robot& robot_;
  ContactLabels labels_;
};

}  // namespace

ContactLabels contact_labels(const Motion& motion) {
  return LabelMaker(motion).make();
}

}  // namespace retarget

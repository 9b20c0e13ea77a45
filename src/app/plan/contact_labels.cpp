#include "app/plan/contact_labels.h"

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

class LabelMaker {
 public:
  LabelMaker(const Robot& robot, const ResolvedConfig& config, int frame_count,
             const SourceContacts& feet, const SolvedScene* scene)
      : robot_(robot), config_(config), feet_(feet), scene_(scene) {
    labels_.frame_count = frame_count;
  }

  ContactLabels make() {
    add_feet();
    if (scene_ != nullptr) add_parts();
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
           static_cast<std::size_t>(std::ranges::find(kSupportNames, part) - kSupportNames.begin());
  }

  [[nodiscard]] std::string surface(int body) const {
    if (body == kFloorBody) return kFloorName;
    return scene_->clip.scene->bodies[static_cast<std::size_t>(body)].name;
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
      const auto& phases = feet_[end];
      for (std::size_t i = 0; i < phases.size(); ++i) {
        const bool known = scene_ != nullptr && i < scene_->under_feet[end].size();
        add({part, link, surface(known ? scene_->under_feet[end][i] : kFloorBody), phases[i].begin,
             phases[i].end});
      }
    }
  }

  // The fit holds contacts of parts that the robot has.
  void add_parts() {
    for (const SupportBody& body : support_bodies(robot_, config_)) {
      const auto link = static_cast<std::size_t>(body.link);
      const auto of_link = static_cast<std::size_t>(robot_.tree().links()[link].body);
      for (const auto* contacts : {&scene_->on_floor, &scene_->contacts}) {
        for (const SceneContact& contact : *contacts) {
          if (contact.part != kSupportBones[body.support]) continue;
          add({std::string(kSupportNames[body.support]), robot_.bodies()[of_link].name,
               surface(contact.body), contact.begin, contact.end, contact.slides});
        }
      }
    }
  }

  const Robot& robot_;
  const ResolvedConfig& config_;
  const SourceContacts& feet_;
  const SolvedScene* scene_;
  ContactLabels labels_;
};

}  // namespace

ContactLabels make_contact_labels(const Robot& robot, const ResolvedConfig& config, int frame_count,
                                  const SourceContacts& feet, const SolvedScene* scene) {
  return LabelMaker(robot, config, frame_count, feet, scene).make();
}

ContactLabels contact_labels(const Motion& motion) {
  return make_contact_labels(motion.clip.robot(), motion.plan.config, motion.clip.frame_count(),
                             motion.contacts, motion.scene ? &*motion.scene : nullptr);
}

}  // namespace retarget

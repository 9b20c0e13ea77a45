#include <algorithm>
#include <memory>

#include "retarget/clip.h"
#include "retarget/human_poser.h"
#include "retarget/live.h"

namespace retarget {

class LivePoser::Impl {
 public:
  explicit Impl(const Plan& plan)
      : frame_(plan.clip->empty_like(plan.clip->rate(), 1)),
        calibration_(plan.human.calibration),
        poser_(frame_, calibration_) {}

  void pose(std::span<const Eigen::Quaterniond> rotations,
            std::span<const Eigen::Vector3d> translations, HumanPose& world_from_bone) {
    std::ranges::copy(rotations, frame_.rotations(0).begin());
    std::ranges::copy(translations, frame_.translations(0).begin());
    poser_.pose(0, world_from_bone);
  }

 private:
  Clip frame_;
  Calibration calibration_;
  HumanPoser poser_;
};

LivePoser::LivePoser(const Plan& plan) : impl_(std::make_unique<Impl>(plan)) {}
LivePoser::~LivePoser() = default;
LivePoser::LivePoser(LivePoser&&) noexcept = default;
LivePoser& LivePoser::operator=(LivePoser&&) noexcept = default;

void LivePoser::pose(std::span<const Eigen::Quaterniond> rotations,
                     std::span<const Eigen::Vector3d> translations, HumanPose& world_from_bone) {
  impl_->pose(rotations, translations, world_from_bone);
}

}  // namespace retarget

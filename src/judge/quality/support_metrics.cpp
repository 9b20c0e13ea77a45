#include "judge/quality/body_metrics.h"

#include <string>
#include <utility>
#include <vector>

#include "human/gait/standing_heights.h"
#include "judge/quality/contact_motion.h"
#include "judge/quality/report_parts.h"
#include "retarget/kinematic_tree.h"
#include "retarget/statistics.h"
#include "solve/targets/support_bodies.h"

namespace retarget {
namespace {

class SupportMeter {
 public:
  SupportMeter(const ReportBuilder& draft, const SourceFeet& source,
               const Eigen::Quaterniond& robot_from_human, double size, double scale)
      : draft_(draft),
        source_(source),
        robot_from_human_(robot_from_human.toRotationMatrix().topLeftCorner<2, 2>()),
        radius_(kRestingRadius * size),
        scale_(scale),
        state_(draft.clip.robot().tree()),
        slipping_("support_slip_mean", "m/s"),
        high_("support_height_p95_cm", "m") {}

  void add(const SupportBody& body, const ContactPhase& phase) {
    constexpr double kHigh = 0.03;  // metres
    const std::string& name = name_of(body);
    std::vector<Eigen::Vector3d> middles;
    SlideTracker slide(source_.support(phase.begin, body.support), radius_);
    for (int frame = phase.begin; frame < phase.end; ++frame) {
      state_.update(draft_.clip.qpos(frame));
      middles.push_back(body.world_middle(state_));
      const Eigen::Vector2d slid = slide.follow(source_.support(frame, body.support));
      middles.back().head<2>() -= scale_ * (robot_from_human_ * slid);
      const double height = body.lowest(state_).height;
      motion_.heights.push_back(height);
      if (height > kHigh) high_.add(name, frame, height);
    }
    motion_.add(middles, phase.begin, draft_.clip.rate().fps(), name, slipping_);
  }

  void finish() {
    const auto frames = static_cast<double>(motion_.heights.size());
    // Slip, drift and height are 0 if no part rests on the floor.
    if (motion_.heights.empty()) motion_.heights = motion_.drifts = {0.0};
    if (motion_.slips.empty()) motion_.slips = {0.0};
    draft_.set("support_pct", percent(frames, draft_.clip.frame_count()));
    draft_.set("support_height_p50_cm", kInCm * median(motion_.heights));
    draft_.set("support_height_p95_cm", kInCm * percentile(std::move(motion_.heights), 95.0));
    draft_.set("support_slip_mean", mean(motion_.slips));
    draft_.set("support_drift_p95_cm", kInCm * percentile(std::move(motion_.drifts), 95.0));
    slipping_.move_to(draft_.report, draft_.options.faults_per_metric);
    high_.move_to(draft_.report, draft_.options.faults_per_metric);
  }

 private:
  [[nodiscard]] const std::string& name_of(const SupportBody& body) const {
    const Robot& robot = draft_.clip.robot();
    return robot.bodies()[robot.tree().links()[body.link].body].name;
  }

  const ReportBuilder& draft_;
  const SourceFeet& source_;
  const Eigen::Matrix2d robot_from_human_;  // A constant yaw.
  double radius_, scale_;
  TreeState state_;
  ContactMotion motion_;
  FaultList slipping_, high_;
};

}  // namespace

void measure_supports(const ReportBuilder& draft, const ResolvedConfig& config,
                      const SourceFeet& source, const Eigen::Quaterniond& robot_from_human,
                      const ContactPlan& contacts, double scale) {
  const std::vector<SupportBody> bodies = support_bodies(draft.clip.robot(), config);
  if (bodies.empty()) return;
  SupportMeter meter(draft, source, robot_from_human, contacts.scale, scale);
  for (const SupportBody& body : bodies) {
    for (const ContactPhase& phase : contacts.bodies[body.support]) meter.add(body, phase);
  }
  meter.finish();
}

}  // namespace retarget

#include "quality/support_metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "math/statistics.h"
#include "pipeline/support_bodies.h"
#include "quality/fault_list.h"
#include "robot/kinematic_tree.h"

namespace retarget {
namespace {

double distance(double x, double y) {
  return std::sqrt(x * x + y * y);
}

struct SupportFigures {
  std::vector<double> slips, drifts, heights;  // m/s per step, m per phase, m per frame
};

class SupportMeter {
 public:
  explicit SupportMeter(const ReportBuilder& draft)
      : draft_(draft),
        state_(draft.clip.robot().tree()),
        slipping_("support_slip_mean", "m/s"),
        high_("support_height_p95_cm", "m") {}

  void add(const SupportBody& body, const ContactPhase& phase) {
    constexpr double kSlipping = 0.1, kHigh = 0.03;
    const std::string& name = name_of(body);
    std::vector<double> x, y;
    for (int frame = phase.begin; frame < std::min(phase.end, draft_.clip.frame_count()); ++frame) {
      state_.update(draft_.clip.qpos(frame));
      const Eigen::Vector3d middle = state_.world_from_link[body.link] * body.middle;
      const double height = lowest(body);
      figures_.heights.push_back(height);
      ++frames_;
      if (height > kHigh) high_.add(name, frame, height);
      if (!x.empty()) {
        const double step = distance(middle.x() - x.back(), middle.y() - y.back());
        figures_.slips.push_back(step * draft_.clip.rate().fps());
        if (figures_.slips.back() > kSlipping)
          slipping_.add(name, frame - 1, figures_.slips.back());
      }
      x.push_back(middle.x());
      y.push_back(middle.y());
    }
    if (x.empty()) return;
    const double x0 = median(x), y0 = median(y);
    double drift = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      drift = std::max(drift, distance(x[i] - x0, y[i] - y0));
    }
    figures_.drifts.push_back(drift);
  }

  void finish() {
    // where nothing rests on the floor nothing slips, and nothing is too high
    if (figures_.heights.empty()) figures_.heights = figures_.drifts = {0.0};
    if (figures_.slips.empty()) figures_.slips = {0.0};
    draft_.set("support_pct", percent(frames_, draft_.clip.frame_count()));
    draft_.set("support_height_p50_cm", kInCm * median(figures_.heights));
    draft_.set("support_height_p95_cm", kInCm * percentile(std::move(figures_.heights), 95.0));
    draft_.set("support_slip_mean", mean(figures_.slips));
    draft_.set("support_drift_p95_cm", kInCm * percentile(std::move(figures_.drifts), 95.0));
    slipping_.move_to(draft_.report, draft_.options.faults_per_metric);
    high_.move_to(draft_.report, draft_.options.faults_per_metric);
  }

 private:
  [[nodiscard]] double lowest(const SupportBody& body) const {
    double height = std::numeric_limits<double>::infinity();
    for (const SupportBody::Point& point : body.points) {
      height =
          std::min(height, (state_.world_from_link[point.link] * point.in_link).z() - point.radius);
    }
    return height;
  }

  [[nodiscard]] const std::string& name_of(const SupportBody& body) const {
    const Robot& robot = draft_.clip.robot();
    return robot.bodies()[robot.tree().links()[body.link].body].name;
  }

  const ReportBuilder& draft_;
  TreeState state_;
  SupportFigures figures_;
  int frames_ = 0;  // of all contacts
  FaultList slipping_, high_;
};

}  // namespace

void measure_supports(const ReportBuilder& draft, const ResolvedConfig& config,
                      const ContactPlan& contacts) {
  const std::vector<SupportBody> bodies = support_bodies(draft.clip.robot(), config);
  if (bodies.empty()) return;
  SupportMeter meter(draft);
  for (const SupportBody& body : bodies) {
    for (const ContactPhase& phase : contacts.bodies[body.support]) meter.add(body, phase);
  }
  meter.finish();
}

}  // namespace retarget

#include "app/plan/path_scale.h"

#include "base/faults.h"
#include "base/try.h"
#include "human/skeleton/human_clip.h"
#include "solve/fit/fit_setup.h"
#include "solve/targets/targets.h"

namespace retarget {

Result<double> foot_path_scale(const Clip& clip, const Plan& plan) {
  HumanPoser poser(clip, plan.human.calibration);
  TRY_ASSIGN(const TargetBuilder targets,
             located(make_targets(poser.info(), poses_of(poser), *plan.robot.robot, plan.config,
                                  plan.scale),
                     clip.name()));
  return path_scales(targets).foot;
}

}  // namespace retarget

#pragma once

/// The main interface of the library: from a motion file to a robot's motion.
///
///     auto robot = retarget::load_robot("unitree_g1");
///     auto clip = retarget::load_clip("walk.bvh");
///     auto plan = retarget::make_plan(*clip, *robot);
///     auto motion = retarget::solve(*plan);
///     auto saved = retarget::save(*motion, "walk.csv");
///
/// Each returns a Result, which holds a value or an error; options and defaults match the command
/// line.

#include "retarget/error.h"
#include "retarget/load.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/report.h"
#include "retarget/solve.h"
#include "retarget/version.h"
#include "retarget/view.h"

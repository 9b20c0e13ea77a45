#include "stored.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <mutex>
#include <span>
#include <utility>

#include "retarget/hash.h"
#include "retarget/option_table.h"
#include "retarget/restore_motion.h"
#include "retarget/retargeting_config.h"
#include "retarget/try.h"
#include "stored_values.h"
#include "tables.h"

namespace retarget::python {
namespace {

namespace fs = std::filesystem;

StoredOptions stored_rows(const OptionTable& table) {
  StoredOptions all;
  for (const Option& row : table) all.push_back({row.name, row.get()});
  return all;
}

// Sets the rows that differ. A row may change others (a preset), so the passes repeat.
Result<void> restore_rows(const OptionTable& table, const StoredOptions& stored) {
  for (int pass = 0; pass < 3; ++pass) {
    bool same = true;
    for (const auto& [name, value] : stored) {
      const Option* row = find_option(table, name);
      if (row == nullptr) return usage_failure("the pickle has the unknown option " + name);
      const OptionValue now = row->get();
      if (now.index() != value.index()) return usage_failure("the pickle is damaged");
      // As texts: NaN stands for an option that is not given, and must equal itself.
      if (to_text(now) == to_text(value)) continue;
      same = false;
      RETARGET_TRY(row->set(value));
    }
    if (same) return {};
  }
  return usage_failure("the options of the pickle contradict each other");
}

// The decisions that a plan makes from files: the numbers of limits, configuration and calibration.
Result<std::string> decisions_of(const Plan& plan) {
  ArchiveWriter archive;
  archive(plan.part.begin, plan.part.end, plan.rate, plan.limits.lower, plan.limits.upper,
          plan.scale, plan.config.root_body, plan.config.root_bone, plan.config.ground_height);
  for (const double scale : plan.config.scales) archive(scale);
  for (const ResolvedConfig::Table& table : plan.config.match_tables) {
    archive(table.used);
    for (const ConfigTask& task : table.tasks) {
      archive(task.body, task.bone, task.position_weight, task.rotation_weight,
              task.position_offset, task.rotation_offset, task.rotation_is_guess);
    }
  }
  FitOptions fit = plan.fit;
  archive(stored_rows(fit_table(fit)));
  const Calibration& calibration = plan.human.calibration;
  archive(calibration.metres_per_unit, calibration.height, calibration.size);
  for (const BoneSource& bone : calibration.bones) {
    archive(bone.position_joint, bone.rotation_joint, bone.joint_from_bone, bone.position_in_joint);
    if (bone.twist_joint >= 0) archive(bone.twist_joint, bone.twist_from_bone);
  }
  archive(plan.scene);
  for (const ObjectTrack& track : plan.object_tracks) {
    archive(track.body, track.world_from_body);
    for (const StatedContact& stated : track.contacts) archive(stated.part, stated.touches);
  }
  return hash_bytes(archive.take());
}

std::string absolute_if_there(const std::string& path) {
  std::error_code ignored;
  if (path.empty() || !fs::exists(path, ignored)) return path;
  const fs::path whole = fs::absolute(path, ignored);
  return ignored ? path : whole.string();
}

Result<StoredRobot> stored_robot(const RobotHandle& robot) {
  if (robot.hash.empty()) {
    return run_failure(robot.loaded.model,
                       "the files of the robot cannot be read, so it cannot be pickled");
  }
  RobotChoice choice = robot.loaded.choice;
  // A worker process may have another working directory.
  for (std::string* path : {&choice.name, &choice.model, &choice.profile}) {
    const bool is_path = path != &choice.name || path->find('/') != std::string::npos;
    if (is_path) *path = absolute_if_there(*path);
  }
  StoredRobot stored{stored_rows(robot_table(choice)), {}, robot->variant().name, robot.hash};
  const auto usual = data_folder_of({});
  const bool is_usual = usual && *usual == robot.loaded.data_folder;
  if (!is_usual) stored.data_folder = absolute_if_there(robot.loaded.data_folder);
  return stored;
}

Result<LoadedRobot> load_again(const StoredRobot& stored) {
  RobotChoice choice;
  RETARGET_TRY(restore_rows(robot_table(choice), stored.choice));
  RETARGET_TRY_ASSIGN(const std::string folder, data_folder_of(stored.data_folder));
  auto loaded = load_robot(choice, DataFolder{folder});
  if (!loaded) {
    loaded.error().message = "the robot of the pickle cannot be loaded: " + loaded.error().message;
    return loaded;
  }
  if (model_hash(*loaded) != stored.hash) {
    return config_failure(loaded->model,
                          "the model is not the one of the pickle: its content has changed",
                          "restore the model, or make the pickle again");
  }
  // The columns of a motion's file may be those of a variant.
  if (loaded->robot->variant().name != stored.variant) {
    auto whole = loaded->robot->whole() ? loaded->robot->whole() : loaded->robot;
    RETARGET_TRY_ASSIGN(loaded->robot, robot_variant(whole, stored.variant));
  }
  return loaded;
}

Result<StoredPlan> stored_plan(const Plan& plan, const std::shared_ptr<const Clip>& clip,
                               const RobotHandle& robot) {
  StoredPlan all;
  all.clip = stored(ClipHandle(clip));
  RETARGET_TRY_ASSIGN(all.robot, stored(robot));
  Options options = plan.options;
  all.options = stored_rows(solving_table(options));
  all.fit = stored_rows(fit_table(options.solve.fit));
  all.fit_given = options.solve.fit_given;
  RETARGET_TRY_ASSIGN(all.decisions, decisions_of(plan));
  all.time_scale = plan.time_scale;
  return all;
}

Result<void> check_time_scale(const TimeScale& scale) {
  const auto is_pace = [](double pace) { return pace >= 1.0 && pace <= 1.0 / kLeastTimeScale; };
  if (scale.knot_time >= 1e-3 && scale.knot_time <= 1e3 &&
      std::ranges::all_of(scale.pace, is_pace)) {
    return {};
  }
  return usage_failure("the pickle is damaged");
}

struct PlanAgain {
  Plan plan;
  RobotHandle robot;
  std::shared_ptr<const Clip> clip;
};

Result<PlanAgain> plan_again(const StoredPlan& stored) {
  RETARGET_TRY_ASSIGN(const ClipHandle clip, clip_of_bytes(stored.clip));
  RETARGET_TRY_ASSIGN(RobotHandle robot, robot_of_bytes(stored.robot));
  Options options;
  options.solve.fit_given = stored.fit_given;
  RETARGET_TRY(restore_rows(solving_table(options), stored.options));
  RETARGET_TRY(restore_rows(fit_table(options.solve.fit), stored.fit));
  RETARGET_TRY_ASSIGN(Plan plan, make_plan(*clip, robot.loaded, options));
  RETARGET_TRY_ASSIGN(const std::string decisions, decisions_of(plan));
  if (decisions != stored.decisions) {
    return config_failure(clip->name(),
                          "the plan of the pickle cannot be made again: a file that its options "
                          "name, or a configuration of the robot, has changed",
                          "restore the file, or make the pickle again");
  }
  if (stored.time_scale) {
    RETARGET_TRY(check_time_scale(*stored.time_scale));
    plan.time_scale = stored.time_scale;
  }
  return PlanAgain{std::move(plan), std::move(robot), clip.shared()};
}

StoredRun stored_run(const RecordedRun& recorded) {
  Run run = recorded.run;
  StoredRun all;
  all.motion = run.motion;
  all.robot = stored_rows(robot_table(run.robot));
  all.options = stored_rows(solving_table(run.options));
  all.fit = stored_rows(fit_table(run.options.solve.fit));
  all.fit_given = run.options.solve.fit_given;
  all.mirror = recorded.mirror;
  all.source_hash = recorded.source_hash;
  all.limits = recorded.limits;
  all.time_scale = recorded.time_scale;
  return all;
}

Result<std::shared_ptr<const RecordedRun>> run_again(StoredRun stored) {
  RecordedRun recorded;
  Run& run = recorded.run;
  run.motion = std::move(stored.motion);
  RETARGET_TRY(restore_rows(robot_table(run.robot), stored.robot));
  run.options.solve.fit_given = std::move(stored.fit_given);
  RETARGET_TRY(restore_rows(solving_table(run.options), stored.options));
  RETARGET_TRY(restore_rows(fit_table(run.options.solve.fit), stored.fit));
  recorded.mirror = stored.mirror;
  recorded.source_hash = std::move(stored.source_hash);
  recorded.limits = std::move(stored.limits);
  if (stored.time_scale) {
    RETARGET_TRY(check_time_scale(*stored.time_scale));
  }
  recorded.time_scale = std::move(stored.time_scale);
  return std::make_shared<const RecordedRun>(std::move(recorded));
}

Result<void> check_phases(const SourceContacts& contacts, int frames) {
  for (const auto& phases : contacts) {
    for (const ContactPhase& phase : phases) {
      if (phase.begin < 0 || phase.end > frames) return usage_failure("the pickle is damaged");
    }
  }
  return {};
}

Result<std::shared_ptr<const Motion>> solution_again(StoredSolution stored, const RobotClip& clip,
                                                     RobotHandle& robot,
                                                     std::shared_ptr<const Clip>& made_from) {
  RETARGET_TRY(check_phases(stored.contacts, clip.frame_count()));
  RETARGET_TRY_ASSIGN(PlanAgain again, plan_again(stored.plan));
  auto motion = std::make_shared<Motion>();
  RETARGET_TRY_ASSIGN(motion->source, prepare_clip(again.plan));
  motion->scene = std::move(stored.scene);
  if (motion->scene) {
    RETARGET_TRY_ASSIGN(motion->scene->human, restore_human_scene(again.plan, *motion->source));
  }
  again.plan.clip = nullptr;
  motion->clip = clip;
  motion->plan = std::move(again.plan);
  motion->ik_steps = static_cast<long>(stored.ik_steps);
  motion->fit = std::move(stored.fit);
  motion->contacts = std::move(stored.contacts);
  motion->solver_failures = std::move(stored.failures);
  robot = std::move(again.robot);
  made_from = std::move(again.clip);
  return motion;
}

}  // namespace

std::string stored(const ClipHandle& clip) {
  StoredClip all{
      clip->skeleton().joints(), clip->rate(), clip->frame_count(), {}, {}, clip->origin()};
  for (int frame = 0; frame < clip->frame_count(); ++frame) {
    for (const auto& rotation : clip->rotations(frame)) {
      const Eigen::Vector4d& xyzw = rotation.coeffs();
      all.rotations.insert(all.rotations.end(), xyzw.begin(), xyzw.end());
    }
    for (const auto& place : clip->translations(frame)) {
      all.translations.insert(all.translations.end(), place.begin(), place.end());
    }
  }
  return to_bytes(all);
}

Result<ClipHandle> clip_of_bytes(std::string_view bytes) {
  RETARGET_TRY_ASSIGN(StoredClip all, from_bytes<StoredClip>(bytes));
  const std::size_t joints = all.joints.size();
  bool sound = joints > 0 && all.frames >= 0 && all.rate.frames > 0 && all.rate.seconds > 0;
  for (std::size_t i = 0; sound && i < joints; ++i) {
    const int parent = all.joints[i].parent;
    sound = i == 0 ? parent == -1 : parent >= 0 && static_cast<std::size_t>(parent) < i;
  }
  if (!sound) return usage_failure("the pickle is damaged");
  const auto skeleton = std::make_shared<const Skeleton>(std::move(all.joints));
  const auto frames = static_cast<std::size_t>(all.frames);
  const auto moved = static_cast<std::size_t>(skeleton->translated_count());
  if (all.rotations.size() != 4 * joints * frames ||
      all.translations.size() != 3 * moved * frames) {
    return usage_failure("the pickle is damaged");
  }
  Clip clip(skeleton, all.rate, all.frames);
  const double* rotation = all.rotations.data();
  const double* place = all.translations.data();
  for (int frame = 0; frame < all.frames; ++frame) {
    for (auto& each : clip.rotations(frame)) {
      each.coeffs() = Eigen::Map<const Eigen::Vector4d>(rotation);
      rotation += 4;
    }
    for (auto& each : clip.translations(frame)) {
      each = Eigen::Map<const Eigen::Vector3d>(place);
      place += 3;
    }
  }
  clip.set_origin(std::move(all.origin));
  return ClipHandle(std::move(clip));
}

Result<std::string> stored(const RobotHandle& robot) {
  RETARGET_TRY_ASSIGN(const StoredRobot all, stored_robot(robot));
  return to_bytes(all);
}

Result<RobotHandle> robot_of_bytes(std::string_view bytes) {
  static std::mutex mutex;
  static std::map<std::string, std::weak_ptr<const LoadedRobot>, std::less<>> in_use;
  const std::lock_guard lock(mutex);
  std::erase_if(in_use, [](const auto& entry) { return entry.second.expired(); });
  RETARGET_TRY_ASSIGN(const StoredRobot all, from_bytes<StoredRobot>(bytes));
  if (const auto found = in_use.find(bytes); found != in_use.end()) {
    if (const auto loaded = found->second.lock()) return RobotHandle{*loaded, all.hash};
  }
  RETARGET_TRY_ASSIGN(LoadedRobot loaded, load_again(all));
  // The robot itself keeps the entry: a shared pointer to it that also owns the rest.
  const auto kept = std::make_shared<LoadedRobot>(loaded);
  loaded.robot = std::shared_ptr<const Robot>(kept, kept->robot.get());
  in_use.emplace(std::string(bytes), std::shared_ptr<const LoadedRobot>(kept));
  return RobotHandle{std::move(loaded), all.hash};
}

Result<std::string> stored(const PlanHandle& plan) {
  RETARGET_TRY_ASSIGN(const StoredPlan all, stored_plan(*plan.plan, plan.clip, plan.robot));
  return to_bytes(all);
}

Result<PlanHandle> plan_of_bytes(std::string_view bytes) {
  RETARGET_TRY_ASSIGN(const StoredPlan all, from_bytes<StoredPlan>(bytes));
  RETARGET_TRY_ASSIGN(PlanAgain again, plan_again(all));
  return PlanHandle{std::make_shared<const Plan>(std::move(again.plan)), std::move(again.robot),
                    std::move(again.clip)};
}

Result<std::string> stored(const MotionHandle& motion) {
  StoredMotion all;
  all.name = motion.name;
  all.summary = motion.summary;
  all.rate = motion.clip->rate();
  all.frames = motion.clip->frame_count();
  all.rate_known = motion.rate_known;
  all.contacts = motion.contacts;
  SaveOptions save = motion.save;
  all.save = stored_rows(save_table(save));
  for (int frame = 0; frame < all.frames; ++frame) {
    const std::span<const double> qpos = motion.clip->qpos(frame);
    all.qpos.insert(all.qpos.end(), qpos.begin(), qpos.end());
  }
  RETARGET_TRY_ASSIGN(all.robot, stored(motion.robot));
  if (motion.recorded) all.recorded = stored_run(*motion.recorded);
  all.is_of_file = motion.is_of_file;
  all.part_start = motion.part_start;
  if (const Motion* solved = motion.solved.get()) {
    StoredSolution& solution = all.solution.emplace();
    RETARGET_TRY_ASSIGN(solution.plan, stored_plan(solved->plan, motion.made_from, motion.robot));
    solution.ik_steps = solved->ik_steps;
    solution.fit = solved->fit;
    solution.scene = solved->scene;
    solution.contacts = solved->contacts;
    solution.failures = solved->solver_failures;
  }
  return to_bytes(all);
}

Result<MotionHandle> motion_of_bytes(std::string_view bytes) {
  RETARGET_TRY_ASSIGN(StoredMotion all, from_bytes<StoredMotion>(bytes));
  RETARGET_TRY_ASSIGN(RobotHandle robot, robot_of_bytes(all.robot));
  const auto width = static_cast<std::size_t>(robot->configuration_size());
  const bool sound = all.frames >= 0 && all.rate.frames > 0 && all.rate.seconds > 0 &&
                     all.qpos.size() == width * static_cast<std::size_t>(all.frames) &&
                     (!all.contacts || all.contacts->frame_count() == all.frames);
  if (!sound) return usage_failure("the pickle is damaged");
  RobotClip clip(robot.loaded.robot, all.rate, all.frames);
  for (int frame = 0; frame < all.frames; ++frame) {
    const auto begin = all.qpos.begin() + static_cast<std::ptrdiff_t>(width) * frame;
    std::copy_n(begin, width, clip.qpos(frame).begin());
  }
  MotionHandle motion{nullptr, nullptr, robot, nullptr, all.name, all.summary};
  RETARGET_TRY(restore_rows(save_table(motion.save), all.save));
  motion.contacts = std::move(all.contacts);
  motion.rate_known = all.rate_known;
  if (all.recorded) {
    RETARGET_TRY_ASSIGN(motion.recorded, run_again(*std::move(all.recorded)));
  }
  motion.is_of_file = all.is_of_file;
  motion.part_start = all.part_start;
  if (all.solution) {
    RETARGET_TRY_ASSIGN(motion.solved, solution_again(*std::move(all.solution), clip, motion.robot,
                                                      motion.made_from));
    motion.clip = std::shared_ptr<const RobotClip>(motion.solved, &motion.solved->clip);
  } else {
    motion.clip = std::make_shared<const RobotClip>(std::move(clip));
  }
  return motion;
}

}  // namespace retarget::python

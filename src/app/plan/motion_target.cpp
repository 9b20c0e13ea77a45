#include "app/plan/motion_target.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <utility>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/registry/format.h"
#include "retarget/appearance.h"
#include "retarget/check_options.h"
#include "retarget/file_endings.h"
#include "retarget/human.h"
#include "retarget/os.h"
#include "retarget/plan.h"
#include "retarget/reference.h"
#include "retarget/text.h"
#include "retarget/write_scene.h"

namespace retarget {

Result<MotionTarget> MotionTarget::create(const OutputItem& item) {
  if (!format_is_folder(item.format)) {
    TRY_ASSIGN(auto file, OutputFile::create(item.path));
    return MotionTarget(std::move(file));
  }
  TRY_ASSIGN(auto folder, OutputFolder::create(item.path, folder_file_names(item.format)));
  return MotionTarget(std::move(folder));
}

Result<void> MotionTarget::write(const std::vector<FormattedFile>& files) {
  if (auto* file = std::get_if<OutputFile>(&place_)) return file->write(files.front().bytes);
  for (const FormattedFile& file : files) {
    TRY(std::get<OutputFolder>(place_).write(file.name, file.bytes));
  }
  return {};
}

Result<void> MotionTarget::commit() {
  if (auto* file = std::get_if<OutputFile>(&place_)) return file->commit();
  return std::get<OutputFolder>(place_).commit();
}

std::optional<FootContacts> contacts_of(const Motion& motion) {
  // A fixed base has no floor.
  if (!motion.fit || motion.clip.robot().fixed_base()) return std::nullopt;
  FootContacts contacts;
  const int frames = motion.clip.frame_count();
  contacts.planted.assign(kContactNames.size() * static_cast<std::size_t>(frames), 0);
  for (std::size_t end = 0; end < kContactNames.size(); ++end) {
    for (const ContactPhase& phase : motion.contacts[end]) {
      for (int frame = phase.begin; frame < std::min(phase.end, frames); ++frame) {
        contacts.planted[kContactNames.size() * static_cast<std::size_t>(frame) + end] = 1;
      }
    }
  }
  return contacts;
}

HumanInWorld human_in_world(const Clip& clip, const Calibration& calibration) {
  HumanInWorld human;
  human.clip = &clip;
  human.metres_per_unit = calibration.metres_per_unit;
  human.world_from_clip.rotation = Eigen::Quaterniond(calibration.human_from_source).normalized();
  human.colours = joint_colours(clip.skeleton(), calibration);
  return human;
}

namespace {

void normalize(const StartNormalizer& start, Pose& pose) {
  std::array<double, 7> place = {pose.translation.x(), pose.translation.y(), pose.translation.z(),
                                 pose.rotation.w(),    pose.rotation.x(),    pose.rotation.y(),
                                 pose.rotation.z()};
  start.apply(place);
  pose = {{place[3], place[4], place[5], place[6]}, {place[0], place[1], place[2]}};
}

}  // namespace

StartNormalizer start_of(const Motion& motion) {
  return motion.start ? *motion.start : StartNormalizer(motion.clip);
}

void normalize_start(const StartNormalizer& start, RobotClip& clip, WriteMotionOptions& write) {
  if (write.human) normalize(start, write.human->world_from_clip);
  if (write.scene) {
    Scene scene = *write.scene->scene;
    for (SceneBody& body : scene.bodies) normalize(start, body.world_from_body);
    write.scene->scene = std::make_shared<const Scene>(std::move(scene));
    for (Pose& pose : write.scene->world_from_body) normalize(start, pose);
  }
  start.apply(clip);
}

namespace {

constexpr double kUsualRate = 200.0;

Result<void> check_reference_ending(const std::string& path) {
  const std::string ending = ending_of(path);
  if (ending == ".npz" || ending == ".csv") return {};
  return usage_failure("the reference \"" + path + "\" is neither an NPZ nor a CSV file",
                       "give a name that ends in .npz or .csv");
}

}  // namespace

Result<std::string> reference_path(const std::string& output, const SaveOptions& options) {
  if (!options.reference.empty()) {
    TRY(check_reference_ending(options.reference));
    return options.reference;
  }
  if (options.reference_rate <= 0.0) return std::string();
  if (output == "-") {
    return usage_failure(
        OPTION("reference-rate") " needs a file name if the motion goes to standard output",
        "name it with " OPTION("reference"));
  }
  std::string base = os::without_last_separators(output);
  const std::string given = ending_of(base);
  if (!given.empty() && output_ending(given) == given) base.erase(base.size() - given.size());
  return base + ".reference.npz";
}

namespace {

Result<void> add_file_beside(const std::string& path, std::string_view bytes, FilesBeside& beside) {
  TRY_ASSIGN(OutputFile file, OutputFile::create(path));
  TRY(file.write(bytes));
  beside.files.push_back(std::move(file));
  return {};
}

Result<void> add_contacts(const std::string& path, const FrameRate& rate,
                          const WriteMotionOptions& write, FilesBeside& beside) {
  if (!write.contacts) {
    return usage_failure("the motion has no contacts for " OPTION("contacts"),
                         "the fit of a robot that moves freely determines contacts, " OPTION(
                             "method") " gmr does not; NPZ, pkl-pbhc, protomotions and csv-sonic "
                                       "files can contain them");
  }
  return add_file_beside(
      path, format_contacts_csv(*write.contacts, rate, write.labels ? &*write.labels : nullptr),
      beside);
}

Result<void> add_scene_of_robot(const std::string& path, const RobotClip& clip,
                                const std::optional<SceneClip>& scene, FilesBeside& beside) {
  if (!scene) {
    return usage_failure("the motion has no scene for " OPTION("scene-out"),
                         "retarget a clip with " OPTION("scene") " FILE");
  }
  TRY_ASSIGN(const std::string text, format_scene(path, clip, *scene));
  return add_file_beside(path, text, beside);
}

Result<void> add_reference(const std::string& path, const RobotClip& clip,
                           const WriteMotionOptions& write, const SaveOptions& options,
                           const LimitSet* limits, FilesBeside& beside) {
  ReferenceOptions how;
  how.rate =
      frame_rate_from_fps(options.reference_rate > 0.0 ? options.reference_rate : kUsualRate);
  if (limits != nullptr) how.limits = *limits;
  how.planted = write.contacts;
  if (write.scene) how.scene = &*write.scene;
  how.max_bytes = memory_share(0.0);
  auto made = make_reference(clip, how);
  if (!made && made.error().location.file.empty()) made.error().location.file = path;
  TRY_ASSIGN(const MotionReference reference, std::move(made));
  std::string bytes;
  if (ending_of(path) == ".csv") {
    bytes = format_reference_csv(reference);
  } else {
    TRY_ASSIGN(bytes, format_reference_npz(reference));
  }
  TRY(add_file_beside(path, bytes, beside));
  beside.lines.push_back({"sampled", path + ": " + count_text(reference.samples, "sample") +
                                         " at " + to_text(reference.rate) + " per second"});
  for (std::string& note : reference_notes(reference)) {
    beside.lines.push_back({"", std::move(note)});
  }
  return {};
}

}  // namespace

Result<FilesBeside> write_files_beside(const std::string& reference, const RobotClip& clip,
                                       const WriteMotionOptions& write, const SaveOptions& options,
                                       const LimitSet* limits) {
  FilesBeside beside;
  if (!options.contacts.empty()) {
    TRY(add_contacts(options.contacts, clip.rate(), write, beside));
  }
  if (!options.scene_out.empty()) {
    TRY(add_scene_of_robot(options.scene_out, clip, write.scene, beside));
  }
  if (!reference.empty()) TRY(add_reference(reference, clip, write, options, limits, beside));
  return beside;
}

}  // namespace retarget

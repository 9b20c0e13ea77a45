#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "archive_fields.h"
#include "retarget/error.h"
#include "retarget/option_table.h"

// The contents of pickles (stored.h) as structs, and their bytes: a version, a checksum, the members.

namespace retarget::python {

/// Increases with every change of the stored members.
inline constexpr std::string_view kStoredVersion = "retarget pickle 3\n";

struct StoredOption {
  std::string name;
  OptionValue value;
};
using StoredOptions = std::vector<StoredOption>;

template <typename Archive>
void fields(Archive& archive, StoredOption& option) {
  archive(option.name, option.value);
}

struct StoredClip {
  std::vector<Joint> joints;
  FrameRate rate;
  int frames = 0;
  std::vector<double> rotations, translations;
  ClipOrigin origin;
};

template <typename Archive>
void fields(Archive& archive, StoredClip& clip) {
  archive(clip.joints, clip.rate, clip.frames, clip.rotations, clip.translations, clip.origin);
}

struct StoredRobot {
  StoredOptions choice;
  std::string data_folder;  // Empty: where this process finds it.
  std::string variant;
  std::string hash;
};

template <typename Archive>
void fields(Archive& archive, StoredRobot& robot) {
  archive(robot.choice, robot.data_folder, robot.variant, robot.hash);
}

struct StoredPlan {
  std::string clip, robot;
  StoredOptions options, fit;
  std::vector<std::string> fit_given;
  std::string decisions;  // Hash of the decisions.
  std::optional<TimeScale> time_scale;
};

template <typename Archive>
void fields(Archive& archive, StoredPlan& plan) {
  archive(plan.clip, plan.robot, plan.options, plan.fit, plan.fit_given, plan.decisions,
          plan.time_scale);
}

struct StoredSolution {
  StoredPlan plan;
  std::int64_t ik_steps = 0;
  std::optional<FitReport> fit;
  std::optional<SolvedScene> scene;
  SourceContacts contacts;
  std::vector<SolverFailure> failures;
};

template <typename Archive>
void fields(Archive& archive, StoredSolution& solution) {
  archive(solution.plan, solution.ik_steps, solution.fit, solution.scene, solution.contacts,
          solution.failures);
}

struct StoredRun {
  std::string motion;
  StoredOptions robot, options, fit;
  std::vector<std::string> fit_given;
  bool mirror = false;
  std::string source_hash, limits;
  std::optional<TimeScale> time_scale;
};

template <typename Archive>
void fields(Archive& archive, StoredRun& run) {
  archive(run.motion, run.robot, run.options, run.fit, run.fit_given, run.mirror, run.source_hash,
          run.limits, run.time_scale);
}

struct StoredMotion {
  std::string robot, name, summary;
  FrameRate rate;
  int frames = 0;
  bool rate_known = true;
  std::vector<double> qpos;
  StoredOptions save;
  std::optional<FootContacts> contacts;
  std::optional<StoredSolution> solution;
  std::optional<StoredRun> recorded;
  bool is_of_file = true;
  std::optional<double> part_start;
};

template <typename Archive>
void fields(Archive& archive, StoredMotion& motion) {
  archive(motion.robot, motion.name, motion.summary, motion.rate, motion.frames, motion.rate_known,
          motion.qpos, motion.save, motion.contacts, motion.solution, motion.recorded,
          motion.is_of_file, motion.part_start);
}

/// FNV-1a: detects bytes that were truncated or changed.
inline std::uint64_t checksum_of(std::string_view bytes) {
  std::uint64_t sum = 0xcbf29ce484222325U;
  for (const char each : bytes) sum = (sum ^ static_cast<unsigned char>(each)) * 0x100000001b3U;
  return sum;
}

template <typename Value>
std::string to_bytes(const Value& value) {
  ArchiveWriter archive, checksum;
  archive(value);
  const std::string content = archive.take();
  checksum(checksum_of(content));
  return std::string(kStoredVersion) + checksum.take() + content;
}

template <typename Value>
Result<Value> from_bytes(std::string_view bytes) {
  if (!bytes.starts_with(kStoredVersion)) {
    return usage_failure("the pickle was made by another version of retarget",
                         "use the same version, or pass a file");
  }
  bytes.remove_prefix(kStoredVersion.size());
  std::uint64_t sum = 0;
  ArchiveReader head(bytes);
  head(sum);
  bytes.remove_prefix(std::min(sizeof(sum), bytes.size()));
  ArchiveReader archive(bytes);
  Value value;
  if (sum == checksum_of(bytes)) archive(value);
  if (!archive.complete()) return usage_failure("the pickle is damaged");
  return value;
}

}  // namespace retarget::python

#include "retarget/version.h"

#include <mujoco/mujoco.h>
#include <Eigen/Core>

#include "build_facts.h"
#include "version_numbers.h"

namespace retarget {
namespace {

std::string dotted(int major, int minor, int patch) {
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

// Build options that change the last digits of results.
constexpr const char* kInstructions =
#if defined(RETARGET_NATIVE_BUILD)
    ", for the building machine's processor (RETARGET_NATIVE)";
#else
    "";
#endif

std::string compiler() {
#if defined(__clang__)
  return "Clang " + dotted(__clang_major__, __clang_minor__, __clang_patchlevel__);
#elif defined(__GNUC__)
  return "GCC " + dotted(__GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#else
  return "unknown";
#endif
}

}  // namespace

std::string mujoco_version_text(int number) {
  constexpr int kMaxOfThreeDigits = 99999;
  if (number <= kMaxOfThreeDigits) return dotted(number / 100, number / 10 % 10, number % 10);
  return dotted(number / 1000000, number / 1000 % 1000, number % 1000);
}

std::string version_number() {
  return kToolVersion;
}

std::string version_text() {
  const std::string commit = kGitCommit;
  return "retarget " + version_number() + (commit.empty() ? "" : " (git " + commit + ")") +
         "\ncompiler " + compiler() + kInstructions + "\nMuJoCo " +
         mujoco_version_text(mj_version()) + " (compiled against " +
         mujoco_version_text(mjVERSION_HEADER) + ")" + "\nEigen " +
         dotted(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION);
}

}  // namespace retarget

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "batch/clip_variants.h"
#include "retarget/error.h"
#include "retarget/report.h"

namespace retarget {

/// A file as it was when a manifest took note of it.
struct FileRecord {
  std::string file;
  std::uint64_t bytes = 0;
  std::int64_t modified_ns = 0;  ///< Of its last change, nanoseconds since 1970.
  std::string hash;              ///< hash_file() of it; empty: not known.
};

/// How good a clip's motion is, as far as a manifest tells.
struct ClipQuality {
  std::vector<std::pair<std::string, double>> figures;  ///< Metric key and value.
  std::vector<std::string> missed;                      ///< Metrics whose gates were missed.
  std::string worst;         ///< The metric that is furthest beyond its gate; empty: none is.
  double worst_ratio = 0.0;  ///< By how many times; infinity where the gate is 0.
  std::vector<GateResult> missed_gates = {};  ///< Those of `missed`, with figures and bounds.
  std::optional<double> leg =
      std::nullopt;  ///< QualityReport::leg, which gates' bounds scale with.
};

/// That a clip shows what another one shows.
struct RepeatedClip {
  std::string of;         ///< `relative` of the other.
  bool mirrored = false;  ///< Left for right.
  double distance = 0.0;  ///< signature_distance(), degrees.
};

/// What came of one clip for one robot.
struct ManifestEntry {
  std::string relative;  ///< The clip's path below the folder that was given.
  std::string robot;
  bool done = false;                ///< False: it failed (`error` says why) or was left out.
  std::string options_hash;         ///< Of all that decides the output beside the input.
  FileRecord input;                 ///< `file` as it was opened.
  std::vector<FileRecord> outputs;  ///< `file` below the output folder.
  int frames = 0;                   ///< Of the motion that was written,
  double fps = 0.0;                 ///< and its rate.
  double seconds = 0.0;             ///< That the clip took.
  std::optional<Error> error;
  int exit_code = 0;     ///< Of the error, as a run of this clip alone would have.
  std::string taken_as;  ///< What the clip's human was taken for.
  std::string config;    ///< File of the configuration; below the data folder from there.
  std::vector<std::string> warnings;   ///< What the run said, one line each.
  std::optional<ClipQuality> quality;  ///< Nothing: not measured.
  std::string finished;                ///< UTC, as 2026-01-31T12:00:00Z.
  ClipVariant variant = {};            ///< What it is of its file.
  std::string signature = {};          ///< signature_bytes(); empty: not known.
  /// A clip that is not `done` and repeats another was left out, and has no error.
  std::optional<RepeatedClip> repeated = std::nullopt;

  [[nodiscard]] bool is_left_out() const { return !done && repeated.has_value(); }
  [[nodiscard]] bool has_failed() const { return !done && !repeated.has_value(); }
};

/// An entry as one line of JSON, ended by a line feed. File names that are not valid UTF-8 are
/// written with replacement characters and, in a member NAME_hex beside, as their bytes.
[[nodiscard]] std::string manifest_line(const ManifestEntry& entry);

/// The entry of a line; nothing for a line that is torn or no entry. Unknown members are skipped.
[[nodiscard]] std::optional<ManifestEntry> parse_manifest_line(std::string_view line);

/// What could be read of a manifest.
struct ManifestContent {
  std::vector<ManifestEntry> entries;  ///< As they stand in the file, older ones of a clip too.
  int unreadable = 0;                  ///< Lines that are no entries, a torn last one included.
  int outside = 0;                     ///< Lines that name something outside of their folder,
  std::string outside_name;            ///< and the first such name.
};

/// Reads a manifest; one that is not there is empty. A line that a kill or a full disk tore is
/// counted and else ignored, and so is one whose clip, robot or outputs are no plain names below a
/// folder: what runs make has no others.
[[nodiscard]] Result<ManifestContent> read_manifest(const std::string& path);

/// The `finished` of an entry that is made now, by one who knows an earlier entry of the same clip:
/// the time, or a millisecond after the earlier one's where that machine's clock was ahead.
/// @param now_ms  milliseconds since 1970.
[[nodiscard]] std::string finished_after(std::int64_t now_ms, const std::string& earlier);

/// The last entry of every clip and robot, by `finished`, then by place; sorted by relative path,
/// then robot.
[[nodiscard]] std::vector<ManifestEntry> latest_entries(std::vector<ManifestEntry> entries);

/// A manifest that is written, a line at a time. Thread-safe.
class ManifestWriter {
 public:
  /// Begins a manifest with these entries, in the place of what is there, in one step.
  [[nodiscard]] static Result<std::unique_ptr<ManifestWriter>> begin(
      const std::string& path, std::span<const ManifestEntry> entries);
  ~ManifestWriter();
  ManifestWriter(const ManifestWriter&) = delete;
  ManifestWriter& operator=(const ManifestWriter&) = delete;

  /// Appends a line that is on the disk when this returns. What a full disk leaves of a line is
  /// taken back.
  [[nodiscard]] Result<void> append(const ManifestEntry& entry);

 private:
  struct State;
  explicit ManifestWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace retarget

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "batch/find_inputs.h"
#include "retarget/error.h"
#include "retarget/repeated_clips.h"
#include "retarget/report.h"

namespace retarget {

/// State of a file when a manifest recorded it.
struct FileRecord {
  std::string file;
  std::uint64_t bytes = 0;
  std::int64_t modified_ns = 0;  ///< Last modification, nanoseconds since 1970.
  std::string hash;              ///< hash_file() of the file; empty if unknown.
};

/// Quality of a clip's motion as recorded in a manifest.
struct ClipQuality {
  std::vector<std::pair<std::string, double>> figures;  ///< Metric key and value.
  std::vector<std::string> missed;                      ///< Metrics whose gates were missed.
  std::string worst;         ///< Metric furthest beyond its gate; empty if all gates pass.
  double worst_ratio = 0.0;  ///< Ratio of that metric to its gate; infinity if the gate is 0.
  std::vector<GateResult> missed_gates = {};  ///< The gates of `missed`, with values and bounds.
  std::optional<double> leg =
      std::nullopt;  ///< QualityReport::leg, the length with which the gates' bounds scale.
};

/// A file in a format that cannot represent the motion.
struct MissingFile {
  std::string file;  ///< File name relative to the output folder.
  std::string reason;
};

/// Result of one clip for one robot.
struct ManifestEntry {
  std::string relative;  ///< Path of the clip below the given folder.
  std::string robot;
  bool done = false;         ///< False: the clip failed (see `error`) or was skipped.
  std::string options_hash;  ///< Hash of everything besides the input that determines the output.
  FileRecord input;          ///< `file` is the path that was opened.
  std::vector<FileRecord> outputs;            ///< `file` is relative to the output folder.
  std::vector<MissingFile> not_written = {};  ///< Formats that cannot represent so short a clip.
  int frames = 0;                             ///< Frames of the written motion.
  double fps = 0.0;                           ///< Frame rate of the written motion.
  double seconds = 0.0;                       ///< Processing time of the clip.
  std::optional<Error> error;
  int exit_code = 0;     ///< Exit code of the error, as in a run of this clip alone.
  std::string taken_as;  ///< Detected kind of human skeleton.
  std::string config;    ///< Configuration file; relative to the data folder if inside it.
  std::vector<std::string> warnings;   ///< Messages of the run, one line each.
  std::vector<std::string> notes;      ///< Changes to the source, and notes of the fit.
  std::optional<ClipQuality> quality;  ///< Nothing: not measured.
  std::string finished;                ///< UTC, such as 2026-01-31T12:00:00Z.
  ClipVariant variant = {};            ///< The part of the file that was used.
  std::string signature = {};          ///< signature_bytes(); empty if unknown.
  /// A duplicate that is not `done` was skipped and has no error.
  std::optional<RepeatedClip> repeated = std::nullopt;

  [[nodiscard]] bool is_left_out() const { return !done && repeated.has_value(); }
  [[nodiscard]] bool has_failed() const { return !done && !repeated.has_value(); }
};

/// Formats an entry as one line of JSON with a line feed. File names that are not valid UTF-8 are
/// written with replacement characters, and their bytes as a second member NAME_hex.
[[nodiscard]] std::string manifest_line(const ManifestEntry& entry);

/// Parses a line. Returns nothing for a truncated or invalid line. Unknown members are ignored.
[[nodiscard]] std::optional<ManifestEntry> parse_manifest_line(std::string_view line);

/// The readable content of a manifest.
struct ManifestContent {
  std::vector<ManifestEntry> entries;  ///< Entries in file order, including older entries of a
                                       ///< clip.
  int unreadable = 0;                  ///< Invalid lines, including a truncated last one.
  int outside = 0;                     ///< Lines that name a path outside of their folder.
  std::string outside_name;            ///< The first such name.
};

/// Reads a manifest; a missing one is empty. Lines truncated by a kill or a full disk are counted
/// and ignored. So are lines whose clip, robot or outputs are not plain names below a folder, since
/// batches never write such names.
[[nodiscard]] Result<ManifestContent> read_manifest(const std::string& path);

/// The `finished` time of an entry that is made now: the current time, or one millisecond after an
/// earlier entry of the same clip if the clock of its machine was ahead.
/// @param now_ms  milliseconds since 1970.
[[nodiscard]] std::string finished_after(std::int64_t now_ms, const std::string& earlier);

/// The last entry of each clip and robot, by `finished`, then by position in the file. Sorted by
/// relative path, then robot.
[[nodiscard]] std::vector<ManifestEntry> latest_entries(std::vector<ManifestEntry> entries);

/// Writes a manifest line by line. Thread-safe.
class ManifestWriter {
 public:
  /// Creates a manifest with these entries; atomically replaces an existing one.
  [[nodiscard]] static Result<std::unique_ptr<ManifestWriter>> begin(
      const std::string& path, std::span<const ManifestEntry> entries);
  ~ManifestWriter();
  ManifestWriter(const ManifestWriter&) = delete;
  ManifestWriter& operator=(const ManifestWriter&) = delete;

  /// Appends a line, which is on disk when this returns. A line that a full disk truncates is
  /// removed again.
  [[nodiscard]] Result<void> append(const ManifestEntry& entry);

 private:
  struct State;
  explicit ManifestWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace retarget

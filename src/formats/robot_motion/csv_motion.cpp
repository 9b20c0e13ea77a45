// Reads robot motions from CSV files.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/robot_motion/csv_columns.h"
#include "formats/robot_motion/raw_motion.h"
#include "retarget/clip.h"
#include "retarget/csv_table.h"
#include "retarget/error.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/robot.h"
#include "retarget/statistics.h"
#include "retarget/text.h"

namespace retarget {

Result<RawMotion> read_csv_motion(std::string_view text, const std::shared_ptr<const Robot>& robot,
                                  const std::string& file, const ReadMotionOptions& options) {
  TRY_ASSIGN(const auto table, read_csv_table(text, file));
  TRY_ASSIGN(const auto columns, find_csv_columns(table, *robot, file, options));
  RawMotion raw;
  if (table.may_be_cut_off) {
    raw.warnings.push_back("the last number of line " + std::to_string(table.lines.back()) +
                           " is shorter than on all other lines, and no line ending follows: the "
                           "file may not have been copied completely");
  }
  raw.format = columns.soma ? MotionFormat::kCsvSoma : MotionFormat::kCsv;
  raw.frames = table.rows();
  raw.joint_count = columns.joints.size();
  raw.degrees = columns.degrees;
  raw.metres_per_unit = columns.metres_per_unit;
  for (const auto& [column, joint] : columns.joints) raw.joint_indices.push_back(joint);
  TRY(take_csv_rate(table, columns, file, options, raw));
  if (options.ignore_header && !table.header.empty()) {
    raw.notes.push_back("columns by position: the header is ignored");
  }
  const bool euler = columns.euler[0] != kNoColumn && !columns.quaternion_named;
  if (columns.quaternion_named || euler) raw.order = QuaternionOrder::kXyzw;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const auto row = table.row(i);
    for (const int column : columns.position) raw.position.push_back(row[column]);
    if (euler) {
      for (const int column : columns.euler) raw.euler.push_back(row[column]);
    } else {
      for (const int column : columns.quaternion) raw.rotation.push_back(row[column]);
    }
    for (const auto& [column, joint] : columns.joints) raw.joints.push_back(row[column]);
  }
  return raw;
}

namespace {

// Range of the time between frames, seconds.
constexpr double kMinStep = 1e-4;
constexpr double kMaxStep = 1.0;

// Statistics of a clock column.
struct ClockSteps {
  double step = 0.0;        // Mean.
  double deviation = 0.0;   // Maximum deviation of a value from an even clock.
  std::size_t where = 0;    // Row of the maximum deviation.
  bool goes_up = true;      // Increases in every row.
  bool whole = true;        // All values are integers.
  double resolution = 0.0;  // All values are multiples of this power of ten.
};

ClockSteps clock_steps(const CsvTable& table, int column) {
  const auto at = static_cast<std::size_t>(column);
  const double first = table.row(0)[at];
  const std::size_t last = table.rows() - 1;
  ClockSteps steps;
  steps.step = (table.row(last)[at] - first) / static_cast<double>(last);
  for (std::size_t i = 0; i <= last; ++i) {
    const double value = table.row(i)[at];
    const double away = std::abs(value - first - static_cast<double>(i) * steps.step);
    if (away > steps.deviation) {
      steps.deviation = away;
      steps.where = i;
    }
    steps.whole = steps.whole && value == std::round(value);
    if (i > 0) steps.goes_up = steps.goes_up && value > table.row(i - 1)[at];
  }
  const auto fits = [&](double resolution) {
    for (std::size_t i = 0; i <= last; ++i) {
      const double multiple = (table.row(i)[at] - first) / resolution;
      if (std::abs(multiple - std::round(multiple)) > 1e-4) return false;
    }
    return true;
  };
  constexpr int kMaxDecimals = 6;
  double resolution = 1.0;
  for (int decimals = 0; decimals <= kMaxDecimals; ++decimals, resolution *= 0.1) {
    if (!fits(resolution)) continue;
    steps.resolution = resolution;
    break;
  }
  return steps;
}

// A row whose time is too far from that of the row before.
struct OddStep {
  std::size_t row = 0;
  double step = 0.0, usual = 0.0;  // The median is usual.
};

// Finds the first missing or added frame. A single late or early time changes two adjacent steps,
// which together are as long as usual.
std::optional<OddStep> odd_step(const CsvTable& table, int column, double resolution) {
  const auto at = static_cast<std::size_t>(column);
  std::vector<double> steps;
  for (std::size_t i = 1; i < table.rows(); ++i) {
    steps.push_back(table.row(i)[at] - table.row(i - 1)[at]);
  }
  const double usual = median(steps);
  // Rounded steps may differ by the resolution.
  const double allowed = 1.01 * std::max(0.5 * usual, resolution);
  const auto is_odd = [&](double apart, int count) {
    return std::abs(apart - count * usual) > allowed;
  };
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (!is_odd(steps[i], 1)) continue;
    if (i > 0 && !is_odd(steps[i - 1] + steps[i], 2)) continue;
    if (i + 1 < steps.size() && !is_odd(steps[i] + steps[i + 1], 2)) continue;
    return OddStep{i + 1, steps[i], usual};
  }
  return std::nullopt;
}

// Common frame rates, Hz.
constexpr std::array<int, 14> kUsualRates = {10, 15, 20, 24,  25,  30,  50,
                                             60, 72, 90, 100, 120, 200, 240};

// Returns the common rate, otherwise the integer rate, that reproduces the times within their
// rounding; otherwise the mean rate. A short clip may fit several common rates; the nearest one is
// used.
FrameRate rate_of_times(const CsvTable& table, int column, const ClockSteps& steps, double tick) {
  const auto at = static_cast<std::size_t>(column);
  const auto largest_miss = [&](double rate) {
    double largest = 0.0;
    for (std::size_t i = 0; i < table.rows(); ++i) {
      const double expected = static_cast<double>(i) / (rate * tick);
      largest = std::max(largest, std::abs(table.row(i)[at] - table.row(0)[at] - expected));
    }
    return largest;
  };
  std::optional<int> best;
  // The first and the last time may both be off by half a unit.
  double min = 1.01 * steps.resolution;
  for (const int rate : kUsualRates) {
    const double miss = largest_miss(rate);
    if (!(miss < min)) continue;
    min = miss;
    best = rate;
  }
  if (best) return {*best, 1};
  const double whole = std::round(1.0 / (steps.step * tick));
  const bool fits = whole >= 1.0 && largest_miss(whole) <= 1.01 * steps.resolution;
  return fits ? frame_rate_from_fps(whole) : frame_rate_from_frame_time(steps.step * tick);
}

// Infers seconds per tick from the size of a step; 0 if it is ambiguous.
double tick_by_magnitude(const ClockSteps& steps) {
  // Steps of about 1 may be frames, seconds or milliseconds.
  if (steps.step >= kMaxStep && steps.step < 2.0) return 0.0;
  for (const double tick : {1.0, 1e-3, 1e-6, 1e-9}) {
    const double seconds = steps.step * tick;
    if (seconds >= 0.5 * 1e-3 && seconds < kMaxStep) return tick;
  }
  return 0.0;
}

class ClockReader {
 public:
  ClockReader(const CsvTable& table, const CsvColumns& columns, const std::string& file,
              const ReadMotionOptions& options, RawMotion& motion)
      : table_(table), columns_(columns), file_(file), options_(options), motion_(motion) {}

  Result<void> read() {
    if (columns_.clock == kNoColumn || table_.rows() < 2) return {};
    steps_ = clock_steps(table_, columns_.clock);
    CsvClock counts = columns_.clock_counts;
    if (counts == CsvClock::kUnknown) {
      // Integers with steps of 1 are frame numbers; integers with larger even steps are ambiguous.
      const bool even = steps_.whole && steps_.deviation < 1e-9;
      if (even && steps_.step > 1.5) {
        return doubt("may be frame numbers or times: it increases by " +
                     number_text(steps_.step, 3) + " per line");
      }
      counts = even || !steps_.goes_up ? CsvClock::kFrames : CsvClock::kTimes;
    }
    return counts == CsvClock::kFrames ? take_frames() : take_times();
  }

 private:
  // An error, or a warning if the options give a rate.
  Result<void> doubt(const std::string& what) {
    const std::string message =
        "column " + std::to_string(columns_.clock + 1) + " (" + name() + ") " + what;
    if (!options_.rate) {
      return input_failure(file_, message, "give the rate with " OPTION("source-fps"));
    }
    motion_.warnings.push_back(message + "; it is ignored");
    return {};
  }

  [[nodiscard]] std::string name() const {
    const auto at = static_cast<std::size_t>(columns_.clock);
    const auto& names = table_.header.empty() ? table_.comment : table_.header;
    return at < names.size() && !names[at].empty() ? "\"" + names[at] + "\"" : "without a name";
  }

  Result<void> take_frames() {
    const bool even = steps_.whole && steps_.deviation < 1e-9 && steps_.step >= 1.0;
    // SOMA's frame numbers count at 120 fps even if only every fourth frame is present.
    constexpr double kSomaRate = 120.0;
    if (columns_.soma && even && steps_.step > 1.0) {
      take_rate(frame_rate_from_fps(kSomaRate / steps_.step),
                "frame numbers that increase by " + number_text(steps_.step, 0) + ", of 120 fps");
      return {};
    }
    if (columns_.soma && !even) {
      return doubt("has frame numbers that do not increase evenly (frame " +
                   std::to_string(steps_.where) + "): are frames missing?");
    }
    if (even) {
      motion_.notes.push_back("a column of frame numbers, ignored" +
                              (steps_.step > 1.0
                                   ? ": they increase by " + number_text(steps_.step, 0)
                                   : std::string()));
    } else {
      motion_.warnings.push_back("the frame numbers do not increase evenly (frame " +
                                 std::to_string(steps_.where) +
                                 ") and are ignored: are frames missing?");
    }
    return {};
  }

  Result<void> take_times() {
    if (!steps_.goes_up) return doubt("does not increase on every line, as times do");
    const double tick =
        columns_.seconds_per_tick > 0.0 ? columns_.seconds_per_tick : tick_by_magnitude(steps_);
    const double seconds = steps_.step * tick;
    if (!(seconds >= kMinStep && seconds <= 1.0 / kMinFileRate)) {
      return doubt("does not determine the rate: it increases by " + number_text(steps_.step, 6) +
                   " per line, in an unknown unit");
    }
    if (steps_.deviation > 0.5 * steps_.step) {
      return doubt("is not uniform: the time of frame " + std::to_string(steps_.where) + " is " +
                   number_text(steps_.deviation * tick, 4) + " s off a uniform rate");
    }
    if (const auto odd = odd_step(table_, columns_.clock, steps_.resolution)) {
      return doubt("is not uniform: line " + std::to_string(table_.lines[odd->row]) + " comes " +
                   number_text(odd->step * tick, 4) + " s after the line before, not " +
                   number_text(odd->usual * tick, 4) + " s as usual; frames may be missing");
    }
    const char* unit = tick == 1.0 ? "s" : tick == 1e-3 ? "ms" : tick == 1e-6 ? "us" : "ns";
    const FrameRate rate = rate_of_times(table_, columns_.clock, steps_, tick);
    take_rate(rate, "times in " + std::string(unit) + ": " + to_text(rate) + " a second");
    return {};
  }

  void take_rate(const FrameRate& rate, const std::string& found) {
    motion_.rate = rate;
    if (options_.rate && !same_rate(*options_.rate, rate)) {
      motion_.warnings.push_back("the file has " + found + "; using the requested " +
                                 to_text(*options_.rate) + " fps");
      return;
    }
    motion_.notes.push_back("a column of " + found);
  }

  const CsvTable& table_;
  const CsvColumns& columns_;
  const std::string& file_;
  const ReadMotionOptions& options_;
  RawMotion& motion_;
  ClockSteps steps_;
};

}  // namespace

Result<void> take_csv_rate(const CsvTable& table, const CsvColumns& columns,
                           const std::string& file, const ReadMotionOptions& options,
                           RawMotion& motion) {
  return ClockReader(table, columns, file, options, motion).read();
}

}  // namespace retarget

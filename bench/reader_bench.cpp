// Times the BVH reader on 100 MB: from bytes to channel values, and to quaternions.

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <random>

#include "bench_support.h"
#include "formats/bvh/motion_rows.h"
#include "formats/bvh/number_parser.h"
#include "formats/bvh/read_bvh.h"

namespace retarget {
namespace {

constexpr std::size_t kRowWidth = 69;
constexpr std::size_t kSize = 100'000'000;

// Rows as in LAFAN1's files: a position and 22 rotations, six decimals.
const std::string& rows_text() {
  static const std::string kText = [] {
    std::mt19937 random(1);
    std::normal_distribution<double> value(0.0, 60.0);
    std::string text(32, '\n');
    text.reserve(kSize + 2000);
    char number[64];
    while (text.size() < kSize) {
      for (std::size_t i = 0; i < kRowWidth; ++i) {
        text.append(number, std::snprintf(number, sizeof number, "%.6f ", value(random)));
      }
      text.back() = '\n';
    }
    return text;
  }();
  return kText;
}

void set_rate(benchmark::State& state) {
  state.SetBytesProcessed(static_cast<std::int64_t>(rows_text().size()) * state.iterations());
}

// The straightforward implementation, as a reference for the readers.
void rows_by_from_chars(benchmark::State& state) {
  const std::string& text = rows_text();
  for (auto _ : state) {
    const char* const end = text.data() + text.size();
    const char* at = text.data();
    std::vector<double> row(kRowWidth);
    for (std::size_t i = 0;; i = i + 1 < kRowWidth ? i + 1 : 0) {
      while (at < end && (*at == ' ' || *at == '\n')) ++at;
      if (at == end) break;
      at = std::from_chars(at, end, row[i]).ptr;
      benchmark::DoNotOptimize(row.data());
    }
  }
  set_rate(state);
}
BENCHMARK(rows_by_from_chars)->Unit(benchmark::kMillisecond);

void rows_by_line(benchmark::State& state, ReadNumberLine reader) {
  if (reader == nullptr) {
    state.SkipWithError("this processor has no vector reader");
    return;
  }
  const std::string& text = rows_text();
  std::vector<double> row(kRowWidth + kNumberLineSlack);
  for (auto _ : state) {
    std::size_t at = text.find_first_not_of('\n');
    // The SIMD reader leaves the last line to the caller, because it never reads past the end.
    while (at + 2000 < text.size()) {
      at = reader(text, at, kRowWidth, row) + 1;
      benchmark::DoNotOptimize(row.data());
    }
  }
  set_rate(state);
}
BENCHMARK_CAPTURE(rows_by_line, portable, read_number_line_portable)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(rows_by_line, vector, vector_number_line_reader())->Unit(benchmark::kMillisecond);

// The code path of the file reader, with all checks.
void rows_checked(benchmark::State& state) {
  const std::string& text = rows_text();
  const SourceText source(text, "");
  MotionRowsOptions options;
  options.row_width = kRowWidth;
  options.declared_rows = std::count(text.begin() + 32, text.end(), '\n');
  for (auto _ : state) {
    Scanner scanner(text);
    const auto rows = parse_motion_rows(
        source, scanner, options,
        [](int, std::span<const double> row) { benchmark::DoNotOptimize(row.data()); });
    if (!rows || rows->count != options.declared_rows) state.SkipWithError("rows were not read");
  }
  set_rate(state);
}
BENCHMARK(rows_checked)->Unit(benchmark::kMillisecond);

std::string lafan1_text() {
  std::string text =
      "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition "
      "Zposition Zrotation Yrotation Xrotation\n";
  const std::size_t joints = (kRowWidth - 3) / 3 - 1;
  for (std::size_t i = 0; i < joints; ++i) {
    text += "JOINT j" + std::to_string(i) +
            "\n{\nOFFSET 10 0 0\nCHANNELS 3 Zrotation Yrotation Xrotation\n";
  }
  text += std::string(2 * (joints + 1), '\n');
  for (std::size_t i = 0; i <= joints; ++i) text += "}\n";
  const std::string& rows = rows_text();
  text += "MOTION\nFrames: " + std::to_string(std::count(rows.begin() + 32, rows.end(), '\n')) +
          "\nFrame Time: 0.033333\n";
  return text + rows;
}

void read_to_quaternions(benchmark::State& state) {
  const std::string text = lafan1_text();
  for (auto _ : state) {
    const auto file = read_bvh(text, "");
    if (!file) state.SkipWithError(file.error().message.c_str());
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(text.size()) * state.iterations());
}
BENCHMARK(read_to_quaternions)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace retarget

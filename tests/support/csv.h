#pragma once

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace retarget {

/// Parses the rows of comma-separated numbers.
inline std::vector<std::vector<double>> parse_csv(const std::string& text) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::vector<double> row;
    const char* at = line.data();
    const char* const end = at + line.size();
    while (at < end) {
      double value = std::nan("");
      at = std::from_chars(at, end, value).ptr;
      row.push_back(value);
      if (at < end && *at != ',') break;  // Leave the row short: the test fails on its width.
      ++at;
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

inline std::vector<std::vector<double>> read_csv(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return parse_csv(text.str());
}

/// Largest difference between two tables; `agree` if it is within the tolerance.
struct TableDifference {
  bool agree = true;
  double largest = 0.0;
  std::string where;  ///< Human-readable: frame, column, both values, difference.
};

/// Compares the first `expected.size()` rows.
inline TableDifference compare_tables(const std::vector<std::vector<double>>& found,
                                      const std::vector<std::vector<double>>& expected,
                                      double tolerance) {
  TableDifference result;
  if (expected.empty() || found.size() < expected.size()) {
    result.agree = false;
    result.where = std::to_string(found.size()) + " rows for " + std::to_string(expected.size());
    return result;
  }
  for (std::size_t frame = 0; frame < expected.size(); ++frame) {
    if (found[frame].size() != expected[frame].size()) {
      result.agree = false;
      result.where = "frame " + std::to_string(frame) + " has " +
                     std::to_string(found[frame].size()) + " columns for " +
                     std::to_string(expected[frame].size());
      return result;
    }
    for (std::size_t column = 0; column < expected[frame].size(); ++column) {
      const double difference = std::abs(found[frame][column] - expected[frame][column]);
      // The negated comparison counts NaN as a difference.
      if (!(difference <= result.largest)) {
        std::ostringstream where;
        where.precision(12);
        where << "frame " << frame << ", column " << column + 1 << ": " << found[frame][column]
              << " for " << expected[frame][column] << ", difference " << difference;
        result.largest = difference;
        result.where = where.str();
      }
    }
  }
  result.agree = result.largest <= tolerance;
  return result;
}

}  // namespace retarget

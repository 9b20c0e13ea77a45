#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "formats/bvh/motion_rows.h"
#include "formats/bvh/number_parser.h"
#include "formats/bvh/read_bvh.h"
#include "retarget/bvh.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

constexpr double kMaxValue = 1e7;

}  // namespace

class BvhRowReader::Impl {
 public:
  explicit Impl(const Skeleton& skeleton)
      : decoder_(skeleton, 0),
        count_(static_cast<std::size_t>(skeleton.channel_count())),
        row_(count_ + kNumberLineSlack) {}

  Result<void> read(std::string_view line, Clip& clip, int frame) {
    const std::size_t end = read_number_line_portable(line, 0, count_, row_);
    if (end == std::string_view::npos || end != line.size()) {
      return input_failure({}, fmt::format("expected a row of {}", count_text(count_, "number")));
    }
    const auto values = std::span(row_).first(count_);
    if (!std::ranges::all_of(values, [](double value) { return std::abs(value) < kMaxValue; })) {
      return input_failure({}, "a row contains numbers above ten million");
    }
    decoder_.decode(values, clip, frame);
    return {};
  }

 private:
  RowDecoder decoder_;
  std::size_t count_;
  std::vector<double> row_;
};

BvhRowReader::BvhRowReader(const Skeleton& skeleton) : impl_(std::make_unique<Impl>(skeleton)) {}
BvhRowReader::~BvhRowReader() = default;
BvhRowReader::BvhRowReader(BvhRowReader&&) noexcept = default;
BvhRowReader& BvhRowReader::operator=(BvhRowReader&&) noexcept = default;

Result<void> BvhRowReader::read(std::string_view line, Clip& clip, int frame) {
  return impl_->read(line, clip, frame);
}

Result<std::shared_ptr<const Skeleton>> bvh_skeleton(std::string_view text,
                                                     const std::string& file) {
  BvhReadOptions options;
  options.motion_optional = true;
  RETARGET_TRY_ASSIGN(const BvhFile read, read_bvh(text, file, options));
  return read.clip.shared_skeleton();
}

}  // namespace retarget

#include "retarget/report.h"

#include <algorithm>

namespace retarget {

const MetricValue* QualityReport::find(std::string_view key) const {
  const auto found =
      std::ranges::find_if(values, [key](const MetricValue& v) { return v.metric->key == key; });
  return found == values.end() ? nullptr : &*found;
}

bool QualityReport::passed() const {
  return std::ranges::all_of(gates, &GateResult::passed);
}

}  // namespace retarget

#include "bvh/number_error.h"

#include <algorithm>
#include <string>

#include "bvh/number_parser.h"

namespace retarget {
namespace {

struct Fault {
  std::string expected = "a number";
  std::string remark;  // after what was found
  std::string hint;
};

Fault comma_fault(std::string_view token) {
  const bool decimal = std::ranges::count(token, ',') == 1 &&
                       token.find('.') == std::string_view::npos && token.back() != ',';
  if (decimal) {
    return {"a number with a decimal point", " with a decimal comma",
            "use decimal points: replace the commas, or export with an English locale"};
  }
  return {"a number", "", "separate the values with spaces, not commas"};
}

Fault find_fault(std::string_view token, const ParsedNumber& number) {
  if (token.empty()) return {};
  if (token.front() == '\0') {
    return {"a number", "", "the file is damaged: part of it was overwritten with zeros"};
  }
  if (is_nan_or_infinity(token)) return {"a finite number", "", ""};
  if (number.status == NumberStatus::kTooLarge)
    return {"a number within the range of double", "", ""};
  if (token.find(',') != std::string_view::npos) return comma_fault(token);
  if (number.end != nullptr) {
    const std::string_view rest = token.substr(static_cast<std::size_t>(number.end - token.data()));
    if (rest.starts_with('-') || rest.starts_with('+')) {
      return {"a number followed by white space", "",
              "a space is missing before " + in_quotes(rest)};
    }
    return {"a number followed by white space", "", ""};
  }
  return {};
}

}  // namespace

bool is_nan_or_infinity(std::string_view token) {
  if (token.starts_with('-') || token.starts_with('+')) token.remove_prefix(1);
  return equal_ignoring_case(token.substr(0, 3), "nan") ||
         equal_ignoring_case(token.substr(0, 3), "inf") || token.starts_with("1.#");
}

Failure number_failure(const SourceText& source, std::size_t offset, std::string_view role) {
  Scanner scanner(source.text());
  scanner.move_to(offset);
  const std::string_view token = scanner.token();
  const Fault fault = find_fault(token, parse_number(token.data(), token.data() + token.size()));
  return source.failure_at(offset,
                           "expected " + fault.expected + " (" + std::string(role) + "), found " +
                               source.found_at(offset) + fault.remark,
                           fault.hint);
}

}  // namespace retarget

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <unordered_set>

#include "base/json.h"
#include "base/try.h"
#include "retarget/file.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

// Useful files are never nested this deep, and recursive code would overflow the stack.
constexpr std::size_t kMaxDepth = 100;
// The parser searches the members of an object linearly, so time grows with their number squared.
constexpr std::size_t kMaxMembers = 2000;
constexpr std::size_t kMaxMembersInAll = 200'000;
constexpr std::size_t kMaxBytes = std::size_t{16} << 20;
constexpr std::size_t kMaxFoundLength = 80;
constexpr std::size_t kMaxReasonLength = 200;

// Strips the prefix and the position from nlohmann's message; json_failure computes the position.
std::string reason_of(const nlohmann::json::exception& error) {
  std::string reason = error.what();
  if (const auto bracket = reason.find("] "); bracket != std::string::npos) {
    reason.erase(0, bracket + 2);
  }
  if (const auto colon = reason.find("column "); colon != std::string::npos) {
    const auto start = reason.find(": ", colon);
    if (start != std::string::npos) reason.erase(0, start + 2);
  }
  return cut_short(reason, kMaxReasonLength);
}

// @param offset  byte offset of the error; the size of the text for its end
Failure json_failure(std::string_view text, const std::string& file, std::size_t offset,
                     const std::string& reason) {
  const std::string_view before = text.substr(0, std::min(offset, text.size()));
  const std::size_t line_end = before.rfind('\n');
  Error error;
  error.kind = ErrorKind::kConfig;
  error.location.file = file;
  error.location.line = 1 + static_cast<std::size_t>(std::ranges::count(before, '\n'));
  error.location.column =
      line_end == std::string_view::npos ? before.size() + 1 : before.size() - line_end;
  error.message = "invalid JSON: " + reason;
  return failure(std::move(error));
}

struct Excess {
  std::size_t offset;
  std::string what;
};

// Finds the first position at which a text exceeds the bounds.
std::optional<Excess> excess_of(std::string_view text) {
  if (text.size() > kMaxBytes) {
    return Excess{kMaxBytes, "more than " + std::to_string(kMaxBytes) + " bytes"};
  }
  std::size_t depth = 0, all = 0;
  std::array<std::size_t, kMaxDepth + 1> members{};  // Counts for the enclosing objects, by depth.
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kMaxDepth) {
        return Excess{i, "nested more than " + std::to_string(kMaxDepth) + " deep"};
      }
      members[depth] = 0;
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    } else if (c == ':') {
      if (++members[depth] > kMaxMembers) {
        return Excess{i, "an object of more than " + std::to_string(kMaxMembers) + " members"};
      }
      if (++all > kMaxMembersInAll) {
        return Excess{i, "more than " + std::to_string(kMaxMembersInAll) + " members in total"};
      }
    }
  }
  return std::nullopt;
}

struct RepeatedKey {
  std::size_t offset;
  std::string key;
};

// Finds the first key that its object already has. The text must be valid JSON up to its end or a
// zero byte, which ends it for nlohmann's parser.
std::optional<RepeatedKey> repeated_key(std::string_view text) {
  text = text.substr(0, text.find('\0'));
  std::vector<std::unordered_set<std::string>> keys;  // Of the enclosing lists and objects.
  std::string_view last;                              // The last string, with its quotes.
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') {
      const std::size_t begin = i;
      for (++i; i < text.size() && text[i] != '"'; ++i) {
        if (text[i] == '\\') ++i;
      }
      last = text.substr(begin, i + 1 - begin);
    } else if (c == '[' || c == '{') {
      keys.emplace_back();
    } else if (c == ']' || c == '}') {
      keys.pop_back();
    } else if (c == ':') {
      const bool escaped = last.find('\\') != std::string_view::npos;
      std::string key = escaped ? nlohmann::json::parse(last).get<std::string>()
                                : std::string(last.substr(1, last.size() - 2));
      if (!keys.back().insert(key).second) {
        return RepeatedKey{static_cast<std::size_t>(last.data() - text.data()), std::move(key)};
      }
    }
  }
  return std::nullopt;
}

// For a number out of range, nlohmann quotes the number instead of giving its position.
std::size_t offset_of_quoted(std::string_view text, const std::string& reason) {
  const std::size_t open = reason.find('\'');
  const std::size_t close = reason.rfind('\'');
  if (open == std::string::npos || close <= open) return 0;
  const std::size_t found = text.find(reason.substr(open + 1, close - open - 1));
  return found == std::string_view::npos ? 0 : found;
}

}  // namespace

std::string text_at(const nlohmann::ordered_json& json, const std::string& key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

nlohmann::ordered_json object_at(const nlohmann::ordered_json& json, const std::string& key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_object() ? *found : nlohmann::ordered_json::object();
}

Result<void> check_json_bounds(std::string_view text, const std::string& file) {
  const auto excess = excess_of(text);
  return excess ? json_failure(text, file, excess->offset, excess->what) : Result<void>();
}

Result<nlohmann::ordered_json> parse_json(std::string_view text, const std::string& file) {
  TRY(check_json_bounds(text, file));
  try {
    Json json = Json::parse(text);
    // The parser keeps only the last value of a repeated key.
    if (const auto repeated = repeated_key(text)) {
      return json_failure(text, file, repeated->offset,
                          "the key \"" + cut_short(repeated->key, kMaxFoundLength) +
                              "\" occurs twice in an object");
    }
    return json;
  } catch (const nlohmann::json::parse_error& error) {
    // nlohmann counts bytes from 1.
    return json_failure(text, file, error.byte > 0 ? error.byte - 1 : 0, reason_of(error));
  } catch (const nlohmann::json::exception& error) {
    const std::string reason = reason_of(error);
    return json_failure(text, file, offset_of_quoted(text, reason), reason);
  }
}

Result<nlohmann::ordered_json> load_json(const std::string& path) {
  // Read more than the bound, so that parse_json reports the excess with line and column.
  TRY_ASSIGN(const auto text, read_file(path, ErrorKind::kConfig, 2 * kMaxBytes));
  return parse_json(text.view(), path);
}

std::string printable_dump(const nlohmann::ordered_json& json) {
  return printable_json(json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace)) + "\n";
}

void put_name(Json& json, const std::string& key, const std::string& bytes) {
  std::string text = valid_utf8(bytes);
  const bool as_it_is = text == bytes;
  json[key] = std::move(text);
  if (!as_it_is) json[key + std::string(kHexKeyEnd)] = hex_text(bytes);
}

std::string name_from(const Json& json, const std::string& key) {
  const std::string hex = text_at(json, key + std::string(kHexKeyEnd));
  if (auto bytes = bytes_from_hex(hex); bytes && !hex.empty()) return std::move(*bytes);
  return text_at(json, key);
}

std::string short_text(const nlohmann::ordered_json& json) {
  return cut_short(json.dump(), kMaxFoundLength);
}

void JsonMembers::check_keys(const std::vector<std::string>& known) const {
  for (const auto& [key, value] : json_.items()) {
    if (std::ranges::find(known, key) != known.end()) continue;
    faults_.add(fmt::format("{}unknown key \"{}\"{}", where_, key, faults_.suggestion(key, known)));
  }
}

const Json* JsonMembers::find(const std::string& key) const {
  const auto found = json_.find(key);
  return found == json_.end() ? nullptr : &*found;
}

const Json* JsonMembers::member(const std::string& key, Json::value_t type,
                                const char* wanted) const {
  const Json* value = find(key);
  if (value == nullptr || value->type() == type) return value;
  faults_.add(
      fmt::format("{}\"{}\" must be {}, found {}", where_, key, wanted, short_text(*value)));
  return nullptr;
}

std::string JsonMembers::text(const std::string& key) const {
  const Json* value = member(key, Json::value_t::string, "a string");
  return value == nullptr ? std::string() : value->get<std::string>();
}

bool JsonMembers::flag(const std::string& key) const {
  const Json* value = member(key, Json::value_t::boolean, "true or false");
  return value != nullptr && value->get<bool>();
}

const Json* JsonMembers::list(const std::string& key) const {
  return member(key, Json::value_t::array, "a list");
}

const Json& JsonMembers::object(const std::string& key) const {
  static const Json kNone = Json::object();
  const Json* value = member(key, Json::value_t::object, "an object");
  return value == nullptr ? kNone : *value;
}

std::optional<Eigen::Vector3d> vector_from(const Json& json) {
  const auto values = value_from<std::vector<double>>(json);
  if (!values || values->size() != 3) return std::nullopt;
  return Eigen::Vector3d(values->data());
}

}  // namespace retarget

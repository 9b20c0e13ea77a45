#include "robot/model/mujoco_messages.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <tinyxml2.h>
#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <set>
#include <string_view>
#include <utility>

#include "base/parse_xml.h"

namespace retarget {
namespace {

// MuJoCo's handlers have no context argument; thread-local storage separates the threads.
struct Messages {
  std::vector<std::string>* errors = nullptr;
  std::vector<std::string>* warnings = nullptr;
};
thread_local Messages messages;

// Returns the last number that follows `word`, and the position of that word.
std::pair<std::size_t, std::size_t> last_number_after(const std::string& text,
                                                      const std::string& word) {
  for (std::size_t at = text.rfind(word); at != std::string::npos; at = text.rfind(word, at - 1)) {
    const std::size_t digits = at + word.size();
    if (digits < text.size() && std::isdigit(static_cast<unsigned char>(text[digits])) != 0) {
      return {std::strtoul(text.c_str() + digits, nullptr, 10), at};
    }
    if (at == 0) break;
  }
  return {0, std::string::npos};
}

// Format: `XML parse error 14:; Error=XML_ERROR_MISMATCHED_ELEMENT ErrorID=14 (0xe) Line number=3:
// details`.
std::string parser_message(const std::string& text) {
  static constexpr std::array<std::pair<const char*, const char*>, 6> kReasons = {{
      {"XML_ERROR_EMPTY_DOCUMENT", "the file is empty"},
      {"XML_ERROR_PARSING_TEXT", "expected an element, found text"},
      {"XML_ERROR_MISMATCHED_ELEMENT", "an element has no matching closing tag"},
      {"XML_ERROR_PARSING_ATTRIBUTE", "an attribute must have the form name=\"value\""},
      {"XML_ERROR_PARSING_ELEMENT", "an element is incomplete"},
      {"XML_ELEMENT_DEPTH_EXCEEDED", "elements are nested too deeply"},
  }};
  std::string message = "the file is not well-formed XML";
  for (const auto& [code, reason] : kReasons) {
    if (text.find(code) != std::string::npos) return message + ": " + reason;
  }
  return message;
}

}  // namespace

std::mutex& mujoco_mutex() {
  static std::mutex mutex;
  return mutex;
}

MessageGuard::MessageGuard() : old_error_(mju_user_error), old_warning_(mju_user_warning) {
  messages = {&errors_, &warnings_};
  mju_user_error = [](const char* text) {
    if (messages.errors != nullptr) messages.errors->push_back(one_line(text));
  };
  mju_user_warning = [](const char* text) {
    if (messages.warnings != nullptr) messages.warnings->push_back(one_line(text));
  };
}

MessageGuard::~MessageGuard() {
  mju_user_error = old_error_;
  mju_user_warning = old_warning_;
  messages = {};
}

std::string one_line(const std::string& text) {
  std::string line;
  for (const char c : text) {
    if (c == '\n') {
      line += "; ";
    } else if (static_cast<unsigned char>(c) >= ' ') {
      line += c;
    }
  }
  while (line.ends_with(' ') || line.ends_with(';')) line.pop_back();
  return line;
}

namespace {

constexpr const char* kRenameOne = "give one of them another name";

std::string twice(const std::string& kind) {
  return ": two elements of kind " + kind + " have it";
}

}  // namespace

Result<void> check_urdf_names(const tinyxml2::XMLElement& robot, const std::string& file) {
  for (const char* kind : {"link", "joint"}) {
    std::set<std::string> names;
    for (const auto* element : children_of(robot, kind)) {
      const char* name = element->Attribute("name");
      if (name == nullptr || names.insert(name).second) continue;
      const auto line = static_cast<std::size_t>(std::max(0, element->GetLineNum()));
      return failure({ErrorKind::kConfig,
                      {file, line, 0},
                      fmt::format("repeated name '{}'{}", name, twice(kind)),
                      {},
                      kRenameOne});
    }
  }
  return {};
}

void remove_prefixes(std::string& line) {
  for (const std::string_view prefix : {"XML Error: ", "Error: ", "Schema violation: "}) {
    if (line.starts_with(prefix)) line.erase(0, prefix.size());
  }
}

Failure model_failure(const std::string& path, const std::string& text) {
  std::string line = one_line(text);
  Error error;
  error.kind = ErrorKind::kConfig;
  error.location.file = path;
  if (line.starts_with("XML parse error")) {
    error.location.line = last_number_after(line, "Line number=").first;
    error.message = parser_message(line);
    return failure(std::move(error));
  }
  // Moves the line and column into the error's location; line 0 refers to an included file.
  const auto [number, at] = last_number_after(line, ", line ");
  if (at != std::string::npos) {
    error.location.line = number;
    error.location.column = last_number_after(line.substr(at), ", column ").first;
    line.erase(at);
  }
  remove_prefixes(line);
  error.message = "MuJoCo cannot load the model: " + line;
  // Format: `repeated name 'knee' in joint`.
  const std::size_t name_end = line.find("' in ");
  if (line.starts_with("repeated name '") && name_end != std::string::npos) {
    const std::string kind = line.substr(name_end + 5, line.find(';') - name_end - 5);
    const bool is_world = line.starts_with("repeated name 'world'") && kind == "body";
    error.message = is_world ? "the name 'world' of a body is reserved for the world itself"
                             : line.substr(0, name_end + 1) + twice(kind);
    error.hint = is_world ? "give the body another name" : kRenameOne;
  }
  return failure(std::move(error));
}

}  // namespace retarget

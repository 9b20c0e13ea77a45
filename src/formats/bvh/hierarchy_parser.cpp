#include "formats/bvh/hierarchy_parser.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <system_error>
#include <unordered_map>
#include <utility>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/bvh/number_parser.h"
#include "formats/containers/file_kind.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr std::array kChannels = {Channel::kXPosition, Channel::kYPosition, Channel::kZPosition,
                                  Channel::kXRotation, Channel::kYRotation, Channel::kZRotation,
                                  Channel::kXScale,    Channel::kYScale,    Channel::kZScale};

// Counts an oddity and remembers its first position.
struct Tally {
  std::size_t count = 0;
  std::size_t first = 0;

  void note(std::size_t offset) {
    if (count++ == 0) first = offset;
  }
};

class HierarchyParser {
 public:
  HierarchyParser(const SourceText& source, Scanner& scanner, std::string_view root)
      : source_(source), scanner_(scanner), wanted_root_(root) {}

  Result<Hierarchy> parse();

 private:
  // A joint or an end site whose closing brace is pending.
  struct Block {
    int joint = -1;  // Of an end site: the joint that it belongs to.
    bool end_site = false;
    bool has_offset = false;
    bool has_channels = false;
    bool has_children = false;
    std::size_t begin = 0;
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  };

  Result<void> parse_start();
  Result<void> parse_statement();
  Result<void> parse_joint(std::size_t keyword, int parent);
  Result<void> parse_end_site(std::size_t keyword);
  Result<void> parse_offset(std::size_t keyword);
  Result<void> parse_channels(std::size_t keyword);
  Result<Channel> parse_channel(int number, int count);
  Result<void> check_channel_is_new(Channel channel, std::size_t offset) const;
  Result<double> parse_number_token(std::string_view expected);
  Result<void> open_block(Block block);
  Result<void> close_block();
  Failure unclosed(std::size_t offset) const;
  Failure unknown_statement(std::size_t offset) const;
  std::string block_name(const Block& block) const;
  void collect_warnings();
  void warn_about_duplicate_names();
  void warn(const Tally& tally, std::string message);

  std::string_view next_token() {
    scanner_.skip_space();
    return scanner_.token();
  }

  // Skips the next token if it equals `word`.
  bool take_word(std::string_view word) {
    if (!equal_ignoring_case(next_token(), word)) return false;
    scanner_.move_to(scanner_.offset() + word.size());
    return true;
  }

  const SourceText& source_;
  Scanner& scanner_;
  std::string_view wanted_root_;
  Hierarchy hierarchy_;
  std::vector<Block> open_;
  Tally long_offsets_, scale_channels_, end_site_channels_, missing_channels_;
};

Result<Hierarchy> HierarchyParser::parse() {
  TRY(parse_start());
  while (true) {
    const std::string_view token = next_token();
    const std::size_t offset = scanner_.offset();
    if (!open_.empty()) {
      TRY(parse_statement());
      continue;
    }
    if (take_word("ROOT")) {
      TRY(parse_joint(offset, -1));
      continue;
    }
    if (hierarchy_.roots.empty()) return source_.unexpected_at(offset, "ROOT and a name");
    hierarchy_.has_motion = take_word("MOTION");
    if (hierarchy_.has_motion || token.empty()) break;
    return source_.unexpected_at(offset, "MOTION after the skeleton",
                                 token == "}" ? "there is an extra closing brace" : "");
  }
  collect_warnings();
  return std::move(hierarchy_);
}

Result<void> HierarchyParser::parse_start() {
  const std::string_view token = next_token();
  const std::size_t offset = scanner_.offset();
  if (take_word("HIERARCHY")) return {};
  const FileType type = file_type(source_.text());
  if (!type.what.empty() && type.kind != FileKind::kBvh) {
    // The file may be meant to be of any format.
    const std::string expected = source_.text().empty() ? "HIERARCHY" : "a human motion";
    return source_.failure_at(0, "expected " + expected + ", found " + std::string(type.what),
                              std::string(type.hint));
  }
  const bool begins_late = equal_ignoring_case(token, "ROOT");
  return source_.unexpected_at(
      offset, "HIERARCHY",
      begins_late ? "add a line HIERARCHY before it" : "a BVH file begins with the word HIERARCHY");
}

// Parses one statement inside the braces of a joint or an end site.
Result<void> HierarchyParser::parse_statement() {
  const std::string_view token = scanner_.token();
  const std::size_t offset = scanner_.offset();
  if (token.empty() || equal_ignoring_case(token, "MOTION")) return unclosed(offset);
  scanner_.move_to(offset + token.size());
  if (token == "}") return close_block();
  if (equal_ignoring_case(token, "OFFSET")) return parse_offset(offset);
  if (equal_ignoring_case(token, "CHANNELS")) return parse_channels(offset);
  if (open_.back().end_site) {
    return source_.unexpected_at(offset, "OFFSET or '}' in an End Site");
  }
  if (equal_ignoring_case(token, "JOINT")) return parse_joint(offset, open_.back().joint);
  if (equal_ignoring_case(token, "End")) return parse_end_site(offset);
  return unknown_statement(offset);
}

Result<void> HierarchyParser::parse_joint(std::size_t keyword, int parent) {
  // Skip white space only: in a name, comment signs are ordinary characters.
  while (!scanner_.at_end() && is_space(source_.text()[scanner_.offset()])) {
    scanner_.move_to(scanner_.offset() + 1);
  }
  const std::size_t offset = scanner_.offset();
  const std::string_view name = scanner_.take_name();
  if (name.empty()) return source_.unexpected_at(offset, "a joint name");
  const auto control = std::ranges::find_if(name, is_control);
  if (control != name.end()) {
    const auto bad = offset + static_cast<std::size_t>(control - name.begin());
    return source_.failure_at(
        bad, "expected a joint name, found a control character in " + in_quotes(name));
  }
  if (parent < 0 && !hierarchy_.roots.empty() && wanted_root_.empty()) {
    const Joint& first = hierarchy_.joints[hierarchy_.roots.front()];
    const std::size_t first_line = source_.line_of(hierarchy_.places[hierarchy_.roots.front()]);
    return source_.failure_at(
        keyword,
        fmt::format("expected one ROOT, found a second: {} after {} on line {}", in_quotes(name),
                    in_quotes(first.name), first_line),
        "choose one of the skeletons with " OPTION("root") " NAME");
  }
  Joint joint;
  joint.name = name;
  joint.parent = parent;
  const int index = static_cast<int>(hierarchy_.joints.size());
  if (parent < 0) {
    hierarchy_.roots.push_back(index);
  } else {
    open_.back().has_children = true;
  }
  hierarchy_.joints.push_back(std::move(joint));
  hierarchy_.places.push_back(offset);
  Block block;
  block.joint = index;
  return open_block(block);
}

Result<void> HierarchyParser::parse_end_site(std::size_t keyword) {
  if (!take_word("Site")) return source_.unexpected_at(scanner_.offset(), "Site after End");
  // Some exporters name end sites; ignore the name.
  scanner_.take_name();
  Block block;
  block.joint = open_.back().joint;
  block.end_site = true;
  block.begin = keyword;
  return open_block(block);
}

Result<void> HierarchyParser::open_block(Block block) {
  next_token();
  if (!block.end_site) block.begin = hierarchy_.places[block.joint];
  if (!scanner_.take('{')) {
    return source_.unexpected_at(scanner_.offset(), "'{' after " + block_name(block));
  }
  open_.push_back(block);
  return {};
}

Result<void> HierarchyParser::close_block() {
  const Block block = open_.back();
  const std::size_t brace = scanner_.offset() - 1;
  if (!block.has_offset) {
    return source_.failure_at(
        brace, fmt::format("expected OFFSET before the end of {} (line {}), found \"}}\"",
                           block_name(block), source_.line_of(block.begin)));
  }
  open_.pop_back();
  Joint& joint = hierarchy_.joints[block.joint];
  if (block.end_site) {
    joint.end_sites.push_back(block.offset);
    return {};
  }
  joint.offset = block.offset;
  if (!block.has_channels) missing_channels_.note(block.begin);
  return {};
}

Result<void> HierarchyParser::parse_offset(std::size_t keyword) {
  Block& block = open_.back();
  if (block.has_offset) {
    return source_.failure_at(keyword,
                              "expected one OFFSET in " + block_name(block) + ", found a second");
  }
  block.has_offset = true;
  for (int axis = 0; axis < 3; ++axis) {
    TRY_ASSIGN(block.offset[axis], parse_number_token(fmt::format("number {} of 3 of OFFSET in {}",
                                                                  axis + 1, block_name(block))));
  }
  // Some files append a rest rotation; use only the first three numbers.
  bool counted_here = false;
  for (std::string_view token = next_token();
       !token.empty() &&
       (is_digit(token[0]) || token[0] == '-' || token[0] == '+' || token[0] == '.');
       token = next_token()) {
    if (!std::exchange(counted_here, true)) long_offsets_.note(scanner_.offset());
    TRY(parse_number_token("a number after OFFSET"));
  }
  return {};
}

Result<void> HierarchyParser::parse_channels(std::size_t keyword) {
  Block& block = open_.back();
  if (block.has_channels || block.has_children) {
    return source_.failure_at(
        keyword, block.has_channels
                     ? "expected one CHANNELS in " + block_name(block) + ", found a second"
                     : "expected CHANNELS of " + block_name(block) +
                           " before its child joints, found it after");
  }
  block.has_channels = true;
  const std::string_view token = next_token();
  const std::size_t offset = scanner_.offset();
  int count = 0;
  const auto [stop, error] = std::from_chars(token.data(), token.data() + token.size(), count);
  if (error != std::errc() || stop != token.data() + token.size() || count < 0) {
    return source_.unexpected_at(offset, "the channel count of " + block_name(block));
  }
  scanner_.move_to(offset + token.size());
  if (block.end_site) {
    if (count != 0) return source_.unexpected_at(offset, "no channels in an End Site");
    end_site_channels_.note(keyword);
    return {};
  }
  for (int i = 0; i < count; ++i) {
    TRY_ASSIGN(const Channel channel, parse_channel(i + 1, count));
    hierarchy_.joints[block.joint].channels.push_back(channel);
  }
  return {};
}

Result<Channel> HierarchyParser::parse_channel(int number, int count) {
  const std::string_view token = next_token();
  const std::size_t offset = scanner_.offset();
  const auto named = std::ranges::find_if(kChannels, [token](Channel channel) {
    return equal_ignoring_case(token, channel_name(channel));
  });
  if (named == kChannels.end()) {
    std::vector<std::string> names;
    names.reserve(kChannels.size());
    for (const Channel channel : kChannels) names.emplace_back(channel_name(channel));
    const std::string suggestion = did_you_mean(token.substr(0, 32), names);
    return source_.failure_at(
        offset, fmt::format("expected channel {} of the {} of {}, found {}{}", number, count,
                            block_name(open_.back()), source_.found_at(offset), suggestion));
  }
  TRY(check_channel_is_new(*named, offset));
  if (!is_position(*named) && !is_rotation(*named)) scale_channels_.note(offset);
  scanner_.move_to(offset + token.size());
  return *named;
}

// A repeated rotation channel is a further turn; a repeated position channel is ambiguous.
Result<void> HierarchyParser::check_channel_is_new(Channel channel, std::size_t offset) const {
  if (!is_position(channel)) return {};
  const std::vector<Channel>& before = hierarchy_.joints[open_.back().joint].channels;
  if (std::ranges::find(before, channel) == before.end()) return {};
  return source_.failure_at(offset, "expected each position channel once, found " +
                                        std::string(channel_name(channel)) + " again");
}

Result<double> HierarchyParser::parse_number_token(std::string_view expected) {
  const std::string_view token = next_token();
  const std::size_t offset = scanner_.offset();
  const ParsedNumber number = parse_number(token.data(), token.data() + token.size());
  const bool whole = number.end == token.data() + token.size();
  if (number.status != NumberStatus::kOk || !whole) {
    return number_failure(source_, offset, expected);
  }
  scanner_.move_to(offset + token.size());
  return number.value;
}

Failure HierarchyParser::unclosed(std::size_t offset) const {
  const Block& block = open_.back();
  return source_.unexpected_at(offset,
                               "'}' to close " + block_name(block) + " of line " +
                                   std::to_string(source_.line_of(block.begin)),
                               offset == source_.text().size() ? "the file seems to be truncated"
                                                               : "a closing brace is missing");
}

Failure HierarchyParser::unknown_statement(std::size_t offset) const {
  Scanner here(source_.text());
  here.move_to(offset);
  const std::string_view token = here.token();
  std::string hint;
  for (const Channel channel : kChannels) {
    if (equal_ignoring_case(token, channel_name(channel))) {
      hint = "CHANNELS lists more names than its count";
    }
  }
  const std::vector<std::string> keywords = {"OFFSET", "CHANNELS", "JOINT", "End", "End Site"};
  const std::string suggestion = did_you_mean(token.substr(0, 32), keywords);
  return source_.failure_at(offset,
                            "expected OFFSET, CHANNELS, JOINT, End Site or '}' in " +
                                block_name(open_.back()) + ", found " + source_.found_at(offset) +
                                (hint.empty() ? suggestion : ""),
                            hint);
}

std::string HierarchyParser::block_name(const Block& block) const {
  const std::string name = in_quotes(hierarchy_.joints[block.joint].name);
  return block.end_site ? "the End Site of " + name : "joint " + name;
}

void HierarchyParser::warn(const Tally& tally, std::string message) {
  if (tally.count == 0) return;
  hierarchy_.warnings.push_back(source_.warning_at(tally.first, std::move(message)));
}

void HierarchyParser::collect_warnings() {
  warn(missing_channels_,
       count_text(missing_channels_.count, "joint") + " without CHANNELS: read as CHANNELS 0");
  warn(long_offsets_, count_text(long_offsets_.count, "OFFSET") +
                          " with more than three numbers: the first three are used");
  warn(scale_channels_, count_text(scale_channels_.count, "scale channel") + " ignored");
  warn(end_site_channels_,
       count_text(end_site_channels_.count, "End Site") + " with CHANNELS: ignored");
  warn_about_duplicate_names();
}

void HierarchyParser::warn_about_duplicate_names() {
  std::unordered_map<std::string_view, int> counts;
  std::vector<std::string> repeated;
  std::size_t first = 0;
  for (std::size_t i = 0; i < hierarchy_.joints.size(); ++i) {
    const std::string& name = hierarchy_.joints[i].name;
    if (++counts[name] != 2) continue;
    if (repeated.empty()) first = hierarchy_.places[i];
    repeated.push_back(in_quotes(name));
  }
  if (repeated.empty()) return;
  hierarchy_.warnings.push_back(
      source_.warning_at(first, "several joints have the same name: " + list_names(repeated, 5) +
                                    "; only their positions in the file distinguish them"));
}

}  // namespace

Result<Hierarchy> parse_hierarchy(const SourceText& source, Scanner& scanner,
                                  std::string_view root) {
  return HierarchyParser(source, scanner, root).parse();
}

}  // namespace retarget

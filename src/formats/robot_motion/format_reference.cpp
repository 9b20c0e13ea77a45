#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/containers/npz.h"
#include "retarget/reference.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr std::array<std::string_view, 3> kAxisNames = {"x", "y", "z"};

// A group of CSV columns and their values, row-major.
struct ColumnGroup {
  std::vector<std::string> names;
  const std::vector<double>* numbers = nullptr;
  const std::vector<std::uint8_t>* flags = nullptr;
};

std::vector<std::string> axes_of(const std::string& prefix) {
  std::vector<std::string> names;
  for (const std::string_view axis : kAxisNames) names.push_back(prefix + std::string(axis));
  return names;
}

void extend(std::vector<std::string>& names, std::vector<std::string> more) {
  names.insert(names.end(), std::make_move_iterator(more.begin()),
               std::make_move_iterator(more.end()));
}

std::vector<std::string> with_prefix(std::string_view prefix,
                                     const std::vector<std::string>& names) {
  std::vector<std::string> all;
  for (const std::string& name : names) all.push_back(std::string(prefix) + name);
  return all;
}

std::vector<ColumnGroup> motion_groups(const MotionReference& reference) {
  std::vector<std::string> position = axes_of("root_"), velocity = axes_of("root_v"),
                           acceleration = axes_of("root_a");
  extend(position, {"root_qw", "root_qx", "root_qy", "root_qz"});
  extend(velocity, axes_of("root_w"));
  extend(acceleration, axes_of("root_dw"));
  extend(position, with_prefix("q:", reference.joint_names));
  extend(velocity, with_prefix("v:", reference.joint_names));
  extend(acceleration, with_prefix("a:", reference.joint_names));
  return {{{"time"}, &reference.time},
          {position, &reference.qpos},
          {velocity, &reference.qvel},
          {acceleration, &reference.qacc}};
}

void add_dynamics_groups(const MotionReference& reference, std::vector<ColumnGroup>& groups) {
  std::vector<std::string> residual = axes_of("residual_f"), places, forces;
  extend(residual, axes_of("residual_t"));
  for (const std::string& name : reference.contact_names) {
    extend(places, axes_of("p:" + name + ":"));
    extend(forces, axes_of("f:" + name + ":"));
  }
  const std::vector<ColumnGroup> more = {
      {with_prefix("tau:", reference.joint_names), &reference.torque},
      {residual, &reference.residual},
      {axes_of("com_"), &reference.com},
      {axes_of("com_v"), &reference.com_velocity},
      {axes_of("com_a"), &reference.com_acceleration},
      {axes_of("angular_momentum_"), &reference.angular_momentum},
      {with_prefix("c:", reference.contact_names), nullptr, &reference.contacts},
      {places, &reference.contact_position},
      {forces, &reference.contact_force}};
  groups.insert(groups.end(), more.begin(), more.end());
}

std::vector<ColumnGroup> column_groups(const MotionReference& reference) {
  std::vector<ColumnGroup> groups = motion_groups(reference);
  if (reference.has_dynamics) add_dynamics_groups(reference, groups);
  if (reference.planted) {
    std::vector<std::string> names;
    for (const std::string_view name : kContactNames)
      names.push_back("planted:" + std::string(name));
    groups.push_back({names, nullptr, &reference.planted->planted});
  }
  return groups;
}

void append_number(double value, std::string& text) {
  // No negative zeros, so that equal values have equal texts.
  fmt::format_to(std::back_inserter(text), "{:.9e}", value == 0.0 ? 0.0 : value);
}

std::string kind_text(ReferenceLimit::Kind kind, double value, double limit) {
  switch (kind) {
    case ReferenceLimit::Kind::kPosition:
      return fmt::format("is at {:.4f}, beyond its limit {:.4f}", value, limit);
    case ReferenceLimit::Kind::kSpeed:
      return fmt::format("moves at {:.2f} /s, faster than {:.2f}", value, limit);
    case ReferenceLimit::Kind::kTorque:
      break;
  }
  return fmt::format("needs {:.1f} N m, more than {:.1f}", value, limit);
}

}  // namespace

std::vector<std::string> reference_columns(const MotionReference& reference) {
  std::vector<std::string> names;
  for (ColumnGroup& group : column_groups(reference)) extend(names, std::move(group.names));
  return names;
}

std::string format_reference_csv(const MotionReference& reference) {
  const std::vector<ColumnGroup> groups = column_groups(reference);
  std::string text = fmt::format("{}\n", fmt::join(reference_columns(reference), ","));
  for (std::size_t row = 0; row < reference.samples; ++row) {
    const std::size_t begin = text.size();
    for (const ColumnGroup& group : groups) {
      const std::size_t width = group.names.size();
      for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
        if (text.size() > begin) text += ',';
        if (group.numbers != nullptr) {
          append_number((*group.numbers)[i], text);
        } else {
          text += (*group.flags)[i] != 0 ? '1' : '0';
        }
      }
    }
    text += '\n';
  }
  return text;
}

Result<std::string> format_reference_npz(const MotionReference& reference) {
  const std::size_t rows = reference.samples, joints = reference.joint_names.size(),
                    points = reference.contact_names.size();
  NpzWriter file;
  const auto table = [&](std::string_view name, const std::vector<double>& values,
                         std::size_t width) {
    file.add(name, float64_array(values, {rows, width}));
  };
  file.add("fps", float64_array(std::vector<double>{reference.rate.fps()}, {1}));
  file.add("joint_names", text_array(reference.joint_names));
  file.add("time", float64_array(reference.time, {rows}));
  table("qpos", reference.qpos, 7 + joints);
  table("qvel", reference.qvel, 6 + joints);
  table("qacc", reference.qacc, 6 + joints);
  file.add("joint_lower", float64_array(reference.lower, {joints}));
  file.add("joint_upper", float64_array(reference.upper, {joints}));
  file.add("speed_limits", float64_array(reference.speed_limits, {joints}));
  file.add("torque_limits", float64_array(reference.torque_limits, {joints}));
  if (reference.has_dynamics) {
    file.add("mass", float64_array(std::vector<double>{reference.mass}, {1}));
    table("torque", reference.torque, joints);
    table("residual", reference.residual, 6);
    table("com", reference.com, 3);
    table("com_vel", reference.com_velocity, 3);
    table("com_acc", reference.com_acceleration, 3);
    table("angular_momentum", reference.angular_momentum, 3);
    file.add("contact_names", text_array(reference.contact_names));
    file.add("contact_links", text_array(reference.contact_links));
    file.add("contacts", bool_array(reference.contacts, {rows, points}));
    file.add("contact_pos", float64_array(reference.contact_position, {rows, points, 3}));
    file.add("contact_force", float64_array(reference.contact_force, {rows, points, 3}));
  }
  if (reference.planted) {
    std::vector<std::string> names(kContactNames.begin(), kContactNames.end());
    file.add("planted", bool_array(reference.planted->planted, {rows, kContactNames.size()}));
    file.add("planted_names", text_array(names));
  }
  return file.finish();
}

std::vector<std::string> reference_notes(const MotionReference& reference) {
  std::vector<std::string> notes;
  if (!reference.corrections.empty()) {
    const auto largest =
        std::ranges::max_element(reference.corrections, {}, &ReferenceCorrection::largest);
    notes.push_back(
        fmt::format("{} kept inside limits between frames, by at most {:.4f} ({}, near {:.2f} s)",
                    count_text(reference.corrections.size(), "joint"), largest->largest,
                    largest->joint, largest->time));
  }
  for (const ReferenceLimit& beyond : reference.beyond) {
    notes.push_back(fmt::format("{} {} at {:.3f} s", beyond.joint,
                                kind_text(beyond.kind, beyond.value, beyond.limit), beyond.time));
  }
  return notes;
}

}  // namespace retarget

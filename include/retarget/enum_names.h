#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "retarget/export.h"
#include "retarget/options.h"

namespace RETARGET_API retarget {

template <typename Enum>
using NamedValue = std::pair<Enum, std::string_view>;

/// Names of an enum's values in options, in display order. Each enum with names specialises this.
template <typename Enum>
inline constexpr auto kEnumNames = nullptr;

template <typename Enum>
concept Named = requires {
  kEnumNames<Enum>.size();
};

template <>
inline constexpr auto kEnumNames<Method> =
    std::to_array<NamedValue<Method>>({{Method::kFit, "fit"}, {Method::kGmr, "gmr"}});
template <>
inline constexpr auto kEnumNames<IkEngine> = std::to_array<NamedValue<IkEngine>>(
    {{IkEngine::kFast, "fast"}, {IkEngine::kReference, "reference"}});
template <>
inline constexpr auto kEnumNames<LeadIn> = std::to_array<NamedValue<LeadIn>>(
    {{LeadIn::kAuto, "auto"}, {LeadIn::kDrop, "drop"}, {LeadIn::kKeep, "keep"}});
template <>
inline constexpr auto kEnumNames<CleanRule> =
    std::to_array<NamedValue<CleanRule>>({{CleanRule::kAuto, "auto"}, {CleanRule::kOff, "off"}});
template <>
inline constexpr auto kEnumNames<HandsRule> =
    std::to_array<NamedValue<HandsRule>>({{HandsRule::kAuto, "auto"},
                                          {HandsRule::kFollow, "follow"},
                                          {HandsRule::kRelaxed, "relaxed"},
                                          {HandsRule::kOff, "off"}});
template <>
inline constexpr auto kEnumNames<Interpolation> = std::to_array<NamedValue<Interpolation>>(
    {{Interpolation::kLinear, "linear"}, {Interpolation::kCubic, "cubic"}});
template <>
inline constexpr auto kEnumNames<RobotBase> = std::to_array<NamedValue<RobotBase>>(
    {{RobotBase::kAuto, "auto"}, {RobotBase::kFixed, "fixed"}});
template <>
inline constexpr auto kEnumNames<Follow> =
    std::to_array<NamedValue<Follow>>({{Follow::kAll, "all"}, {Follow::kArms, "arms"}});
template <>
inline constexpr auto kEnumNames<SceneAxes> = std::to_array<NamedValue<SceneAxes>>(
    {{SceneAxes::kHuman, "human"}, {SceneAxes::kClip, "clip"}});
template <>
inline constexpr auto kEnumNames<ObjectMotion> = std::to_array<NamedValue<ObjectMotion>>(
    {{ObjectMotion::kGiven, "given"}, {ObjectMotion::kFitted, "fitted"}});

template <>
inline constexpr auto kEnumNames<Purpose> = std::to_array<NamedValue<Purpose>>({{Purpose::kTracking,
                                                                                 "tracking"}});
template <>
inline constexpr auto kEnumNames<ScaleRule> = std::to_array<NamedValue<ScaleRule>>(
    {{ScaleRule::kTable, "table"}, {ScaleRule::kHeight, "height"}, {ScaleRule::kLimbs, "limbs"}});
// kFrame is selected by a frame number and has no name.
template <>
inline constexpr auto kEnumNames<RestPose> =
    std::to_array<NamedValue<RestPose>>({{RestPose::kAuto, "auto"},
                                         {RestPose::kZero, "zero"},
                                         {RestPose::kFirst, "first"},
                                         {RestPose::kBest, "best"},
                                         {RestPose::kLearned, "learned"}});
template <>
inline constexpr auto kEnumNames<MotionFormat> =
    std::to_array<NamedValue<MotionFormat>>({{MotionFormat::kCsv, "csv"},
                                             {MotionFormat::kCsvSoma, "csv-soma"},
                                             {MotionFormat::kNpzMjlab, "npz-mjlab"},
                                             {MotionFormat::kNpzBeyondMimic, "npz-beyondmimic"},
                                             {MotionFormat::kNpzHolosoma, "npz-holosoma"},
                                             {MotionFormat::kPklGmr, "pkl-gmr"},
                                             {MotionFormat::kPklPbhc, "pkl-pbhc"},
                                             {MotionFormat::kPklMotionLib, "pkl-motion-lib"},
                                             {MotionFormat::kPklMimicKit, "pkl-mimickit"},
                                             {MotionFormat::kProtoMotions, "protomotions"},
                                             {MotionFormat::kCsvSonic, "csv-sonic"},
                                             {MotionFormat::kGlb, "glb"}});
template <>
inline constexpr auto kEnumNames<QuaternionOrder> = std::to_array<NamedValue<QuaternionOrder>>(
    {{QuaternionOrder::kXyzw, "xyzw"}, {QuaternionOrder::kWxyz, "wxyz"}});
template <>
inline constexpr auto kEnumNames<BodyPoint> =
    std::to_array<NamedValue<BodyPoint>>({{BodyPoint::kLink, "link"}, {BodyPoint::kMass, "mass"}});
template <>
inline constexpr auto kEnumNames<Delimiter> = std::to_array<NamedValue<Delimiter>>(
    {{Delimiter::kComma, "comma"}, {Delimiter::kSpace, "space"}, {Delimiter::kTab, "tab"}});

template <Named Enum>
[[nodiscard]] std::string_view enum_name(Enum value) {
  for (const auto& [known, name] : kEnumNames<Enum>) {
    if (known == value) return name;
  }
  return {};
}

template <Named Enum>
[[nodiscard]] std::optional<Enum> enum_from_name(std::string_view name) {
  for (const auto& [value, known] : kEnumNames<Enum>) {
    if (known == name) return value;
  }
  return std::nullopt;
}

template <Named Enum>
[[nodiscard]] std::vector<std::string> enum_names() {
  std::vector<std::string> names;
  names.reserve(std::size(kEnumNames<Enum>));
  for (const auto& [value, name] : kEnumNames<Enum>) names.emplace_back(name);
  return names;
}

}  // namespace retarget

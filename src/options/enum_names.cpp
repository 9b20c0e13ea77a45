#include "options/enum_names.h"

#include <array>

namespace retarget {

std::span<const NamedValue<Method>> named_values(Method) {
  static constexpr std::array<NamedValue<Method>, 2> kNames = {
      {{Method::kFit, "fit"}, {Method::kGmr, "gmr"}}};
  return kNames;
}

std::span<const NamedValue<IkEngine>> named_values(IkEngine) {
  static constexpr std::array<NamedValue<IkEngine>, 2> kNames = {
      {{IkEngine::kFast, "fast"}, {IkEngine::kReference, "reference"}}};
  return kNames;
}

std::span<const NamedValue<LeadIn>> named_values(LeadIn) {
  static constexpr std::array<NamedValue<LeadIn>, 3> kNames = {
      {{LeadIn::kAuto, "auto"}, {LeadIn::kDrop, "drop"}, {LeadIn::kKeep, "keep"}}};
  return kNames;
}

std::span<const NamedValue<Interpolation>> named_values(Interpolation) {
  static constexpr std::array<NamedValue<Interpolation>, 2> kNames = {
      {{Interpolation::kLinear, "linear"}, {Interpolation::kCubic, "cubic"}}};
  return kNames;
}

std::span<const NamedValue<ScaleRule>> named_values(ScaleRule) {
  static constexpr std::array<NamedValue<ScaleRule>, 4> kNames = {{{ScaleRule::kAuto, "auto"},
                                                                   {ScaleRule::kTable, "table"},
                                                                   {ScaleRule::kHeight, "height"},
                                                                   {ScaleRule::kLimbs, "limbs"}}};
  return kNames;
}

std::span<const NamedValue<RestPose>> named_values(RestPose) {
  // kFrame is chosen by its frame, and has no name
  static constexpr std::array<NamedValue<RestPose>, 5> kNames = {{{RestPose::kAuto, "auto"},
                                                                  {RestPose::kZero, "zero"},
                                                                  {RestPose::kFirst, "first"},
                                                                  {RestPose::kBest, "best"},
                                                                  {RestPose::kLearned, "learned"}}};
  return kNames;
}

std::span<const NamedValue<MotionFormat>> named_values(MotionFormat) {
  static constexpr std::array<NamedValue<MotionFormat>, 6> kNames = {
      {{MotionFormat::kCsv, "csv"},
       {MotionFormat::kCsvSoma, "csv-soma"},
       {MotionFormat::kNpzMjlab, "npz-mjlab"},
       {MotionFormat::kNpzBeyondMimic, "npz-beyondmimic"},
       {MotionFormat::kPklGmr, "pkl-gmr"},
       {MotionFormat::kPklPbhc, "pkl-pbhc"}}};
  return kNames;
}

std::span<const NamedValue<QuaternionOrder>> named_values(QuaternionOrder) {
  static constexpr std::array<NamedValue<QuaternionOrder>, 2> kNames = {
      {{QuaternionOrder::kXyzw, "xyzw"}, {QuaternionOrder::kWxyz, "wxyz"}}};
  return kNames;
}

std::span<const NamedValue<BodyPoint>> named_values(BodyPoint) {
  static constexpr std::array<NamedValue<BodyPoint>, 2> kNames = {
      {{BodyPoint::kLink, "link"}, {BodyPoint::kMass, "mass"}}};
  return kNames;
}

std::span<const NamedValue<Delimiter>> named_values(Delimiter) {
  static constexpr std::array<NamedValue<Delimiter>, 3> kNames = {
      {{Delimiter::kComma, "comma"}, {Delimiter::kSpace, "space"}, {Delimiter::kTab, "tab"}}};
  return kNames;
}

}  // namespace retarget

#pragma once

#include <memory>

#include "human/gait/contact_plan.h"
#include "human/gait/source_feet.h"

namespace retarget {

/// Computes find_contacts() repeatedly, for example for a growing clip. Reuses its memory: nothing
/// is allocated for clips that are no longer than an earlier clip or the reserved length.
class ContactPlanner {
 public:
  ContactPlanner();
  ~ContactPlanner();
  ContactPlanner(ContactPlanner&&) noexcept;
  ContactPlanner& operator=(ContactPlanner&&) noexcept;

  /// Valid until the next call.
  [[nodiscard]] const ContactPlan& plan(const SourceFeet& source,
                                        const ContactOptions& options = {});
  void reserve(int frames);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace retarget

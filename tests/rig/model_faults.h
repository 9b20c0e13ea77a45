#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "retarget/rig.h"
#include "rig/finding_texts.h"
#include "support/built_humanoids.h"
#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {

inline void replace_all(std::string& text, const std::string& from, const std::string& to) {
  ASSERT_NE(text.find(from), std::string::npos) << from;
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

class ModelFaults : public ::testing::Test {
 protected:
  std::string write(const std::string& text, const std::string& file = "robot.xml") {
    return folder_.write(file, text);
  }
  // The message with which robots add rejects a model, with its hint.
  std::string refusal(const std::string& text, const std::string& file = "robot.xml") {
    const auto made = make_robot(write(text, file), "robot");
    EXPECT_FALSE(made.has_value());
    if (made) return {};
    EXPECT_EQ(made.error().kind, ErrorKind::kConfig);
    EXPECT_EQ(made.error().message.find('\n'), std::string::npos) << made.error().message;
    return made.error().message + "; " + made.error().hint;
  }
  std::vector<std::string> notes(const std::string& text, const std::string& file = "robot.xml") {
    return value_of(make_robot(write(text, file), "robot")).notes;
  }
  std::vector<std::string> findings(const std::string& text, bool faults) {
    RobotSources sources;
    sources.model = write(text);
    return finding_texts(check_robot(sources), faults);
  }
  void expect_refused(const std::string& text, const std::string& what) {
    EXPECT_THAT(refusal(text), ::testing::HasSubstr(what));
    EXPECT_THAT(findings(text, true), ::testing::Contains(::testing::HasSubstr(what)));
  }
  void expect_noted(const std::string& text, const std::string& what) {
    EXPECT_THAT(notes(text), ::testing::Contains(::testing::HasSubstr(what)));
    EXPECT_THAT(findings(text, false), ::testing::Contains(::testing::HasSubstr(what)));
    EXPECT_THAT(findings(text, true), ::testing::IsEmpty());
  }

  TemporaryFolder folder_;
};

inline BuiltHumanoid changed(const std::function<void(BuiltHumanoid&)>& change) {
  BuiltHumanoid built = plain_humanoid();
  change(built);
  return built;
}

}  // namespace retarget

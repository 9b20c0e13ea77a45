#include "base/parse_xml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "support/processor_time.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;

std::string attributes(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += " a" + std::to_string(i) + "=\"1\"";
  return text;
}

// Returns the error message; empty if the text is parsed.
std::string xml_message(const std::string& text) {
  tinyxml2::XMLDocument document;
  const double begin = processor_time();
  const auto parsed = parse_xml(text, document);
  EXPECT_LT(processor_time() - begin, 2);
  EXPECT_EQ(parsed.has_value(), !document.Error() && document.RootElement() != nullptr);
  return parsed ? std::string() : parsed.error().message;
}

TEST(ParseXml, AcceptsUpToAHundredAttributes) {
  EXPECT_EQ(xml_message("<a" + attributes(kMaxXmlAttributes) + "/>"), "");
  EXPECT_EQ(xml_message("<a" + attributes(kMaxXmlAttributes) + "><b" +
                        attributes(kMaxXmlAttributes) + "/></a>"),
            "");
}

TEST(ParseXml, RejectsMoreAttributesWithTheLine) {
  tinyxml2::XMLDocument document;
  const auto parsed =
      parse_xml("<a>\n<b/>\n<c\n" + attributes(kMaxXmlAttributes + 1) + "/></a>", document);
  ASSERT_FALSE(parsed);
  EXPECT_EQ(parsed.error().message, "an element has more than 100 attributes");
  EXPECT_EQ(parsed.error().location.line, 3U);
  EXPECT_FALSE(document.Error());
}

TEST(ParseXml, ParsesManyAttributesInLinearTime) {
  const std::string many = attributes(200'000);
  for (const std::string& text :
       {"<a" + many + "/>", "<a" + many, "<?xml version='1.0'?><!-- < \" --><a><b " + many + "/>",
        "<a x='>'" + many + "/>", "<a x=\"'\"" + many + "/>", "text<a" + many + "/>",
        "<a/><![CDATA[ <b ]]><c" + many + "/>", "<!DOCTYPE a><a" + many + "/>"}) {
    EXPECT_THAT(xml_message(text), HasSubstr("attributes")) << text.substr(0, 40);
  }
}

TEST(ParseXml, LongFilesOfManyAttributesAreRead) {
  std::string text = "<a>";
  for (int i = 0; i < 2000; ++i) text += "<b" + attributes(kMaxXmlAttributes) + "/>";
  EXPECT_EQ(xml_message(text + "</a>"), "");
}

TEST(ParseXml, QuotesInTextAndCommentsAreNotAttributes) {
  std::string quotes;
  for (int i = 0; i < 1000; ++i) quotes += "a=\"1\" ";
  EXPECT_EQ(xml_message("<a>" + quotes + "</a>"), "");
  EXPECT_EQ(xml_message("<a><!-- <b " + quotes + "> --></a>"), "");
  EXPECT_EQ(xml_message("<a><![CDATA[<b " + quotes + ">]]></a>"), "");
  EXPECT_EQ(xml_message("<?xml " + quotes + "?><a/>"), "");
}

TEST(ParseXml, NamesTheMalformedPart) {
  EXPECT_EQ(xml_message("<a><b></a>"), "XML_ERROR_MISMATCHED_ELEMENT");
  EXPECT_EQ(xml_message(""), "XML_ERROR_EMPTY_DOCUMENT");
}

}  // namespace
}  // namespace retarget

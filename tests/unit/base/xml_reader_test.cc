#include "base/xml/xml_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/base/scratch_file.h"

namespace koboshi {
namespace {

using testing::ElementsAre;

XmlRule box_rule() {
  return {.name = "boxes",
          .attributes = {{.name = "unit"}, {"count", XmlContent::kInteger, false, {.min = 0, .max = 9}}},
          .children = {{.name = "box",
                        .count = XmlCount::kRepeated,
                        .children = {{.name = "size",
                                      .content = XmlContent::kNumbers,
                                      .count = XmlCount::kRequired,
                                      .numbers = 3,
                                      .range = {.min = 0}},
                                     {.name = "label", .content = XmlContent::kText},
                                     {.name = "mass", .content = XmlContent::kNumbers}}},
                       {.name = "notes", .content = XmlContent::kAnything}}};
}

// Returns the complaint of reading `text`, with the file's name as FILE; "nothing" if there is none.
std::string complaint(const std::string& text) {
  const ScratchFile scratch("xml", text);
  try {
    XmlFile file(scratch.path(), box_rule());
  } catch (const InputError& error) {
    std::string message = error.what();
    if (message.starts_with(scratch.path().string()))
      message.replace(0, scratch.path().string().size(), "FILE");
    return message;
  }
  return "nothing";
}

std::string boxes(const std::string& content) { return "<boxes unit='m'>\n" + content + "\n</boxes>"; }

TEST(XmlReader, ChecksTextWhereItEnters) {
  EXPECT_EQ(complaint(""), "FILE:1: found an empty file, expected an XML element");
  EXPECT_EQ(complaint("<!-- nothing -->\n"), "FILE:1: found no element, expected <boxes>");
  EXPECT_EQ(complaint(boxes("<!-- f\xFCr -->")),
            "FILE:2: found a byte that is not UTF-8, expected UTF-8 text");
  const auto nested = [](int levels) {
    std::string text;
    for (int i = 0; i < levels; ++i) text = "<notes>" + text + "</notes>";
    return complaint("<boxes unit='m'>\n" + text + "</boxes>");
  };
  EXPECT_EQ(nested(89), "nothing");  // and the root
  for (const int levels : {90, 200, 600})
    EXPECT_EQ(nested(levels),
              "FILE:2: found elements nested deeper than 90 levels, expected at most 90 levels");
}

TEST(XmlReader, RejectsNamesWithWhiteSpaceAtTheirEnds) {
  const auto label = [](const std::string& text) {
    return complaint(boxes("<box><size>1 2 3</size><label>" + text + "</label></box>"));
  };
  EXPECT_EQ(label("two words"), "nothing");
  EXPECT_EQ(label("a "), "FILE:2: found <label> = \"a \", expected a text without white space at its end");
  EXPECT_EQ(label("a&#1;b"), "FILE:2: found <label> = \"a b\", expected a text without a control character");
  EXPECT_EQ(label("a&#xD800;"),
            "FILE:2: found <label> = \"a\\xED\\xA0\\x80\", expected a text without a byte that is not UTF-8");
}

TEST(XmlReader, ReadsWhatTheSchemaAllows) {
  const ScratchFile scratch(
      "xml",
      "<?xml version='1.0'?>\n<!-- a comment -->\n<boxes unit='m' count='2'>\n"
      "<box><size>1 2e-1 +3</size><label>a</label></box>\n<!-- another -->\n"
      "<box><size>\n 4 5 6 </size><mass>0.5</mass></box>\n<notes any='1'>free <b>text</b></notes></boxes>");
  const XmlFile file(scratch.path(), box_rule());
  const XmlNode root = file.root();
  EXPECT_EQ(root.name(), "boxes");
  EXPECT_EQ(root.attribute("unit"), "m");
  EXPECT_EQ(root.attribute_integer("count"), 2);
  EXPECT_EQ(root.attribute_integer("none", 7), 7);
  EXPECT_FALSE(root.find_attribute("none"));
  const std::vector<XmlNode> all = root.children("box");
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[1].line(), 6);
  EXPECT_THAT(all[0].child("size").numbers(), ElementsAre(1, 0.2, 3));
  EXPECT_EQ(all[0].child("label").text(), "a");
  EXPECT_FALSE(all[1].find("label"));
  EXPECT_EQ(all[1].number("mass"), 0.5);
  EXPECT_EQ(all[0].number("mass", 9.0), 9.0);
}

TEST(XmlReader, RejectsMalformedXml) {
  EXPECT_EQ(complaint("<boxes unit='m'>\n<box>\n</boxes>"),
            "FILE:2: found XML error: mismatched element, expected well-formed XML");
  EXPECT_EQ(complaint("<boxes unit='m' unit='m'/>"),
            "FILE:1: found XML error: parsing attribute, expected well-formed XML");
  EXPECT_EQ(complaint("<!-- nothing -->"), "FILE:1: found no element, expected <boxes>");
  EXPECT_EQ(complaint("<boxes unit='m'/>\n<boxes unit='m'/>"),
            "FILE:2: found a second root element, expected one");
  EXPECT_EQ(complaint("<crates/>"), "FILE:1: found <crates>, expected <boxes>");
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "<box>";
  EXPECT_EQ(complaint(deep),
            "FILE:1: found elements nested deeper than 90 levels, expected at most 90 levels");
  EXPECT_THROW(XmlFile("no/such.xml", box_rule()), InputError);
}

TEST(XmlReader, RejectsUnknownElementsAndAttributes) {
  EXPECT_EQ(complaint(boxes("<ball/>")),
            "FILE:2: found the unknown element <ball> in <boxes>, expected box or notes");
  EXPECT_EQ(complaint("<boxes unit='m'\n colour='red'/>"),
            "FILE:2: found the unknown attribute colour of <boxes>, expected unit or count");
  EXPECT_EQ(complaint(boxes("<box id='1'/>")),
            "FILE:2: found the unknown attribute id of <box>, expected no attribute");
  EXPECT_EQ(complaint(boxes("loose")), "FILE:2: found the text  loose  in <boxes>, expected box or notes");
  EXPECT_EQ(complaint(boxes("<box><size><x/></size></box>")),
            "FILE:2: found the element <x> in <size>, expected a value");
}

TEST(XmlReader, RejectsMissingAndDuplicateElements) {
  EXPECT_EQ(complaint("<boxes/>"), "FILE:1: found <boxes> without unit, expected that attribute");
  EXPECT_EQ(complaint(boxes("<box/>")), "FILE:2: found <box> without <size>, expected that element");
  EXPECT_EQ(complaint(boxes("<box><size>1 2 3</size>\n<size>1 2 3</size></box>")),
            "FILE:3: found a second <size> (the first is in line 2), expected one in <box>");
}

TEST(XmlReader, RejectsBadValues) {
  const auto size = [](const std::string& text) {
    return complaint(boxes("<box><size>" + text + "</size></box>"));
  };
  EXPECT_EQ(size("1 2 3"), "nothing");
  for (const char* text :
       {"1 2", "1 2 3 4", "1 2 x", "1 2 -3", "1 2 nan", "1 2 inf", "1,2,3", "1 2 1e999", ""}) {
    EXPECT_EQ(size(text),
              "FILE:2: found <size> = " + std::string(text) + ", expected 3 times a number of 0 or more");
  }
  EXPECT_EQ(complaint("<boxes unit='m' count='10'/>"),
            "FILE:1: found count = 10, expected a whole number from 0 to 9");
  EXPECT_EQ(complaint("<boxes unit='m' count='1.5'/>"),
            "FILE:1: found count = 1.5, expected a whole number from 0 to 9");
  EXPECT_EQ(complaint("<boxes unit=''/>"), "FILE:1: found unit = , expected a text");
}

}  // namespace
}  // namespace koboshi

#include "base/edit/xml_document.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "base/text/error.h"
#include "tests/support/temporary_folder.h"

namespace koboshi {
namespace {

const std::filesystem::path kRobotFileOfXml = KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf";
const std::string kRobotXml = R"(<?xml version="1.0"?>
<!-- A robot & its <parts>. -->
<sdf version='1.9'>
  <!-- <link name="none"/> is no link. -->
  <link  name="trunk"   side = 'left'>
    <mass> 0.36 </mass>   <!-- of the paper -->
    <size>1 2 3</size><pose relative_to="a &amp; b"/>
    <empty></empty>
    <note><![CDATA[<mass>7</mass>]]></note>
    <group>
      <one>1</one>
      <!-- between -->
      <two>2</two>
    </group>
  </link>
</sdf>
<!-- end -->
)";

XmlDocument xml_document(const std::string& text = kRobotXml) { return {"robot.sdf", text}; }

std::string xml_with(const std::string& before, const std::string& after) {
  std::string text = kRobotXml;
  const std::size_t at = text.find(before);
  EXPECT_NE(at, std::string::npos) << before;
  return text.replace(at, before.size(), after);
}

TEST(XmlDocument, ReplacesAValueAndNoOtherByte) {
  XmlDocument document = xml_document();
  document.set_text({0, 0}, "0.4");
  EXPECT_EQ(document.text(), xml_with(" 0.36 ", " 0.4 "));
  document.set_text({0, 0}, "0.5", XmlDocument::Blanks::kGo);
  EXPECT_EQ(document.text(), xml_with(" 0.36 ", "0.5"));
  document = xml_document();
  document.set_text({0, 1}, "4 5 6");
  EXPECT_EQ(document.text(), xml_with("1 2 3", "4 5 6"));
  document = xml_document();
  document.set_text({0, 2}, "x < y");
  EXPECT_EQ(document.text(), xml_with("\"a &amp; b\"/>", "\"a &amp; b\">x &lt; y</pose>"));
  EXPECT_EQ(document.find({0, 2})->content(), "x < y");
  document = xml_document();
  document.set_text({0, 3}, "full");
  EXPECT_EQ(document.text(), xml_with("<empty></empty>", "<empty>full</empty>"));
}

TEST(XmlDocument, ReplacesAddsAndRemovesAttributes) {
  XmlDocument document = xml_document();
  document.set_attribute({0}, "side", "it's");
  EXPECT_EQ(document.text(), xml_with("'left'", "'it&apos;s'"));
  EXPECT_EQ(*document.find({0})->attribute("side"), "it's");
  document.set_attribute({0}, "side", "left");
  document.set_attribute({0, 0}, "unit", "\"kg\" & <g>");
  EXPECT_EQ(document.text(), xml_with("<mass> 0.36", "<mass unit=\"&quot;kg&quot; &amp; &lt;g&gt;\"> 0.36"));
  document.erase_attribute({0, 0}, "unit");
  EXPECT_EQ(document.text(), kRobotXml);
  document.erase_attribute({0}, "name");
  EXPECT_EQ(document.text(), xml_with("<link  name=\"trunk\"   side", "<link   side"));
  document = xml_document();
  document.set_attribute({0, 2}, "new", "1");
  EXPECT_EQ(document.text(), xml_with("b\"/>", "b\" new=\"1\"/>"));
}

TEST(XmlDocument, InsertsElementsInTheLayoutOfTheirSiblings) {
  XmlDocument document = xml_document();
  document.insert_element({0, 5}, 2, "<three>3</three>");
  EXPECT_EQ(document.text(), xml_with("<two>2</two>\n", "<two>2</two>\n      <three>3</three>\n"));
  document = xml_document();
  document.insert_element({0, 5}, 0, "<zero/>");
  EXPECT_EQ(document.text(), xml_with("<group>\n", "<group>\n      <zero/>\n"));
  document = xml_document();
  document.insert_element({0, 2}, 0, "<in/>");
  EXPECT_EQ(document.text(), xml_with("b\"/>", "b\"><in/></pose>"));
  document = xml_document();
  document.insert_element({0}, 3, "<after/>");  // its sibling shares a line
  EXPECT_EQ(document.text(), xml_with("b\"/>", "b\"/><after/>"));
}

TEST(XmlDocument, RemovesElementsWithTheLineThatTheyLeaveBlank) {
  XmlDocument document = xml_document();
  document.erase_element({0, 5, 0});
  EXPECT_EQ(document.text(), xml_with("      <one>1</one>\n", ""));
  document = xml_document();
  document.erase_element({0, 0});
  EXPECT_EQ(document.text(), xml_with("<mass> 0.36 </mass>", ""));
  document = xml_document();
  document.erase_element({0, 5});
  EXPECT_EQ(document.find({0})->element_count(), 5U);
}

TEST(XmlDocument, KeepsLineEnds) {
  XmlDocument document("robot.sdf", "<a>\r\n  <b/>\r\n</a>\r\n");
  document.insert_element({}, 1, "<c/>");
  EXPECT_EQ(document.text(), "<a>\r\n  <b/>\r\n  <c/>\r\n</a>\r\n");
}

TEST(XmlDocument, RefusesWhatDoesNotFitAndChangesNothing) {
  XmlDocument document = xml_document();
  const std::vector<std::function<void()>> edits = {
      [&] {
        document.set_text({0, 5}, "1");
      },  // has elements
      [&] { document.set_text({7}, "1"); },
      [&] {
        document.set_text({0, 0}, std::string("a\0b", 3));
      },
      [&] { document.set_attribute({0}, "a b", "1"); },
      [&] { document.erase_attribute({0}, "weight"); },
      [&] { document.insert_element({0}, 0, "<open>"); },
      [&] { document.insert_element({0}, 0, "<one/><two/>"); },
      [&] { document.insert_element({0}, 0, "text"); },
      [&] { document.insert_element({0}, 9, "<one/>"); },
      [&] { document.erase_element({}); },
      [&] { document.replace_text("<a><b></a>"); },
      [&] { document.replace_text("<!DOCTYPE a [<!ENTITY b \"c\">]><a/>"); },
  };
  for (std::size_t i = 0; i < edits.size(); ++i) {
    EXPECT_THROW(edits[i](), InputError) << i;
    EXPECT_EQ(document.text(), kRobotXml) << i;
  }
  EXPECT_THROW(xml_document("no xml"), InputError);
  EXPECT_THROW(XmlDocument("nobody.sdf"), InputError);
}

// Texts that XML must escape, numbers, and letters beyond ASCII.
std::string random_text(std::mt19937& random) {
  constexpr std::array<std::string_view, 12> kPieces = {"0.5", "-1e-3", "&", "<",  ">",  "\"",
                                                        "'",   "x",     "ü", "倒", "]]", "--"};
  std::string text;
  for (auto pieces = 1 + random() % 4; pieces > 0; --pieces) text += kPieces[random() % kPieces.size()];
  return text;
}

XmlPath random_path(const XmlDocument& document, std::mt19937& random) {
  XmlPath path;
  while (true) {
    const std::size_t count = document.find(path)->element_count();
    if (count == 0 || random() % 6 == 0) return path;
    path.push_back(random() % count);
  }
}

// An edit of a random kind and place; edits that do not fit are refused.
void edit_somewhere(XmlDocument& document, std::mt19937& random) {
  const XmlPath path = random_path(document, random);
  const XmlPart& part = *document.find(path);
  switch (random() % 5) {
    case 0:
      return document.set_text(path, random_text(random));
    case 1:
      return document.set_attribute(path, part.attributes.empty() ? "added" : part.attributes.front().name,
                                    random_text(random));
    case 2:
      return document.erase_attribute(path, "added");
    case 3:
      return document.insert_element(path, random() % (part.element_count() + 1),
                                     "<added><one>1</one></added>");
    default:
      return document.erase_element(path);
  }
}

// XmlDocument itself compares the tree after each edit with the intended one.
TEST(XmlDocument, MakesRandomEditsOfRobotsOrRefusesThem) {
  for (const std::string& first : {kRobotXml, test::read_file(kRobotFileOfXml)}) {
    std::mt19937 random(20261124);
    XmlDocument document = xml_document(first);
    int refused = 0;
    const int edits = first.size() > 10'000 ? 150 : 1500;
    for (int i = 0; i < edits; ++i) {
      const std::string before = document.text();
      try {
        edit_somewhere(document, random);
      } catch (const InputError&) {
        ++refused;
        ASSERT_EQ(document.text(), before) << i;
      }
      if (document.text().size() < first.size() / 2) document.replace_text(first);
    }
    EXPECT_LT(refused, edits * 3 / 4);
  }
}

void collect_values(const XmlDocument& document, const XmlPath& path,
                    std::vector<std::pair<XmlPath, std::string>>& values) {
  const XmlPart& part = *document.find(path);
  if (!part.content().empty()) values.emplace_back(path, part.content());
  for (std::size_t i = 0; i < part.element_count(); ++i) {
    XmlPath child = path;
    child.push_back(i);
    collect_values(document, child, values);
  }
}

// Random values set one after the other and taken back in the opposite order: no other byte may move.
TEST(XmlDocument, ReturnsToTheFirstByteAfterRandomValues) {
  XmlDocument document(kRobotFileOfXml);
  const std::string first = document.text();
  std::vector<std::pair<XmlPath, std::string>> values;
  collect_values(document, {}, values);
  ASSERT_GT(values.size(), 500U);
  std::mt19937 random(7);
  std::vector<std::pair<XmlPath, std::string>> done;
  for (int i = 0; i < 150; ++i) {
    const XmlPath& path = values[random() % values.size()].first;
    done.emplace_back(path, document.find(path)->content());
    document.set_text(path, random_text(random));
  }
  ASSERT_NE(document.text(), first);
  for (auto change = done.rbegin(); change != done.rend(); ++change)
    document.set_text(change->first, change->second);
  EXPECT_EQ(document.text(), first);
}

}  // namespace
}  // namespace koboshi

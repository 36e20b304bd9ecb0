#include "base/xml/xml_draft.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/xml/xml_check.h"

namespace koboshi {
namespace {

using testing::ElementsAre;

XmlRule shelf_rule() {
  return {
      .name = "shelf",
      .attributes = {{.name = "unit"}, {.name = "count", .content = XmlContent::kInteger, .required = false}},
      .children = {{.name = "board",
                    .count = XmlCount::kRepeated,
                    .children = {{.name = "size",
                                  .content = XmlContent::kNumbers,
                                  .count = XmlCount::kRequired,
                                  .range = {.min = 0}},
                                 {.name = "label", .content = XmlContent::kText}}}}};
}

std::vector<std::string> found_in(const XmlDraft& draft) {
  std::vector<std::string> found;
  for (const XmlFault& fault : find_xml_faults(draft.root(), shelf_rule()))
    found.push_back(std::to_string(fault.line) + " " + fault.found);
  return found;
}

const char* const kFaulty =
    "<shelf count='many' colour='red'>\n<board><size>-1</size>\n<size>2</size>words</board>\n"
    "<board>\n<lable>a</lable></board></shelf>";

TEST(XmlDraft, ListsAllViolationsOfItsSchema) {
  const XmlDraft draft("FILE", kFaulty, shelf_rule());
  EXPECT_THAT(found_in(draft),
              ElementsAre("1 count = many", "1 the unknown attribute colour of <shelf>",
                          "1 <shelf> without unit", "2 <size> = -1",
                          "3 a second <size> (the first is in line 2)", "3 the text words in <board>",
                          "5 the unknown element <lable> in <board>", "4 <board> without <size>"));
}

TEST(XmlDraft, IsRepairedAndKeepsTheLines) {
  XmlDraft draft("FILE", kFaulty, shelf_rule());
  const XmlNode shelf = draft.root();
  draft.set_attribute(shelf, "unit", "m");
  draft.erase_attribute(shelf, "colour");
  draft.set_attribute(shelf, "count", "2");
  const XmlNode first = shelf.children("board")[0];
  const XmlNode second = shelf.children("board")[1];
  draft.set_text(first.child("size"), "1");
  draft.erase(first.children("size")[1]);
  draft.erase_texts(first);
  draft.rename(second.child("lable"), "label");
  EXPECT_THAT(found_in(draft), ElementsAre("4 <board> without <size>"));
  draft.erase(second);
  EXPECT_THAT(found_in(draft), ElementsAre());
  EXPECT_EQ(XmlDraft("FILE", draft.text(), shelf_rule()).root().child("board").number("size"), 1.0);
}

TEST(XmlNode, KnowsItsPathAndPlace) {
  const XmlDraft draft("FILE", kFaulty, shelf_rule());
  const XmlNode label = draft.root().children("board")[1].child("lable");
  EXPECT_THAT(label.path(), ElementsAre("shelf", "board", "lable"));
  EXPECT_THAT(label.place(), ElementsAre(1u, 0u));
  EXPECT_THAT(draft.root().place(), ElementsAre());
  EXPECT_EQ(label.parent()->line(), 4);
  EXPECT_FALSE(draft.root().parent());
}

TEST(XmlDraft, RefusesWhatIsNoXmlOfItsKind) {
  EXPECT_THROW(XmlDraft("FILE", "<shelf>", shelf_rule()), InputError);
  EXPECT_THROW(XmlDraft("FILE", "<table/>", shelf_rule()), InputError);
}

}  // namespace
}  // namespace koboshi

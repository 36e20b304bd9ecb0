#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "base/text/error.h"
#include "tools/motion_files/format/readers.h"

namespace koboshi::tools {
namespace {

using testing::Eq;
using testing::HasSubstr;
using testing::Optional;

std::string xml_notes_of(const ForeignMotion& motion) {
  std::string text;
  for (const ForeignNote& note : motion.notes) text += note.place + ": " + note.text + "\n";
  return text;
}

// Servos 1 and 3 go to 7,500 and 8,000 in 20 frames; servo 1 loses its torque; a call, which moves nothing;
// servo 1 gets a position, with a wrong checksum.
constexpr const char* kKondoMotion = R"(<?xml version="1.0"?>
<HeartToHeart4 Name="step">
  <Command CodeText="0D 10 0A 00 00 00 00 14 4C 1D 40 1F 03"/>
  <Command CodeText="07 0F 01 0A 00 80 A1"/>
  <Command CodeText="07 0C B8 0B 00 00 D6"/>
  <Block><Command>070F010A401F01</Command></Block>
</HeartToHeart4>
)";

TEST(KondoReader, ReadsPositionsFramesAndTorque) {
  EXPECT_THAT(recognise(kKondoMotion), Optional(MotionFormat::kKondo));
  const ForeignMotion motion = read_foreign_motions("a.h4p", kKondoMotion).front();
  EXPECT_EQ(motion.name, "step");
  ASSERT_EQ(motion.joints.size(), 2u);
  EXPECT_EQ(motion.joints[0].servo_id, 1);
  EXPECT_EQ(motion.joints[1].servo_id, 3);
  const auto& frames = motion.sections.front().frames;
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].move_us, 300'000);
  EXPECT_THAT(frames[0].values[0], Optional(7500.0));
  EXPECT_THAT(frames[0].values[1], Optional(8000.0));
  EXPECT_TRUE(frames[0].without_torque.empty());
  EXPECT_THAT(frames[1].values[0], Eq(std::nullopt));
  EXPECT_EQ(frames[1].without_torque, std::vector<std::size_t>{0});
  EXPECT_TRUE(frames[2].without_torque.empty());
}

TEST(KondoReader, SaysWhatItIgnoresAndWhatIsWrong) {
  const std::string notes = xml_notes_of(read_foreign_motions("a.h4p", kKondoMotion).front());
  EXPECT_THAT(notes, HasSubstr("1 command that move no servo are ignored"));
  EXPECT_THAT(notes, HasSubstr("line 6: its checksum is 1 instead of 128"));
  EXPECT_THAT(notes, testing::Not(HasSubstr("line 3")));
  EXPECT_THAT(
      xml_notes_of(
          read_foreign_motions("a.h4p", "<RCB4><C>0B 10 FF 00 00 00 00 0A 4C 1D 8D</C></RCB4>").front()),
      HasSubstr("line 1: has no position for servo 1 and those after it"));
  EXPECT_THROW(static_cast<void>(read_foreign_motions("a.h4p", "<RCB4><C>FF</C></RCB4>")), InputError);
  EXPECT_THROW(static_cast<void>(read_foreign_motions("a.h4p", "<RCB4><C>FF</D></RCB4>")), InputError);
}

constexpr const char* kXmlMotion = R"(<?xml version="1.0" encoding="utf-8"?>
<Root type="RoboPlusMotion" version="2.0">
  <FlowRoot/>
  <PageRoot>
    <Page name="empty"><steps/></Page>
    <Page name="squat"><param compile="1" motorSpeed="50"/>
      <steps>
        <step frame="64" pose="0 90"/>
        <step frame="128" pose="10 x"/>
        <step frame="100" pose="0 0"/>
      </steps>
    </Page>
  </PageRoot>
</Root>
)";

TEST(RoboplusXmlReader, ReadsFramesSinceTheStartAndDegrees) {
  EXPECT_THAT(recognise(kXmlMotion), Optional(MotionFormat::kRoboplusXml));
  const auto motions = read_foreign_motions("a.mtnx", kXmlMotion);
  ASSERT_EQ(motions.size(), 1u);
  const ForeignMotion& motion = motions.front();
  EXPECT_EQ(motion.page, 2);
  EXPECT_EQ(motion.name, "squat");
  const auto& frames = motion.sections.front().frames;
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0].move_us, 500'000);
  EXPECT_EQ(frames[1].move_us, 500'000);
  EXPECT_NEAR(*frames[0].values[1], 1.5707963, 1e-6);
  EXPECT_EQ(motion.joints[1].servo_id, 2);
  EXPECT_THAT(xml_notes_of(motion), HasSubstr("line 9: servo 2 keeps its angle: 'x' is none in degrees"));
  EXPECT_THAT(xml_notes_of(motion), HasSubstr("line 10: ignored: '100' is no frame after the one above"));
  EXPECT_THAT(xml_notes_of(motion), HasSubstr("flows, which play several pages, are ignored"));
}

TEST(RoboplusXmlReader, LeavesOtherXmlAlone) {
  EXPECT_THAT(recognise("<svg><path/></svg>"), Eq(std::nullopt));
  EXPECT_THAT(recognise("<?xml version='1.0'?>\n<robot name='a'/>"), Eq(std::nullopt));
}

}  // namespace
}  // namespace koboshi::tools

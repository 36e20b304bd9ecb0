#include "tools/motion_files/format/readers.h"

#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <vector>

#include "base/text/error.h"
#include "base/text/text.h"

namespace koboshi::tools {
namespace {

constexpr double kDegreeInRad = std::numbers::pi / 180.0;

ForeignMotion read_one(const std::string& bytes) {
  const auto motions = read_foreign_motions("file", bytes);
  EXPECT_EQ(motions.size(), 1u);
  return motions.front();
}

std::string message_of(const std::string& bytes) {
  try {
    static_cast<void>(read_foreign_motions("file", bytes));
  } catch (const InputError& error) {
    return error.what();
  }
  return "read";
}

std::string notes_of(const ForeignMotion& motion) {
  std::string text;
  for (const ForeignNote& note : motion.notes) text += note.place + ": " + note.text + "\n";
  return text;
}

// The binary page of ROBOTIS, with these bytes at these places and a right checksum.
class Page {
 public:
  Page(const std::string& name, int steps) : bytes_(512, '\0') {
    bytes_.replace(0, name.size(), name);
    set(15, 1);
    set(16, 0x0A);
    set(20, steps);
    set(22, 32);
  }
  Page& set(std::size_t place, int value) {
    bytes_[place] = static_cast<char>(value);
    return *this;
  }
  Page& step(std::size_t number, std::size_t servo, int position) {
    const std::size_t place = 64 + 64 * number + 2 * servo;
    return set(place, position & 0xFF).set(place + 1, position >> 8);
  }
  Page& times(std::size_t number, int pause, int time) {
    return set(64 + 64 * number + 62, pause).set(64 + 64 * number + 63, time);
  }
  std::string bytes() {
    set(31, 0);
    unsigned sum = 0;
    for (const char byte : bytes_) sum += static_cast<unsigned char>(byte);
    set(31, static_cast<int>(0xFFu - (sum & 0xFFu)));
    return bytes_;
  }

 private:
  std::string bytes_;
};

TEST(Recognise, TellsFormatsByTheirContents) {
  EXPECT_EQ(recognise("\xEF\xBB\xBF#WEBOTS_MOTION,V1.0,a\r\n"), MotionFormat::kWebots);
  EXPECT_EQ(recognise("type=motion\npage_begin\nstep=1 2 3\n"), MotionFormat::kRoboplusText);
  EXPECT_EQ(recognise(R"({"keyframes": [{"goals": {}}]})"), MotionFormat::kBitBots);
  EXPECT_EQ(recognise(R"({"stages": [{"keyFrames": []}]})"), MotionFormat::kBold);
  EXPECT_EQ(recognise("type: PoseSeq\nrefs: []\n"), MotionFormat::kPoseSeq);
  EXPECT_EQ(recognise("Time_s;left_knee\n0;1\n"), MotionFormat::kCsv);
  EXPECT_EQ(recognise(Page("bow", 1).bytes()), MotionFormat::kRoboplusPages);
  for (const char* other : {"", "version: 2\nrobot: koboshi\nname: bow\n", R"({"a": 1})", "left,right\n"})
    EXPECT_EQ(recognise(other), std::nullopt) << other;
  EXPECT_EQ(recognise(std::string(512, '\0')), std::nullopt);
}

TEST(Webots, HasTimesAnglesAndPartialPoses) {
  const ForeignMotion motion = read_one(
      "#WEBOTS_MOTION,V1.0,HeadYaw,LKneePitch\r\n"
      "00:00:000,Pose1,0.5,*\r\n"
      "00:01:240,Pose2,-0.25,1.5\r\n"
      "01:00:000,Pose3,*,x\r\n"
      "00:30:000,Pose4,0,0\r\n");
  EXPECT_EQ(motion.joints.size(), 2u);
  ASSERT_EQ(motion.sections.size(), 1u);
  const auto& frames = motion.sections[0].frames;
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].values, (std::vector<ForeignValue>{0.5, std::nullopt}));
  EXPECT_EQ(frames[1].move_us, 1'240'000);
  EXPECT_EQ(frames[2].move_us, 58'760'000);
  EXPECT_EQ(notes_of(motion),
            "line 4: ignored: 'x' is no angle of LKneePitch\n"
            "line 5: ignored: its time is before that of the pose above\n");
  EXPECT_EQ(message_of("#WEBOTS_MOTION,V1.0\n"),
            "file:1: found a header without joints, expected #WEBOTS_MOTION,V1.0 and the names of joints");
}

TEST(Csv, ReadsUnitsFromHeadersOrFromTheValues) {
  const ForeignMotion stated = read_one("time_ms,knee_deg,hip_rad\n0,90,1\n250,45,2\n");
  EXPECT_EQ(stated.joints[0].name, "knee");
  EXPECT_NEAR(*stated.sections[0].frames[0].values[0], 90 * kDegreeInRad, 1e-12);
  EXPECT_EQ(stated.sections[0].frames[1].values[1], 2.0);
  EXPECT_EQ(stated.sections[0].frames[1].move_us, 250'000);
  EXPECT_TRUE(stated.notes.empty());
  const ForeignMotion degrees = read_one("t;knee\n0;90\nx;45\n1.5;45\n");
  EXPECT_NEAR(*degrees.sections[0].frames[0].values[0], 90 * kDegreeInRad, 1e-12);
  EXPECT_NE(notes_of(degrees).find("'x' is no time"), std::string::npos) << notes_of(degrees);
  EXPECT_NE(notes_of(degrees).find("read as degrees"), std::string::npos);
  EXPECT_NE(notes_of(read_one("t,knee\n0,1.5\n")).find("read as rad"), std::string::npos);
}

TEST(Csv, ReadsUnitsInBrackets) {
  const ForeignMotion motion = read_one(
      "Time [ms],Knee [deg],Hip (rad),Waist (\u00B0),Arm [upper],Head (left) "
      "[DEG]\n0,90,1,30,0,45\n250,45,2,60,1,90\n");
  std::string names;
  for (const auto& joint : motion.joints) names += joint.name + ';';
  EXPECT_EQ(names, "Knee;Hip;Waist;Arm [upper];Head (left);");
  const auto& frame = motion.sections[0].frames.at(1);
  EXPECT_EQ(frame.move_us, 250'000);
  EXPECT_NEAR(frame.values[0].value(), 45 * kDegreeInRad, 1e-12);
  EXPECT_EQ(frame.values[1], 2.0);
  EXPECT_NEAR(frame.values[2].value(), 60 * kDegreeInRad, 1e-12);
  EXPECT_EQ(frame.values[3], 1.0);  // no unit
  EXPECT_NEAR(frame.values[4].value(), 90 * kDegreeInRad, 1e-12);
  EXPECT_EQ(read_one("Time (sec);knee (radians)\n0;1\n2;0\n").sections[0].frames.at(1).move_us, 2'000'000);
  EXPECT_EQ(read_one("t,[deg],knee_rad\n0,1,1\n").joints[0].name, "[deg]");
}

// Tables of spreadsheets in languages with a decimal comma.
TEST(Csv, ReadsDecimalCommasAndTheLineOfTheSeparator) {
  for (const std::string file : {"time;knee_rad;hip_rad\n0;0;0\n0,5;-1,25;+1e-1\n",
                                 "sep=;\ntime;knee_rad;hip_rad\n0;0;0\n0,5;-1,25;0,1\n",
                                 "\"sep=;\"\nTIME;KNEE_RAD;hip_rad\n0;0;0\n0.5;-1.25;0.1\n",
                                 "time\tknee_rad\thip_rad\n0\t0\t0\n0,5\t-1,25\t,1\n",
                                 "sep=\t\ntime\tknee_rad\thip_rad\n0\t0\t0\n0,5\t-1,25\t0,1\n",
                                 "time,knee_rad,hip_rad\n0,0,0\n\"0,5\",\"-1,25\",\"0,1\"\n"}) {
    const ForeignMotion motion = read_one(file);
    ASSERT_EQ(motion.joints.size(), 2u) << file;
    const auto& frames = motion.sections[0].frames;
    ASSERT_EQ(frames.size(), 2u) << file;
    EXPECT_EQ(frames[1].move_us, 500'000) << file;
    EXPECT_EQ(frames[1].values, (std::vector<ForeignValue>{-1.25, 0.1})) << file;
    EXPECT_EQ(notes_of(motion), "") << file;
  }
  // Marks of thousands are not guessed.
  const ForeignMotion thousands = read_one("t;knee_deg\n0;1.234,5\n1;1,234,5\n2;1\n");
  EXPECT_EQ(
      notes_of(thousands),
      "line 2: ignored: '1.234,5' is no angle of knee\nline 3: ignored: '1,234,5' is no angle of knee\n");
}

TEST(Csv, ReadsUtf16WithItsMark) {
  for (const bool little : {true, false}) {
    std::string bytes;
    for (const char c : std::string_view("\xFF"
                                         "sep=;\r\n\"time\";\"knee_rad\"\r\n0,5;1,5\r\n")) {
      const char high = c == '\xFF' ? '\xFE' : '\0';
      bytes += little ? std::string{c, high} : std::string{high, c};
    }
    const ForeignMotion motion = read_one(bytes);
    EXPECT_EQ(motion.joints.at(0).name, "knee");
    EXPECT_EQ(motion.sections[0].frames.at(0).values, (std::vector<ForeignValue>{1.5}));
    EXPECT_EQ(motion.sections[0].frames[0].move_us, 500'000);
    EXPECT_EQ(notes_of(motion), "text: is read as UTF-16\n");
  }
}

TEST(Csv, SkipsCommentsAboveTheHeaderAndBetweenRows) {
  const ForeignMotion motion =
      read_one("# recorded by hand\n// twice\n\ntime,knee\n# start\n0,0\n#1,5\n1,0.5\n");
  ASSERT_EQ(motion.sections[0].frames.size(), 2u);
  EXPECT_EQ(motion.sections[0].frames[1].place, "line 8");
  EXPECT_EQ(notes_of(motion),
            "line 4: angles without a unit are read as rad; name the columns JOINT_rad or JOINT_deg to say "
            "which\n");
  // numpy.savetxt writes the header as a comment.
  const ForeignMotion commented = read_one("# angles\n# time_ms,knee_rad\n# data\n0,0\n500,0.5\n");
  EXPECT_EQ(commented.joints.at(0).name, "knee");
  ASSERT_EQ(commented.sections[0].frames.size(), 2u);
  EXPECT_EQ(commented.sections[0].frames[1].move_us, 500'000);
  EXPECT_EQ(notes_of(commented), "");
  // But a comment does not make a table of other text.
  EXPECT_EQ(recognise("# time,knee\nversion: 2\n"), std::nullopt);
  EXPECT_EQ(recognise("# time,knee\n"), std::nullopt);
}

TEST(Csv, ReadsQuotedHeadersAndFields) {
  const ForeignMotion motion = read_one(
      "\"time_ms\", \"left, knee_deg\" ,\"the \"\"hip\"\"_rad\"\n\"0\",\"90\",1\n\"250\",\" 45 \",\"2\n");
  ASSERT_EQ(motion.joints.size(), 2u);
  EXPECT_EQ(motion.joints[0].name, "left, knee");
  EXPECT_EQ(motion.joints[1].name, "the \"hip\"");
  const auto& frames = motion.sections[0].frames;
  EXPECT_EQ(frames.at(1).move_us, 250'000);
  EXPECT_NEAR(frames[1].values[0].value(), 45 * kDegreeInRad, 1e-12);
  EXPECT_EQ(frames[1].values[1], 2.0);
  EXPECT_EQ(notes_of(motion), "");
}

TEST(Csv, LeavesOutColumnsWithoutAName) {
  const ForeignMotion empty = read_one("time,knee_rad,hip_rad,\n0,0,0,\n1,1,2,\n");
  ASSERT_EQ(empty.joints.size(), 2u);
  EXPECT_EQ(empty.sections[0].frames[1].values, (std::vector<ForeignValue>{1.0, 2.0}));
  EXPECT_EQ(notes_of(empty), "");
  const ForeignMotion filled = read_one("time,knee_rad,,hip_rad\n0,0,,0\n1,1,7,2,9\n2,1,8,2,9\n");
  ASSERT_EQ(filled.joints.size(), 2u);
  EXPECT_EQ(filled.sections[0].frames[1].values, (std::vector<ForeignValue>{1.0, 2.0}));
  EXPECT_EQ(notes_of(filled), "line 3: ignored: '7' in column 3, which has no name, and further ones\n");
  EXPECT_EQ(message_of("\n# none\ntime,,\n0,1,2\n"),
            "file:3: found a header without joints, expected a time and the names of joints");
}

TEST(Csv, SaysThatTheClockOfARecordingIsLeftOut) {
  const ForeignMotion late = read_one("time_s,knee_rad\n1200.5,0\n1201,1\n");
  EXPECT_EQ(late.sections[0].frames.at(0).move_us, 0);
  EXPECT_EQ(late.sections[0].frames.at(1).move_us, 500'000);
  EXPECT_EQ(notes_of(late),
            "line 2: the motion begins here, at 1200.5 s: only a first time from 0 to 10 s is that of the "
            "first move\n");
  EXPECT_NE(notes_of(read_one("time_s,knee_rad\n-1,0\n1,1\n")).find("begins here, at -1 s"),
            std::string::npos);
  const ForeignMotion first_move = read_one("time_s,knee_rad\n10,0\n11,1\n");
  EXPECT_EQ(first_move.sections[0].frames.at(0).move_us, 10'000'000);
  EXPECT_EQ(notes_of(first_move), "");
}

TEST(BitBots, HasDurationsPausesAndTorques) {
  const ForeignMotion motion = read_one(
      R"({"name": "up", "keyframes": [{"duration": 0.5, "pause": 0.25, "goals": {"knee": 90}, "torque": {"hip": 0, "knee": 1}},)"
      R"( {"duration": 1.0, "goals": {"hip": "x"}}, 7]})");
  EXPECT_EQ(motion.name, "up");
  ASSERT_EQ(motion.sections[0].frames.size(), 2u);
  const ForeignFrame& first = motion.sections[0].frames[0];
  EXPECT_EQ(first.move_us, 500'000);
  EXPECT_EQ(first.pause_us, 250'000);
  EXPECT_NEAR(*first.values[0], 90 * kDegreeInRad, 1e-12);
  EXPECT_EQ(motion.joints[first.without_torque.at(0)].name, "hip");
  EXPECT_EQ(notes_of(motion),
            "keyframe 2: ignored: the goal of hip is no number\nkeyframe 3: ignored: it is no object\n");
  EXPECT_EQ(message_of("{\n\"keyframes\": [{\"goals\": }]}"),
            "file:2: found text that is no JSON, expected a JSON document");
}

TEST(Bold, MirrorsNamesWithoutASide) {
  const ForeignMotion motion = read_one(
      R"({"name": "kick", "stages": [{"repeat": 2, "keyFrames": [{"moveCycles": 50, "pauseCycles": 5, )"
      R"("values": {"knee": 2148, "head-pan": 2000, "tail": 1}}]}]})");
  EXPECT_EQ(motion.unit, ForeignMotion::Unit::kTicks);
  EXPECT_EQ(motion.sections[0].repeat, 2);
  const ForeignFrame& frame = motion.sections[0].frames[0];
  EXPECT_EQ(frame.move_us, 400'000);
  EXPECT_EQ(frame.pause_us, 40'000);
  EXPECT_EQ(frame.values[13], 2148.0);  // servo 14, the left knee
  EXPECT_EQ(frame.values[12], 1948.0);
  EXPECT_EQ(frame.values[18], 2000.0);
  EXPECT_EQ(frame.values[0], std::nullopt);
  EXPECT_EQ(notes_of(motion), "stage 1, key frame 1: ignored: 'tail' is no joint of a DARwIn-OP\n");
}

TEST(PoseSeq, NumbersJointsAndKeepsTheLastOfTwoPosesAtOneTime) {
  const ForeignMotion motion = read_one(
      "type: PoseSeq\nname: wave\nrefs:\n"
      "  - {time: 0, refer: {type: Pose, joints: [3, 7], q: [0, 0]}}\n"
      "  - {time: 0, refer: {type: Pose, joints: [3, 7], q: [0.5, 1]}}\n"
      "  - {time: 1.5, refer: other}\n"
      "  - {time: 2, refer: {type: Pose, joints: [7], q: [2], isZmpStationaryPoint: true}}\n");
  EXPECT_TRUE(motion.is_smooth);
  EXPECT_EQ(motion.joints[1].servo_id, 7);
  const auto& frames = motion.sections[0].frames;
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0].values, (std::vector<ForeignValue>{0.5, 1.0}));
  EXPECT_EQ(frames[1].values, (std::vector<ForeignValue>{std::nullopt, 2.0}));
  EXPECT_EQ(frames[1].move_us, 2'000'000);
  EXPECT_NE(notes_of(motion).find("line 6: ignored"), std::string::npos) << notes_of(motion);
  EXPECT_NE(notes_of(motion).find("stationary points"), std::string::npos);
}

TEST(PoseSeq, MergesPosesAtOneTimeAndWaitsForShortTransitions) {
  const ForeignMotion motion = read_one(
      "type: PoseSeq\nrefs:\n"
      "  - {time: 0, refer: {type: Pose, joints: [3, 7], q: [0.25, 0]}}\n"
      "  - {time: 0, refer: {type: Pose, joints: [7], q: [1]}}\n"
      "  - {time: 3, maxTransitionTime: 1.25, refer: {type: Pose, joints: [7], q: [2]}}\n"
      "  - {time: 4, maxTransitionTime: 0, refer: {type: Pose, joints: [7], q: [3]}}\n"
      "  - {time: 5, maxTransitionTime: 1.5, refer: {type: Pose, joints: [7], q: [4]}}\n");
  const auto& frames = motion.sections[0].frames;
  ASSERT_EQ(frames.size(), 4u);
  EXPECT_EQ(frames[0].values, (std::vector<ForeignValue>{0.25, 1.0}));
  EXPECT_EQ(frames[0].pause_us, 1'750'000);
  EXPECT_EQ(frames[1].move_us, 1'250'000);
  EXPECT_EQ(frames[1].pause_us, 0);
  EXPECT_EQ(frames[2].move_us, 1'000'000);
  EXPECT_EQ(frames[3].move_us, 1'000'000);
  EXPECT_NE(notes_of(motion).find("line 4: replaces the angles of the pose above"), std::string::npos)
      << notes_of(motion);
}

TEST(RoboplusText, HasPagesWithFollowersAndSpeeds) {
  const std::string file =
      "type=motion\nversion=1.01\nenable=0 1 1\n"
      "page_begin\nname=first\ncompliance=5 5 5\nplay_param=2 0 3 2 32\nstep=512 300 400 0.5 1\nstep=0 512 x "
      "0 0.25\npage_end\n"
      "page_begin\nname=\nplay_param=0 0 1 1 32\nstep=0 100 200 0 1\npage_end\n"
      "page_begin\npage_end\n";
  const auto motions = read_foreign_motions("file", file);
  ASSERT_EQ(motions.size(), 2u);
  const ForeignMotion& first = motions[0];
  EXPECT_EQ(first.page, 1);
  EXPECT_EQ(first.name, "first");
  ASSERT_EQ(first.sections.size(), 2u);  // and the page that follows
  EXPECT_EQ(first.sections[0].repeat, 3);
  ASSERT_EQ(first.joints.size(), 2u);
  EXPECT_EQ(first.joints[0].servo_id, 1);
  EXPECT_EQ(first.sections[0].frames[0].move_us, 500'000);  // at double speed
  EXPECT_EQ(first.sections[0].frames[0].pause_us, 250'000);
  EXPECT_EQ(first.sections[0].frames[1].values, (std::vector<ForeignValue>{512.0, std::nullopt}));
  EXPECT_EQ(notes_of(first), "page 1, line 9: servo 2 keeps its position: 'x' is none\n");
  EXPECT_TRUE(motions[1].notes.empty());
  EXPECT_NE(message_of("page_begin\nstep=1\npage_end\n").find("found no page with a step"),
            std::string::npos);
}

TEST(RoboplusPages, HaveTimesUnusedServosAndChecksums) {
  Page page("bow", 2);
  for (std::size_t servo = 0; servo < 31; ++servo) page.step(0, servo, 0x4000).step(1, servo, 0x4000);
  page.step(0, 1, 2048).step(1, 1, 3072).step(1, 2, 0x2000).times(0, 10, 125).times(1, 0, 50);
  std::string file = std::string(512, '\0') + page.bytes();
  const ForeignMotion motion = read_one(file);
  EXPECT_EQ(motion.page, 1);
  EXPECT_EQ(motion.name, "bow");
  ASSERT_EQ(motion.joints.size(), 2u);
  const auto& frames = motion.sections[0].frames;
  EXPECT_EQ(frames[0].move_us, 1'000'000);
  EXPECT_EQ(frames[0].pause_us, 80'000);
  EXPECT_EQ(frames[1].values, (std::vector<ForeignValue>{3072.0, std::nullopt}));
  EXPECT_EQ(frames[1].without_torque, std::vector<std::size_t>{1});
  EXPECT_TRUE(motion.notes.empty()) << notes_of(motion);

  file[512 + 31] = static_cast<char>(file[512 + 31] + 1);
  file += Page("other", 1).step(0, 3, 100).times(0, 0, 10).bytes() + "rest";
  const auto motions = read_foreign_motions("file", file);
  ASSERT_EQ(motions.size(), 2u);
  EXPECT_EQ(notes_of(motions[0]),
            "page 1: its checksum is wrong; it is read all the same\nend: the last 4 bytes are no whole "
            "page, and ignored\n");
}

// Changes the checksum of each page that has steps.
std::string with_wrong_sums(std::string file) {
  for (std::size_t page = 0; page < file.size() / 512; ++page) {
    if (file[512 * page + 20] != 0) file[512 * page + 31] = static_cast<char>(file[512 * page + 31] + 1);
  }
  return file;
}

TEST(RoboplusPages, AreReadWithAllChecksumsWrongIfTheRestIsPlausible) {
  const auto page = [](const std::string& name) {
    return Page(name, 1).step(0, 1, 2048).step(0, 2, 0x4000).step(0, 3, 0x2000).times(0, 0, 125);
  };
  const std::string unused(512, '\0');
  const auto two =
      read_foreign_motions("file", with_wrong_sums(unused + page("a").bytes() + page("b").bytes() + unused));
  ASSERT_EQ(two.size(), 2u);
  for (const ForeignMotion& motion : two)
    EXPECT_EQ(notes_of(motion), "pages: all their checksums are wrong; they are read all the same\n");
  EXPECT_EQ(two[1].sections[0].frames.at(0).values.at(1), 2048.0);
  EXPECT_EQ(notes_of(read_one(with_wrong_sums(unused + page("a").bytes()))),
            "page 1: its checksum is wrong; it is read all the same\n");
  EXPECT_EQ(recognise(with_wrong_sums(page("a").set(16, 0).bytes())), MotionFormat::kRoboplusPages);
  // A single value that no page can have, or a page in which no servo moves, rules the format out.
  for (Page& other :
       std::vector{page("a").set(20, 8), page("a").set(16, 1), page("a\x01"), page("a").step(0, 5, 4096),
                   page("a").step(0, 5, 0x8000), page("a").step(0, 1, 0x4000), page("a").step(0, 1, 0)}) {
    EXPECT_EQ(recognise(with_wrong_sums(other.bytes())), std::nullopt);
    EXPECT_EQ(recognise(with_wrong_sums(page("b").bytes() + other.bytes())), std::nullopt);
  }
  // But beside a right page it is one.
  EXPECT_EQ(recognise(page("b").bytes() + with_wrong_sums(page("a").step(0, 5, 4096).bytes())),
            MotionFormat::kRoboplusPages);
}

TEST(RoboplusPages, HaveNamesInOneEncoding) {
  const auto page = [](const std::string& name) {
    return Page(name, 1).step(0, 1, 5).times(0, 0, 1).bytes();
  };
  // "bow" and "walk" in Shift-JIS. The first could be EUC-KR by itself.
  const auto japanese =
      read_foreign_motions("file", page("\xE7\xE7") + page("\x95\xE0\x82\xAD") + page("bow"));
  ASSERT_EQ(japanese.size(), 3u);
  EXPECT_EQ(japanese[1].name, "\xE6\xAD\xA9\xE3\x81\x8F");
  EXPECT_EQ(japanese[2].name, "bow");
  EXPECT_EQ(find_invalid_utf8(japanese[0].name), std::string::npos);
  EXPECT_EQ(notes_of(japanese[1]), "names of pages: are read as CP932\n");
  const auto korean = read_foreign_motions("file", page("\xC0\xCE\xBB\xE7"));
  EXPECT_EQ(korean.at(0).name, "\xEC\x9D\xB8\xEC\x82\xAC");
  // The field of 13 bytes cuts the seventh letter.
  const auto cut = read_foreign_motions("file", page("\x95\xE0\x95\xE0\x95\xE0\x95\xE0\x95\xE0\x95\xE0\x95"));
  EXPECT_EQ(cut.at(0).name.size(), 18u);
  EXPECT_EQ(cut[0].name.substr(0, 3), "\xE6\xAD\xA9");
  // These bytes are valid in no encoding.
  EXPECT_EQ(read_foreign_motions("file", page("a\xFF\xFF")).at(0).name, "a\\xFF\\xFF");
  EXPECT_TRUE(read_foreign_motions("file", page("bow")).at(0).notes.empty());
}

TEST(RoboplusPages, MoveBySpeedWhereTheScheduleSaysSo) {
  Page page("fast", 2);
  page.set(16, 0).step(0, 1, 0).step(1, 1, 512).times(0, 0, 64).times(1, 0, 64);
  const ForeignMotion motion = read_one(page.bytes());
  // 512 ticks of 300/1024 degrees at 64 * 720/256 degrees/s.
  EXPECT_EQ(motion.sections[0].frames[1].move_us, 833'333);
}

TEST(RoboplusPages, EndWhereAPageFollowsThatWasPlayed) {
  const std::string loop = Page("a", 1).set(25, 1).step(0, 1, 5).times(0, 0, 1).bytes() +
                           Page("b", 1).set(25, 0).step(0, 1, 6).times(0, 0, 1).bytes() +
                           Page("c", 1).set(25, 2).step(0, 1, 7).times(0, 0, 1).bytes();
  const auto motions = read_foreign_motions("file", loop);
  ASSERT_EQ(motions.size(), 3u);
  EXPECT_EQ(motions[0].sections.size(), 2u);
  EXPECT_TRUE(motions[0].notes.empty());
  EXPECT_EQ(motions[2].sections.size(), 1u);
  EXPECT_NE(notes_of(motions[2]).find("for ever"), std::string::npos);
}

TEST(ForeignMotions, NameTheFormatsAndWhatTheFileIs) {
  const std::string expected =
      ", expected a motion of Webots, ROBOTIS (.mtn, .bin, .mtnx), KONDO (.h4p), Choreonoid (.pseq), "
      "Bit-Bots or "
      "bold-humanoid (JSON), or a table (CSV)";
  EXPECT_EQ(message_of(std::string("KMOT\x02\0\0\0\x20\0\0\0", 12)),
            "file: found the image of a motion of Koboshi, which koboshi motion decompile reads" + expected);
  EXPECT_EQ(message_of("# bow\nversion: 2\nrobot: koboshi\nname: bow\nsteps: []\n"),
            "file: found a motion file of Koboshi, which needs no import" + expected);
  EXPECT_EQ(message_of("hello"), "file: found a file of no known format" + expected);
}

TEST(ForeignMotions, RefuseWhatIsNone) {
  for (const char* bytes : {"", "\n\n", "hello", "{}", "t,knee\n", "#WEBOTS_MOTION,V1.0,a\n",
                            "{\"keyframes\": [], \"goals\": 0}"})
    EXPECT_NE(message_of(bytes), "read") << bytes;
}

}  // namespace
}  // namespace koboshi::tools

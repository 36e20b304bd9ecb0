#include "simulation/observe/event_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <initializer_list>
#include <numbers>
#include <string>

#include "firmware/canopen/frame.h"

namespace koboshi::simulation {
namespace {

using behaviour::Reason;
using behaviour::State;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::uint8_t kSquat = 0;
constexpr std::uint8_t kFallFront = 1;

NamedModel model_of_knees() {
  NamedModel named;
  named.joint_names = {"left_knee", "right_knee"};
  named.model.joint_count = 2;
  named.model.joints[0].drive.node_id = 16;
  named.model.joints[1].drive.node_id = 17;
  return named;
}

Scenario scenario_of_two_motions() {
  Scenario scenario;
  scenario.motions = {{.file = "motions/squat.yaml"}, {.file = "motions/fall_front.yaml"}};
  return scenario;
}

Telemetry standing() {
  Telemetry said;
  said.state = State::kStanding;
  return said;
}

// A robot whose telemetry and attitude the test sets.
class EventLogTest : public testing::Test {
 protected:
  void play_until(double time_s) {
    const auto end_us = static_cast<std::uint64_t>(1e6 * time_s + 0.5);
    for (; now_us_ < end_us; now_us_ += 10'000) {
      log_.on_bus_frame({.identifier = 0x181, .size = 8}, now_us_ + 2'700, said_);
      log_.observe_tick(now_us_ + 10'000, said_, truth_, pushes_);
    }
  }
  void change(State state, Reason reason = Reason::kProgress, std::uint8_t motion = kSquat) {
    said_.state = state;
    said_.reason = reason;
    said_.motion = motion;
    play_until(1e-6 * static_cast<double>(now_us_) + 0.01);
  }
  void lean(double pitch_deg) {
    truth_.rpy_rad.y() = pitch_deg * std::numbers::pi / 180.0;
    truth_.tilt_rad = std::abs(truth_.rpy_rad.y());
  }
  void hear(std::uint16_t identifier, std::uint8_t size, std::array<std::uint8_t, 8> data) {
    log_.on_bus_frame({.identifier = identifier, .size = size, .data = data}, now_us_, said_);
  }
  std::vector<std::string> texts(bool dead = false) const {
    std::vector<std::string> texts;
    for (const RunEvent& event : log_.events(dead)) texts.push_back(event.text);
    return texts;
  }
  RunEvent event_of(const std::string& kind) const {
    for (const RunEvent& event : log_.events())
      if (event.kind == kind) return event;
    ADD_FAILURE() << "no event of the kind " << kind;
    return {};
  }
  void fall_and_get_up() {
    change(State::kFalling, Reason::kFallPredicted, kFallFront);
    lean(85.0);
    play_until(1e-6 * static_cast<double>(now_us_) + 0.5);
    change(State::kFallen);
    change(State::kRighting);
    change(State::kRising, Reason::kProne);
    lean(5.0);
    change(State::kSteadying);
    play_until(1e-6 * static_cast<double>(now_us_) + 1.0);
    change(State::kStanding);
  }

  const NamedModel model_ = model_of_knees();
  Scenario scenario_ = scenario_of_two_motions();
  std::vector<Push> pushes_;
  static constexpr walk::VelocityLimits kLimits{
      .forward_mm_per_s = 300, .backward_mm_per_s = 250, .lateral_mm_per_s = 100, .turn_mrad_per_s = 1000};
  EventLog log_{scenario_, model_, kLimits};
  Telemetry said_ = standing();
  GroundTruth truth_;
  std::uint64_t now_us_ = 0;
};

TEST_F(EventLogTest, ReportsAcceptedAndRefusedCommands) {
  play_until(1.0);
  hear(0x201, 3, {3, kSquat, 0});
  change(State::kMotion, Reason::kCommand);
  play_until(1.1);
  hear(0x201, 3, {1, 0, 0});
  said_.refusal = Reason::kNotInThisState;
  play_until(1.2);
  EXPECT_THAT(texts(), ElementsAre("Command play squat: obeyed.", "Plays the motion squat.",
                                   "Command enable: refused, not in this state (motion).",
                                   "End: plays squat; did not fall; 1 command refused; 0 faults."));
  const RunEvent refused = log_.events().at(2);
  EXPECT_EQ(refused.time_us, 1'100'000u);
  EXPECT_EQ(refused.kind, "command");
  EXPECT_EQ(refused.fields, (nlohmann::ordered_json{{"command", "enable"},
                                                    {"outcome", "refused"},
                                                    {"reason", "not in this state"},
                                                    {"state", "motion"}}));
  EXPECT_EQ(log_.last_command(), "enable: refused, not in this state (motion)");
}

TEST_F(EventLogTest, DoesNotMistakeEarlierTelemetryForTheAnswerToACommand) {
  said_.refusal = Reason::kNoSuchMotion;  // left from an earlier command
  play_until(1.0);
  hear(0x201, 3, {4, 0, 0});
  log_.on_bus_frame({.identifier = 0x181, .size = 8}, now_us_ + 2'700, said_);
  said_.refusal = Reason::kNone;
  now_us_ += 10'000;
  play_until(1.1);
  EXPECT_THAT(texts(), Contains("Command stop: obeyed."));
}

TEST_F(EventLogTest, ReportsTheOutcomeOfTheLastOfSeveralCommandsOnly) {
  play_until(1.0);
  hear(0x201, 3, {3, kSquat, 0});
  hear(0x201, 3, {1, 0, 0});
  said_.refusal = Reason::kNotInThisState;
  play_until(1.1);
  EXPECT_THAT(texts(), ElementsAre("Command play squat: outcome unknown, another command followed at once.",
                                   "Command enable: refused, not in this state (standing).",
                                   "End: stands; did not fall; 1 command refused; 0 faults."));
  EXPECT_EQ(log_.events().front().fields.at("outcome"), "unknown");
}

TEST_F(EventLogTest, DistinguishesACommandFromALaterOne) {
  play_until(1.0);
  hear(0x201, 3, {3, kSquat, 0});
  log_.on_bus_frame({.identifier = 0x181, .size = 8}, now_us_ + 8'000, said_);
  now_us_ += 10'000;
  hear(0x201, 3, {1, 0, 0});
  said_.refusal = Reason::kNotInThisState;
  play_until(1.1);
  EXPECT_THAT(texts(), Contains("Command play squat: obeyed."));
}

TEST_F(EventLogTest, RecordsACommandBySdo) {
  hear(0x601, 8, {0x2B, 0x00, 0x20, 2, kFallFront, 0, 0, 0});
  hear(0x601, 8, {0x2F, 0x00, 0x20, 1, 3, 0, 0, 0});
  play_until(0.1);
  EXPECT_THAT(texts(), Contains("Command play fall_front: obeyed."));
}

// The data of the block begin with sequence number 0x2F, like an expedited download of one byte.
TEST_F(EventLogTest, TakesNoDataOfABlockTransferForACommand) {
  hear(0x601, 8, {0xC6, 0x00, 0x21, 1, 0x4D, 1, 0, 0});
  hear(0x581, 8, {0xA4, 0x00, 0x21, 1, 127, 0, 0, 0});
  for (std::uint8_t sequence = 1; sequence < 0x30; ++sequence)
    hear(0x601, 8, {sequence, 0x00, 0x20, 1, 3, 0, 0, 0});
  play_until(0.1);
  EXPECT_EQ(texts().size(), 1u);  // the end
  hear(0x601, 8, {0x80, 0x00, 0x21, 1, 0, 0, 0, 8});
  hear(0x601, 8, {0x2F, 0x00, 0x20, 1, 3, 0, 0, 0});
  play_until(0.2);
  EXPECT_THAT(texts(), Contains("Command play squat: obeyed."));
}

TEST_F(EventLogTest, HearsCommandsAgainAfterAResetWithinABlock) {
  hear(0x601, 8, {0xC6, 0x00, 0x21, 1, 0x4D, 1, 0, 0});
  hear(0x581, 8, {0xA4, 0x00, 0x21, 1, 127, 0, 0, 0});
  hear(0x701, 1, {0});
  hear(0x601, 8, {0x2F, 0x00, 0x20, 1, 3, 0, 0, 0});
  play_until(0.1);
  EXPECT_THAT(texts(), Contains("Command play squat: obeyed."));
}

TEST_F(EventLogTest, ReadsNoRemoteFrame) {
  for (const std::uint16_t identifier : std::vector<std::uint16_t>{0x201, 0x301, 0x601, 0x181, 0x090})
    log_.on_bus_frame({.identifier = identifier, .size = 8, .remote = true, .data = {0x2F, 0x00, 0x20, 1, 3}},
                      now_us_, said_);
  log_.on_bus_frame({.identifier = 0x201, .size = 3, .remote = true, .data = {3}}, now_us_, said_);
  play_until(0.1);
  EXPECT_EQ(texts().size(), 1u);  // the end
}

TEST_F(EventLogTest, ReportsTheVelocityOfAWalk) {
  hear(0x301, 6, {150, 0, 0xCE, 0xFF, 0x90, 0x01});
  hear(0x201, 3, {7, 0, 0});
  play_until(0.1);
  EXPECT_EQ(event_of("command").text,
            "Command walk, 0.15 m/s forward, 0.05 m/s right, 0.40 rad/s to the left: obeyed.");
  hear(0x301, 6, {150, 0, 0xCE, 0xFF, 0x90, 0x01});
  play_until(0.2);
  EXPECT_EQ(texts().size(), 2u) << "a velocity that is repeated is no event";
  hear(0x301, 6, {0xD0, 0x07});
  said_.refusal = Reason::kVelocityOutOfRange;
  play_until(0.3);
  EXPECT_EQ(event_of("velocity").text, "Velocity 2.00 m/s forward: refused, velocity out of range.");
}

TEST_F(EventLogTest, ReportsARefusedVelocityHiddenByTheNextCommand) {
  hear(0x301, 6, {0xD0, 0x07});
  hear(0x201, 3, {7, 0, 0});
  play_until(0.1);
  EXPECT_EQ(event_of("command").text,
            "Command walk, 2.00 m/s forward: obeyed, but its velocity is refused, velocity out of range.");
}

TEST_F(EventLogTest, ReportsAnUnansweredCommand) {
  play_until(1.0);
  hear(0x201, 3, {5, 0, 0});
  EXPECT_THAT(texts(true), ElementsAre("Command emergency stop: no answer until the end.",
                                       "End: is upright, its controller is dead; did not fall; 0 faults."));
}

TEST_F(EventLogTest, ReportsAnInterruptedMotionWithoutAFall) {
  play_until(0.1);
  change(State::kMotion, Reason::kCommand);
  play_until(1.31);
  change(State::kFalling, Reason::kFallPredicted, kFallFront);
  play_until(2.0);
  change(State::kSoftStart, Reason::kCaughtItself, kFallFront);
  change(State::kStanding, Reason::kProgress, kFallFront);
  EXPECT_THAT(texts(), ElementsAre("Plays the motion squat.",
                                   "The motion squat is cut off after 1.21 s: fall predicted.",
                                   "A fall is detected: takes the pose of fall_front.",
                                   "Goes to the standing pose: caught itself.", "Stands.",
                                   "End: stands; did not fall; squat was cut off at 1.31 s; 0 faults."));
  EXPECT_EQ(event_of("cut_off").fields["motion"], "squat");
}

TEST_F(EventLogTest, ReportsAMotionThatFails) {
  play_until(0.1);
  change(State::kMotion, Reason::kCommand);
  play_until(1.31);
  change(State::kStanding, Reason::kMotionFailed);
  EXPECT_THAT(texts(), ElementsAre("Plays the motion squat.", "Stands: the motion squat has failed.",
                                   "End: stands; did not fall; squat failed at 1.31 s; 0 faults."));
  EXPECT_EQ(event_of("motion_failed").fields["reason"], "motion failed");
}

TEST_F(EventLogTest, ReportsThatTheRobotFellAndGotUp) {
  play_until(3.0);
  fall_and_get_up();
  EXPECT_EQ(log_.verdict(), "stands; fell once at 3.0 s and got up in 1.5 s; 0 faults");
  EXPECT_TRUE(log_.stands());
  EXPECT_EQ(event_of("fall").text, "The robot falls: its trunk leans more than 60 degrees, to the front.");
  EXPECT_EQ(event_of("recovery_begun").text, "Begins to get up, attempt 1.");
  EXPECT_EQ(event_of("recovery_ended").text,
            "Stands: has got up at attempt 1, 1.55 s after the fall was detected.");
  play_until(10.0);
  fall_and_get_up();
  EXPECT_EQ(log_.verdict(),
            "stands; fell 2 times, first at 3.0 s and got up each time, in 1.5 s at most; 0 faults");
  EXPECT_EQ(log_.falls(), 2u);
}

TEST_F(EventLogTest, CountsFromTheFirstOfConsecutiveFalls) {
  play_until(3.0);
  change(State::kFalling, Reason::kFallPredicted, kFallFront);
  lean(85.0);
  play_until(4.0);
  change(State::kFallen);
  change(State::kRising, Reason::kProne);
  lean(5.0);
  change(State::kSteadying);
  play_until(5.0);
  fall_and_get_up();
  EXPECT_EQ(log_.falls(), 2u);
  EXPECT_THAT(log_.verdict(),
              testing::StartsWith("stands; fell 2 times, first at 3.0 s and finally got up, in "));
}

TEST_F(EventLogTest, NeverReportsALyingRobotAsStanding) {
  play_until(1.0);
  lean(-80.0);
  play_until(2.0);
  EXPECT_EQ(said_.state, State::kStanding);
  EXPECT_FALSE(log_.stands());
  EXPECT_EQ(log_.posture(), "lies, its controller has not noticed");
  EXPECT_EQ(log_.verdict(),
            "lies, its controller has not noticed; fell once at 1.0 s and did not get up; 0 faults");
  lean(45.0);
  play_until(2.1);
  EXPECT_EQ(log_.posture(), "leans by 45 degrees, its controller has not noticed");
  change(State::kMotion);
  EXPECT_EQ(log_.posture(), "leans by 45 degrees, plays squat") << "as a bow would";
}

TEST_F(EventLogTest, DoesNotCountLyingAtTheStartAsAFall) {
  lean(90.0);
  said_.state = State::kLimp;
  play_until(1.0);
  EXPECT_EQ(log_.verdict(), "lies, limp; did not fall; 0 faults");
}

// A remote frame with the velocity's identifier commands nothing.
TEST_F(EventLogTest, PassesOverRemoteFrames) {
  play_until(1.0);
  const std::vector<std::string> before = texts();
  for (const std::uint16_t identifier : std::initializer_list<std::uint16_t>{0x090, 0x201, 0x301}) {
    log_.on_bus_frame({.identifier = identifier, .size = 8, .remote = true, .data = {0x10, 0x23}}, now_us_,
                      said_);
  }
  play_until(2.0);
  EXPECT_EQ(texts(), before);
}

TEST_F(EventLogTest, MergesTheSameEmergencyOfManyNodes) {
  hear(0x090, 8, {0x30, 0x81});
  hear(0x091, 8, {0x30, 0x81});
  hear(0x091, 8, {0x30, 0x81});
  hear(0x090, 8, {});  // error reset
  play_until(1.0);
  hear(0x091, 8, {0x20, 0x32});
  EXPECT_THAT(texts(),
              ElementsAre("Emergency message 0x8130, heartbeat lost, from 2 nodes.",
                          "Emergency message 0x3220, under-voltage, from right_knee.", HasSubstr("End")));
  EXPECT_THAT(event_of("emergency").fields["nodes"], ElementsAre("left_knee", "right_knee"));
}

TEST_F(EventLogTest, NamesTheFaultyDrive) {
  said_.drive_fault = drive::DriveFault::kLost;
  said_.faulty_joint = 1;
  play_until(0.5);
  change(State::kFault, Reason::kDriveFault);
  EXPECT_EQ(event_of("fault").text, "Fault: right_knee lost.");
  EXPECT_EQ(log_.posture(), "is upright, fault: right_knee lost");
}

TEST_F(EventLogTest, ReportsALowSupply) {
  play_until(0.1);
  change(State::kLowBattery, Reason::kSupplyLow);
  EXPECT_THAT(event_of("low_supply").text, HasSubstr("The supply is low"));
  EXPECT_EQ(log_.posture(), "stands, its supply low");
  EXPECT_THAT(event_of("low_supply").text, HasSubstr("no motion sit"));
}

TEST_F(EventLogTest, ReportsThatTheRobotSitsDownForItsSupply) {
  play_until(0.1);
  change(State::kWalking, Reason::kCommand);
  change(State::kSittingDown, Reason::kSupplyLow);
  EXPECT_EQ(event_of("low_supply").text, "The supply is low: slows down, stops and sits down.");
  EXPECT_EQ(log_.posture(), "sits down, its supply low");
  change(State::kLimp, Reason::kSupplyLow);
  EXPECT_EQ(event_of("sits").text, "Sits, and is limp: supply low.");
  truth_.tilt_rad = 0.7;  // it leans on its hands
  play_until(1.0);
  EXPECT_EQ(log_.posture(), "sits, its supply low");
  EXPECT_THAT(log_.verdict(), testing::Not(HasSubstr("cut off")));
  truth_.tilt_rad = 1.2;
  play_until(1.1);
  EXPECT_THAT(log_.posture(), HasSubstr("lies"));
}

TEST_F(EventLogTest, ReportsAStreamOfTargets) {
  play_until(0.1);
  const auto last_text = [&] {
    const auto events = log_.events();
    return events[events.size() - 2].text;  // before the sentence about the end
  };
  change(State::kStreaming, Reason::kCommand);
  EXPECT_EQ(last_text(), "Follows a stream of joint targets.");
  change(State::kStanding, Reason::kProgress);
  EXPECT_EQ(last_text(), "Stands: the stream of targets has ended.");
  change(State::kStreaming, Reason::kCommand);
  change(State::kSittingDown, Reason::kSupplyLow);
  EXPECT_EQ(event_of("low_supply").text, "The supply is low: returns to the standing pose and sits down.");
}

TEST_F(EventLogTest, ReportsAPoseThatIsNoSeat) {
  play_until(0.1);
  change(State::kSittingDown, Reason::kSupplyLow);
  change(State::kLowBattery, Reason::kSupplyLow);
  EXPECT_THAT(event_of("low_supply").text, HasSubstr("sits down"));
  EXPECT_THAT(log_.events().back().text, HasSubstr("its supply low"));
}

TEST_F(EventLogTest, ReportsPushesFaultsAndTheStand) {
  scenario_.initial.fixed_base = true;
  scenario_.initial.release_us = 500'000;
  Fault fault;
  fault.at_us = 1'000'000;
  fault.duration_us = 30'000;
  fault.kind = Fault::Kind::kDriveSilent;
  fault.target.text = "left_knee";
  scenario_.faults = {fault};
  EventLog log(scenario_, model_, kLimits);
  Push push;
  push.at_us = 700'000;
  push.duration_us = 100'000;
  push.link.text = "trunk";
  push.force_W_N = {0.0, -12.0, 0.0};
  truth_.rpy_rad.z() = std::numbers::pi / 2.0;  // the robot faces left, so the push comes from the front
  for (std::uint64_t now_us = 0; now_us <= 2'000'000; now_us += 10'000)
    log.observe_tick(now_us, said_, truth_, {&push, 1});
  const std::vector<RunEvent> events = log.events();
  EXPECT_EQ(events_text(events),
            "    0.500 s  The stand releases the robot.\n"
            "    0.700 s  The trunk is pushed backward with 1.20 N s in 0.10 s.\n"
            "    1.000 s  The scenario's fault drive_silent of left_knee begins.\n"
            "    1.030 s  The scenario's fault drive_silent of left_knee ends.\n"
            "    2.000 s  End: stands; did not fall; 0 faults.\n");
  EXPECT_NEAR(events[1].fields["impulse_N_s"][1].get<double>(), -1.2, 1e-12);
}

TEST_F(EventLogTest, ReportsThatTheRobotHangs) {
  scenario_.initial.fixed_base = true;
  said_.state = State::kLimp;
  play_until(0.1);
  EXPECT_EQ(log_.posture(), "hangs on its stand, limp");
}

TEST_F(EventLogTest, CountsExcessEventsOfACause) {
  for (std::size_t i = 0; i < EventStore::kMaxOfCause + 9; ++i)
    log_.add(i, "note", "Again, number " + std::to_string(i) + ".");
  const std::vector<RunEvent> events = log_.events();
  EXPECT_EQ(events.size(), EventStore::kMaxOfCause + 3);
  EXPECT_EQ(events[events.size() - 3].text, "8 more events like the next, not listed.");
  EXPECT_EQ(events[events.size() - 2].text, "Again, number 108.");
}

// A babbling node that the robot does not have, with many codes: the fault of a real one comes after it.
TEST_F(EventLogTest, ShowsAFaultAfterAFloodOfEmergencyMessages) {
  play_until(0.1);
  for (std::uint16_t i = 0; i < 5'000; ++i) {
    hal::CanFrame frame{.identifier = static_cast<std::uint16_t>(0x0C0 + i % 0x20), .size = 8};
    canopen::store_u16(frame.data.data(), static_cast<std::uint16_t>(0x1000 + i));
    log_.on_bus_frame(frame, 1'000 * i, said_);
  }
  log_.on_bus_frame({.identifier = 0x090, .size = 8, .data = {0x10, 0x23}}, 6'000'000, said_);
  now_us_ = 6'000'000;
  change(State::kFault, Reason::kDriveFault);
  const std::string text = events_text(log_.events());
  EXPECT_THAT(text, HasSubstr("Emergency message 0x2310, over-current, from left_knee."));
  EXPECT_THAT(text, HasSubstr("from node 64, which the robot does not have."));
  EXPECT_THAT(text, HasSubstr("more events like the next, not listed."));
  EXPECT_THAT(text, HasSubstr("0x2387, from node 71, which the robot does not have."));  // the last
  EXPECT_THAT(event_of("fault").text, HasSubstr("Fault"));
  EXPECT_LT(log_.events().size(), 200u);
}

TEST_F(EventLogTest, ShowsEachCauseOfManyKindsOfEvents) {
  for (std::size_t i = 0; i < 50'000; ++i)
    log_.add(i, "note", "Cause " + std::string(1 + i % 3'000, 'x') + ".");
  log_.add(60'000, "fault", "A real fault.");
  const std::vector<RunEvent> events = log_.events();
  EXPECT_LT(events.size(), EventStore::kMaxEvents + 4 * EventStore::kMaxCauses);
  EXPECT_EQ(events[events.size() - 2].text, "A real fault.");
}

}  // namespace
}  // namespace koboshi::simulation

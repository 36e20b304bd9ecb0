#include "bus/can/sdo_transfer.h"

#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "firmware/app/dictionary.h"
#include "firmware/canopen/sdo/protocol.h"
#include "sim_board/drive/pc_sdo.h"
#include "tests/unit/bus/can/far_end.h"
#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::bus {
namespace {

using canopen::AbortCode;

// Our server, at the other end of a cable that may lose frames.
class Cable final : public FarEnd {
 public:
  bool send(const hal::CanFrame& frame, std::uint64_t) override {
    if (++sent_ == lost_request) return true;
    if (disturbance && disturb_after-- == 0) {
      for (const hal::CanFrame& answer : device.ask(*disturbance)) answers_.push_back(answer);
      disturbance.reset();
    }
    answers_.insert(answers_.end(), for_others.begin(), for_others.end());
    for (const hal::CanFrame& answer : device.ask(frame)) answers_.push_back(answer);
    // It sends as much of a block as its queue takes; the rest with the next call.
    for (;;) {
      device.node.process(0);
      const auto more = device.sink.take();
      if (more.empty()) return true;
      answers_.insert(answers_.end(), more.begin(), more.end());
    }
  }

  canopen::TestNode device{5};
  int lost_request = -1;
  std::optional<hal::CanFrame> disturbance;  // another client's request, once
  int disturb_after = 0;                     // requests of this client from now on
  std::vector<hal::CanFrame> for_others;     // that the node sends before each answer

 private:
  int sent_ = 0;
};

class SdoTransferTest : public testing::Test {
 protected:
  SdoTransferTest() {
    cable.device.node.start(0);
    cable.device.sink.take();
  }
  static std::vector<std::uint8_t> pattern(std::size_t size) {
    std::vector<std::uint8_t> bytes(size);
    std::iota(bytes.begin(), bytes.end(), std::uint8_t{1});
    return bytes;
  }
  AbortCode code_of(const std::function<void()>& action) {
    try {
      action();
    } catch (const SdoAborted& aborted) {
      return aborted.code();
    }
    return AbortCode::kNone;
  }

  Cable cable;
  SdoTransfer transfer{cable, 5};
};

TEST_F(SdoTransferTest, ReadsNumbersAndTexts) {
  EXPECT_EQ(transfer.read({0x1018, 2}), (std::vector<std::uint8_t>{0x55, 0, 0, 0}));
  const std::vector<std::uint8_t> name = transfer.read({0x1008, 0});
  EXPECT_EQ(std::string(name.begin(), name.end()), "Koboshi test node");
}

// Another client uses the same channel: it reads 0x6079, writes 0x6040, and is refused 0x1234.
TEST_F(SdoTransferTest, SkipsAnswersAboutOtherObjects) {
  const auto answer = [](std::array<std::uint8_t, 8> data) {
    return hal::CanFrame{.identifier = 0x585, .size = 8, .data = data};
  };
  cable.for_others = {answer({0x43, 0x79, 0x60, 0, 0xEB, 0x1D, 0, 0}),
                      answer({0x60, 0x40, 0x60, 0, 0, 0, 0, 0}), answer({0x80, 0x34, 0x12, 0, 0, 0, 2, 6})};
  EXPECT_EQ(transfer.read({0x1018, 2}), (std::vector<std::uint8_t>{0x55, 0, 0, 0}));
  EXPECT_EQ(code_of([&] { transfer.read({0x1018, 9}); }), AbortCode::kSubindexDoesNotExist);
}

// It writes the object that this one reads, and transfers another by segments.
TEST_F(SdoTransferTest, SkipsAnswersOfAnotherKind) {
  const auto answer = [](std::array<std::uint8_t, 8> data) {
    return hal::CanFrame{.identifier = 0x585, .size = 8, .data = data};
  };
  cable.for_others = {answer({0x60, 0x18, 0x10, 2}), answer({0x01, 1, 2, 3, 4, 5, 6, 7}), answer({0x20}),
                      answer({0xA2, 1, 127})};
  EXPECT_EQ(transfer.read({0x1018, 2}), (std::vector<std::uint8_t>{0x55, 0, 0, 0}));
  cable.for_others = {answer({0x43, 0x00, 0x20, 2}), answer({0x30})};
  transfer.write({0x2000, 2}, std::vector<std::uint8_t>{1, 2, 3, 4});
  EXPECT_EQ(cable.device.values.gains[1], 0x04030201u);
}

// Another client's request ends the transfer; the server refuses the next segment.
TEST_F(SdoTransferTest, RepeatsATransferThatAnotherClientHasEnded) {
  const hal::CanFrame theirs{.identifier = 0x605, .size = 8, .data = {0x40, 0x41, 0x60, 0}};
  for (const bool by_blocks : {false, true}) {
    cable.disturb_after = 3;
    cable.disturbance = theirs;
    const std::vector<std::uint8_t> data = pattern(300);
    if (by_blocks) {
      transfer.download({0x2100, 1}, data);
    } else {
      transfer.write({0x2100, 1}, data);
    }
    EXPECT_EQ(cable.device.bytes.bytes, data) << by_blocks;
    EXPECT_FALSE(cable.disturbance) << by_blocks;
    cable.disturb_after = by_blocks ? 1 : 3;
    cable.disturbance = theirs;
    EXPECT_EQ(by_blocks ? transfer.upload({0x2100, 1}) : transfer.read({0x2100, 1}), data) << by_blocks;
  }
}

TEST_F(SdoTransferTest, ReadsAgainAfterALostAnswerAndWritesOnce) {
  cable.lost_request = 1;
  EXPECT_EQ(transfer.read({0x1018, 2}), (std::vector<std::uint8_t>{0x55, 0, 0, 0}));
  cable.lost_request = 3;
  EXPECT_THROW(transfer.write({0x2000, 2}, std::vector<std::uint8_t>{1, 2, 3, 4}), NoSdoAnswer);
}

TEST_F(SdoTransferTest, WritesNumbers) {
  transfer.write({0x2000, 2}, std::vector<std::uint8_t>{1, 2, 3, 4});
  EXPECT_EQ(cable.device.values.gains[1], 0x04030201u);
}

TEST_F(SdoTransferTest, ReportsTheAbortReason) {
  EXPECT_EQ(code_of([&] { transfer.read({0x5000, 0}); }), AbortCode::kObjectDoesNotExist);
  EXPECT_EQ(code_of([&] { transfer.write({0x6041, 0}, pattern(2)); }), AbortCode::kWriteOfReadOnly);
  EXPECT_EQ(code_of([&] { transfer.upload({0x2001, 0}); }), AbortCode::kReadOfWriteOnly);
}

TEST_F(SdoTransferTest, TransfersBytesBySegmentsAndBlocks) {
  auto& domain = cable.device.bytes;
  for (const std::size_t size : {1u, 6u, 7u, 8u, 100u, 889u, 890u, 5'000u}) {
    transfer.download({0x2100, 1}, pattern(size));
    EXPECT_EQ(domain.bytes, pattern(size));
    EXPECT_EQ(transfer.upload({0x2100, 1}), pattern(size));
    EXPECT_EQ(transfer.read({0x2100, 1}), pattern(size));
    transfer.write({0x2100, 1}, pattern(size));
    EXPECT_EQ(domain.bytes, pattern(size));
    EXPECT_EQ(domain.open, 0);
  }
}

TEST_F(SdoTransferTest, RepeatsLostSegments) {
  auto& domain = cable.device.bytes;
  cable.lost_request = 20;  // a segment of the download's first block
  transfer.download({0x2100, 1}, pattern(3'000));
  EXPECT_EQ(domain.bytes, pattern(3'000));
}

// A server of one object that supports block transfers in one block, without or with checksums (CiA 301,
// 7.2.4.3.9 to 7.2.4.3.15).
class BlockServer final : public FarEnd {
 public:
  explicit BlockServer(bool with_crc) : with_crc_(with_crc) {}

  bool send(const hal::CanFrame& frame, std::uint64_t) override {
    const auto& data = frame.data;
    const std::uint8_t crc_bit = with_crc_ ? 4 : 0;
    if (in_download_) {
      bytes.insert(bytes.end(), data.begin() + 1, data.end());
      in_download_ = (data[0] & 0x80) == 0;
      if (!in_download_) answer({0xA2, static_cast<std::uint8_t>(data[0] & 0x7F), 127});
    } else if ((data[0] & 0xE1) == 0xC0) {
      bytes.clear();
      in_download_ = true;
      answer({static_cast<std::uint8_t>(0xA0 | crc_bit), data[1], data[2], data[3], 127});
    } else if ((data[0] & 0xE1) == 0xC1) {
      bytes.resize(bytes.size() - (data[0] >> 2 & 7));
      downloaded_crc = canopen::load_u16(&data[1]);
      answer({0xA1});
    } else if ((data[0] & 0xE3) == 0xA0) {
      answer({static_cast<std::uint8_t>(0xC0 | crc_bit), data[1], data[2], data[3]});
    } else if (data[0] == 0xA3) {
      for (std::size_t i = 0; i < bytes.size(); i += 7) {
        std::array<std::uint8_t, 8> segment{
            static_cast<std::uint8_t>((i / 7 + 1) | (i + 7 >= bytes.size() ? 0x80 : 0))};
        std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                    std::min<std::size_t>(7, bytes.size() - i), segment.begin() + 1);
        answer(segment);
      }
    } else if (data[0] == 0xA2) {
      answer({static_cast<std::uint8_t>(0xC1 | (7 - bytes.size() % 7) % 7 << 2), wrong_crc});
    } else if (data[0] == 0x80) {
      ++aborts;
    }
    return true;
  }

  std::vector<std::uint8_t> bytes;
  std::uint16_t downloaded_crc = 0xFFFF;
  std::uint8_t wrong_crc = 0;
  int aborts = 0;

 private:
  void answer(std::array<std::uint8_t, 8> data) {
    answers_.push_back({.identifier = 0x585, .size = 8, .data = data});
  }
  bool with_crc_;
  bool in_download_ = false;
};

TEST_F(SdoTransferTest, TransfersBlocksWithoutAChecksumThatTheServerLacks) {
  BlockServer server(false);
  SdoTransfer blocks(server, 5);
  blocks.download({0x2100, 1}, pattern(40));
  EXPECT_EQ(server.bytes, pattern(40));
  EXPECT_EQ(server.downloaded_crc, 0);
  server.wrong_crc = 0x55;
  EXPECT_EQ(blocks.upload({0x2100, 1}), pattern(40));
  EXPECT_EQ(server.aborts, 0);
}

TEST_F(SdoTransferTest, RefusesBlocksWithAWrongChecksum) {
  BlockServer server(true);
  SdoTransfer blocks(server, 5);
  blocks.download({0x2100, 1}, pattern(40));
  EXPECT_EQ(server.downloaded_crc, canopen::crc16(0, pattern(40)));
  EXPECT_EQ(code_of([&] { blocks.upload({0x2100, 1}); }), AbortCode::kCrcError);
  EXPECT_EQ(server.aborts, SdoTransfer::kAttempts);
}

TEST_F(SdoTransferTest, ReportsItsProgress) {
  std::vector<std::size_t> done;
  const SdoProgress progress = [&](std::size_t bytes, std::size_t total) {
    EXPECT_EQ(total, 3'000u);
    done.push_back(bytes);
  };
  transfer.download({0x2100, 1}, pattern(3'000), progress);
  ASSERT_GE(done.size(), 3u);
  EXPECT_EQ(done.back(), 3'000u);
  EXPECT_TRUE(std::ranges::is_sorted(done));
}

TEST_F(SdoTransferTest, TimesOutOnSilence) {
  SdoTransfer nobody(cable, 6);
  EXPECT_THROW(nobody.read({0x1000, 0}), std::runtime_error);
}

// Keeps the identifier of what is sent.
class Ear final : public sim_board::Transport {
 public:
  bool send(const hal::CanFrame& frame, std::uint64_t) override {
    identifiers.push_back(frame.identifier);
    return true;
  }
  std::optional<hal::CanFrame> receive() override {
    return hal::CanFrame{.identifier = 0x6A4, .size = 8, .data = {0x60, 0x60, 0x60}};
  }
  std::string place() const override { return "an ear"; }

  std::vector<std::uint16_t> identifiers;
};

// A node that answers on one channel.
class OneChannel final : public sim_board::Transport {
 public:
  explicit OneChannel(std::uint16_t request, std::uint16_t response)
      : request_(request), response_(response) {}
  bool send(const hal::CanFrame& frame, std::uint64_t) override {
    last = frame.identifier;
    if (frame.identifier == request_) {
      answer_ = frame;
      answer_->identifier = response_;
      answer_->data[0] = 0x43;
    }
    return true;
  }
  std::optional<hal::CanFrame> receive() override { return std::exchange(answer_, std::nullopt); }
  std::string place() const override { return "a node"; }

  std::uint16_t last = 0;

 private:
  std::uint16_t request_;
  std::uint16_t response_;
  std::optional<hal::CanFrame> answer_;
};

TEST(OpenSdo, TakesTheSecondChannelOfADriveThatHasIt) {
  OneChannel second(0x690, 0x6A4);
  EXPECT_NO_THROW(open_sdo(second, 16, SdoChannel::kAutomatic).read({0x1018, 1}));
  EXPECT_EQ(second.last, 0x690);
  OneChannel first(0x610, 0x590);
  EXPECT_NO_THROW(open_sdo(first, 16, SdoChannel::kAutomatic).read({0x1018, 1}));
  EXPECT_EQ(first.last, 0x610);
  OneChannel controller(0x601, 0x581);
  EXPECT_NO_THROW(open_sdo(controller, 1, SdoChannel::kAutomatic).read({0x1018, 1}));
  EXPECT_NO_THROW(open_sdo(first, 16, SdoChannel::kFirst).read({0x1018, 1}));
  EXPECT_THROW(open_sdo(controller, 1, SdoChannel::kSecond), std::invalid_argument);
}

// Elsewhere its identifiers are another node's: 0x6A4 answers for drive 16, and would be the request of 36.
TEST(SecondSdo, ExistsInDrivesOnly) {
  Ear ear;
  second_sdo(ear, 16).write({0x6060, 0}, std::vector<std::uint8_t>{8});
  EXPECT_EQ(ear.identifiers, std::vector<std::uint16_t>{0x690});
  for (const std::uint8_t node : std::vector<std::uint8_t>{35, 39, 58})
    EXPECT_NO_THROW(second_sdo(ear, node));
  for (const std::uint8_t node : std::vector<std::uint8_t>{1, 15, 36, 38, 59, 127}) {
    EXPECT_THROW(second_sdo(ear, node), std::invalid_argument) << int{node};
  }
  EXPECT_EQ(ear.identifiers.size(), 1u);
}

TEST(SecondSdo, SaysWhatToDoWithADriveThatHasNone) {
  Ear ear;
  try {
    second_sdo(ear, 59);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "found node 59, which has no second SDO channel, expected a drive, 16 to 35 or 39 to 58; or "
                 "use the first channel, --first, while no controller uses it");
  }
}

// Requests and answers of all second channels, and the joint target stream of the controller.
TEST(SecondSdo, MeetsNoOtherIdentifier) {
  std::set<std::uint32_t> taken;
  for (std::uint32_t id = app::kStreamTargetBase; id <= app::kStreamSequenceIdentifier; ++id)
    taken.insert(id);
  for (int node = 1; node <= canopen::kMaxNodeId; ++node) {
    if (!sim_board::has_pc_sdo(node)) continue;
    for (const std::uint16_t id : {sim_board::pc_sdo_request(node), sim_board::pc_sdo_response(node)}) {
      EXPECT_TRUE(taken.insert(id).second) << "node " << node;
      EXPECT_FALSE(canopen::is_restricted(id)) << "node " << node;
      EXPECT_GE(id, 0x680) << "node " << node;
    }
    EXPECT_EQ(sim_board::node_of_pc_sdo_request(sim_board::pc_sdo_request(node)), node);
    EXPECT_EQ(sim_board::node_of_pc_sdo_response(sim_board::pc_sdo_response(node)), node);
    EXPECT_EQ(sim_board::node_of_pc_sdo_request(sim_board::pc_sdo_response(node)), 0);
  }
}

}  // namespace
}  // namespace koboshi::bus

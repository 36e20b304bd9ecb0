#include <gtest/gtest.h>

#include <set>

#include "firmware/canopen/sdo/protocol.h"
#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

// Requests to node 0x10 that misuse the protocol. The server answers the last with the abort code, or not at
// all.
struct Misuse {
  const char* what;
  std::vector<hal::CanFrame> requests;
  std::uint32_t abort_code;
  void (*prepare)(TestNode& device) = nullptr;
  bool falls_silent = false;
};

hal::CanFrame request(std::initializer_list<unsigned> bytes) { return can_frame(0x610, bytes); }

// Makes TPDO 1 invalid and then clears its mapping.
const hal::CanFrame kInvalidTpdo = request({0x23, 0x00, 0x18, 1, 0x90, 1, 0, 0xC0});
const hal::CanFrame kUnmappedTpdo = request({0x2F, 0x00, 0x1A, 0, 0, 0, 0, 0});

const Misuse kMisuses[] = {
    {"toggle bit of an upload segment",
     {request({0x40, 0x08, 0x10, 0, 0, 0, 0, 0}), request({0x70, 0, 0, 0, 0, 0, 0, 0})},
     0x05030000},
    {"toggle bit of a download segment",
     {request({0x21, 0x40, 0x60, 0, 2, 0, 0, 0}), request({0x1B, 1, 2, 0, 0, 0, 0, 0})},
     0x05030000},
    {"reserved command specifier", {request({0xE0, 0x40, 0x60, 0, 0, 0, 0, 0})}, 0x05040001},
    {"upload segment without a transfer", {request({0x60, 0, 0, 0, 0, 0, 0, 0})}, 0x05040001},
    {"download segment without a transfer", {request({0x01, 1, 2, 3, 4, 5, 6, 7})}, 0x05040001},
    {"upload segment within a download",
     {request({0x21, 0x40, 0x60, 0, 2, 0, 0, 0}), request({0x60, 0, 0, 0, 0, 0, 0, 0})},
     0x05040001},
    {"mapping of a valid PDO", {request({0x23, 0x00, 0x16, 1, 0x10, 0, 0x40, 0x60})}, 0x06010000},
    {"reading a write-only object", {request({0x40, 0x01, 0x20, 0, 0, 0, 0, 0})}, 0x06010001},
    {"writing a read-only object", {request({0x2B, 0x41, 0x60, 0, 1, 0, 0, 0})}, 0x06010002},
    {"writing a constant", {request({0x23, 0x02, 0x65, 0, 1, 0, 0, 0})}, 0x06010002},
    {"writing the device type", {request({0x23, 0x00, 0x10, 0, 1, 0, 0, 0})}, 0x06010002},
    {"writing a name in segments", {request({0x21, 0x08, 0x10, 0, 20, 0, 0, 0})}, 0x06010002},
    {"writing the highest sub-index", {request({0x2F, 0x00, 0x20, 0, 1, 0, 0, 0})}, 0x06010002},
    {"reading what is not there", {request({0x40, 0x00, 0x30, 0, 0, 0, 0, 0})}, 0x06020000},
    {"writing what is not there", {request({0x2F, 0x00, 0x30, 0, 1, 0, 0, 0})}, 0x06020000},
    {"reading a PDO that is not there", {request({0x40, 0x04, 0x18, 1, 0, 0, 0, 0})}, 0x06020000},
    {"mapping an object into the wrong direction",
     {request({0x23, 0x00, 0x14, 1, 0x10, 2, 0, 0x80}), request({0x2F, 0x00, 0x16, 0, 0, 0, 0, 0}),
      request({0x23, 0x00, 0x16, 1, 0x10, 0, 0x41, 0x60})},
     0x06040041},
    {"mapping the error register",
     {kInvalidTpdo, kUnmappedTpdo, request({0x23, 0x00, 0x1A, 1, 8, 0, 0x01, 0x10})},
     0x06040041},
    {"mapping an entry of an empty history",
     {kInvalidTpdo, kUnmappedTpdo, request({0x23, 0x00, 0x1A, 1, 32, 1, 0x03, 0x10})},
     0x06040041},
    {"mapping a PDO's parameter",
     {kInvalidTpdo, kUnmappedTpdo, request({0x23, 0x00, 0x1A, 1, 8, 2, 0x00, 0x14})},
     0x06040041},
    {"mapping a constant",
     {kInvalidTpdo, kUnmappedTpdo, request({0x23, 0x00, 0x1A, 1, 32, 0, 0x02, 0x65})},
     0x06040041},
    {"mapping the highest sub-index",
     {kInvalidTpdo, kUnmappedTpdo, request({0x23, 0x00, 0x1A, 1, 8, 0, 0x00, 0x20})},
     0x06040041},
    {"mapping an object by another length",
     {kInvalidTpdo, kUnmappedTpdo, request({0x23, 0x00, 0x1A, 1, 8, 0, 0x41, 0x60})},
     0x06040041},
    {"mapping what is not there",
     {kInvalidTpdo, kUnmappedTpdo, request({0x23, 0x00, 0x1A, 1, 8, 0, 0x00, 0x30})},
     0x06020000},
    {"mapping a communication object that is not there",
     {kInvalidTpdo, kUnmappedTpdo, request({0x23, 0x00, 0x1A, 1, 16, 0, 0x0C, 0x10})},
     0x06020000},
    {"mapping a sub-index that is not there",
     {kInvalidTpdo, kUnmappedTpdo, request({0x23, 0x00, 0x1A, 1, 32, 4, 0x00, 0x20})},
     0x06090011},
    {"mapping a sub-index of the identity that is not there",
     {kInvalidTpdo, kUnmappedTpdo, request({0x23, 0x00, 0x1A, 1, 32, 5, 0x18, 0x10})},
     0x06090011},
    {"counting an entry that maps nothing",
     {kInvalidTpdo, kUnmappedTpdo, request({0x2F, 0x00, 0x1A, 0, 4, 0, 0, 0})},
     0x06020000},
    {"mapping while objects are mapped",
     {kInvalidTpdo, request({0x23, 0x00, 0x1A, 1, 16, 0, 0x41, 0x60})},
     0x06010000},
    {"unmapping a valid PDO", {kUnmappedTpdo}, 0x06010000},
    {"more bytes than a PDO has",
     {kInvalidTpdo, kUnmappedTpdo, request({0x23, 0x00, 0x1A, 1, 32, 0, 0x64, 0x60}),
      request({0x23, 0x00, 0x1A, 3, 32, 0, 0x64, 0x60}), request({0x2F, 0x00, 0x1A, 0, 3, 0, 0, 0})},
     0x06040042},
    {"an entry beyond a mapping",
     {kInvalidTpdo, kUnmappedTpdo, request({0x23, 0x00, 0x1A, 9, 16, 0, 0x41, 0x60})},
     0x06090011},
    {"the reserved sub-index of a PDO", {request({0x2F, 0x00, 0x18, 4, 0, 0, 0, 0})}, 0x06090011},
    {"an inhibit time of an RPDO", {request({0x2B, 0x00, 0x14, 3, 10, 0, 0, 0})}, 0x06090011},
    {"the length of a PDO's parameters", {request({0x2F, 0x00, 0x18, 0, 5, 0, 0, 0})}, 0x06010002},
    {"another identifier of a valid PDO", {request({0x23, 0x00, 0x18, 1, 0x91, 1, 0, 0x40})}, 0x06090030},
    {"an extended identifier of a PDO",
     {kInvalidTpdo, request({0x23, 0x00, 0x18, 1, 0x90, 1, 0, 0x60})},
     0x06090030},
    {"an inhibit time of a valid PDO", {request({0x2B, 0x00, 0x18, 3, 10, 0, 0, 0})}, 0x06090030},
    {"a SYNC to start from of a valid PDO", {request({0x2F, 0x00, 0x18, 6, 1, 0, 0, 0})}, 0x06090030},
    {"a SYNC to start from beyond the counter",
     {kInvalidTpdo, request({0x2F, 0x00, 0x18, 6, 241, 0, 0, 0})},
     0x06090030},
    {"a reserved transmission type of an RPDO", {request({0x2F, 0x00, 0x14, 2, 0xFC, 0, 0, 0})}, 0x06090030},
    {"an identifier of two RPDOs", {request({0x23, 0x02, 0x14, 1, 0x10, 2, 0, 0})}, 0x06040043},
    {"mapping too much",
     {request({0x23, 0x00, 0x18, 1, 0x90, 1, 0, 0xC0}), request({0x2F, 0x00, 0x1A, 0, 9, 0, 0, 0})},
     0x06040042},
    {"two heartbeat consumers of one node",
     {request({0x23, 0x16, 0x10, 1, 100, 0, 1, 0}), request({0x23, 0x16, 0x10, 2, 100, 0, 1, 0})},
     0x06040043},
    {"another size than announced",
     {request({0x21, 0x7A, 0x60, 0, 4, 0, 0, 0}), request({0x0B, 1, 2, 0, 0, 0, 0, 0})},
     0x06070010},
    {"too many bytes", {request({0x23, 0x40, 0x60, 0, 1, 0, 0, 0})}, 0x06070012},
    {"too many bytes announced", {request({0x21, 0x40, 0x60, 0, 5, 0, 0, 0})}, 0x06070012},
    {"the largest size announced for a number",
     {request({0x21, 0x40, 0x60, 0, 0xFF, 0xFF, 0xFF, 0xFF})},
     0x06070012},
    {"the largest size announced for a parameter",
     {request({0x21, 0x17, 0x10, 0, 0xFF, 0xFF, 0xFF, 0xFF})},
     0x06070012},
    {"the largest size announced for a domain",
     {request({0x21, 0x00, 0x21, 1, 0xFF, 0xFF, 0xFF, 0xFF})},
     0x06070012},
    {"the largest size announced for a number in a block",
     {request({0xC2, 0x40, 0x60, 0, 0xFF, 0xFF, 0xFF, 0xFF})},
     0x06070012},
    {"the largest size announced for a domain in a block",
     {request({0xC2, 0x00, 0x21, 1, 0xFF, 0xFF, 0xFF, 0xFF})},
     0x06070012},
    {"too many bytes in segments",
     {request({0x20, 0x40, 0x60, 0, 0, 0, 0, 0}), request({0x00, 1, 2, 3, 4, 5, 6, 7})},
     0x06070012},
    {"too many bytes for a parameter", {request({0x23, 0x17, 0x10, 0, 1, 0, 0, 0})}, 0x06070012},
    {"too few bytes", {request({0x2F, 0x7A, 0x60, 0, 1, 0, 0, 0})}, 0x06070013},
    {"too few bytes for a parameter", {request({0x2F, 0x17, 0x10, 0, 1, 0, 0, 0})}, 0x06070013},
    {"no bytes at all",
     {request({0x20, 0x40, 0x60, 0, 0, 0, 0, 0}), request({0x0F, 0, 0, 0, 0, 0, 0, 0})},
     0x06070013},
    {"sub-index of a variable", {request({0x40, 0x40, 0x60, 1, 0, 0, 0, 0})}, 0x06090011},
    {"sub-index of a communication object", {request({0x40, 0x00, 0x10, 1, 0, 0, 0, 0})}, 0x06090011},
    {"sub-index beyond an array", {request({0x40, 0x00, 0x20, 4, 0, 0, 0, 0})}, 0x06090011},
    {"sub-index of the identity", {request({0x40, 0x18, 0x10, 5, 0, 0, 0, 0})}, 0x06090011},
    {"a TPDO on remote request", {request({0x2F, 0x00, 0x18, 2, 0xFD, 0, 0, 0})}, 0x06090030},
    {"an identifier that is taken", {request({0x23, 0x02, 0x14, 1, 0x10, 7, 0, 0})}, 0x06090030},
    {"erasing the history with a number", {request({0x2F, 0x03, 0x10, 0, 1, 0, 0, 0})}, 0x06090030},
    {"another SYNC identifier, extended", {request({0x23, 0x05, 0x10, 0, 0x80, 0, 0, 0x20})}, 0x06090030},
    {"a value too high", {request({0x2F, 0x60, 0x60, 0, 11, 0, 0, 0})}, 0x06090031},
    {"a value too low", {request({0x2F, 0x60, 0x60, 0, 0xFE, 0, 0, 0})}, 0x06090032},
    {"an entry of an empty history", {request({0x40, 0x03, 0x10, 1, 0, 0, 0, 0})}, 0x08000024},
    {"a client that falls silent in an upload",
     {request({0x40, 0x08, 0x10, 0, 0, 0, 0, 0})},
     0x05040000,
     nullptr,
     true},
    {"a client that falls silent before the end of a block download",
     {request({0xC2, 0x00, 0x21, 1, 1, 0, 0, 0}), request({0x81, 1, 0, 0, 0, 0, 0, 0})},
     0x05040000,
     nullptr,
     true},
    {"a client that does not start a block upload",
     {request({0xA0, 0x08, 0x10, 0, 10, 0, 0, 0})},
     0x05040000,
     nullptr,
     true},
    {"a confirmation without a block upload", {request({0xA2, 1, 10, 0, 0, 0, 0, 0})}, 0x05040001},
    {"a start without a block upload", {request({0xA3, 0, 0, 0, 0, 0, 0, 0})}, 0x05040001},
    {"an end without a block download", {request({0xC1, 0, 0, 0, 0, 0, 0, 0})}, 0x05040001},
    {"a segment request in a block upload",
     {request({0xA0, 0x08, 0x10, 0, 10, 0, 0, 0}), request({0x60, 0, 0, 0, 0, 0, 0, 0})},
     0x05040001},
    {"a block of no segments", {request({0xA0, 0x08, 0x10, 0, 0, 0, 0, 0})}, 0x05040002},
    {"a block of too many segments", {request({0xA0, 0x08, 0x10, 0, 128, 0, 0, 0})}, 0x05040002},
    {"a next block of no segments",
     {request({0xA0, 0x08, 0x10, 0, 10, 0, 0, 0}), request({0xA3, 0, 0, 0, 0, 0, 0, 0}),
      request({0xA2, 0, 0, 0, 0, 0, 0, 0})},
     0x05040002},
    {"confirming segments that were not sent",
     {request({0xA0, 0x08, 0x10, 0, 10, 0, 0, 0}), request({0xA3, 0, 0, 0, 0, 0, 0, 0}),
      request({0xA2, 3, 10, 0, 0, 0, 0, 0})},
     0x05040003},
    {"a segment without a number",
     {request({0xC2, 0x00, 0x21, 1, 10, 0, 0, 0}), request({0x00, 1, 2, 3, 4, 5, 6, 7})},
     0x05040003},
    {"a block with a wrong CRC",
     {request({0xC6, 0x00, 0x21, 1, 7, 0, 0, 0}), request({0x81, 1, 2, 3, 4, 5, 6, 7}),
      request({0xC1, 0x12, 0x34, 0, 0, 0, 0, 0})},
     0x05040004},
    {"a domain without room",
     {request({0xC2, 0x00, 0x21, 1, 0, 0, 1, 0})},
     0x05040005,
     [](TestNode& device) { device.bytes.begin_verdict = AbortCode::kOutOfMemory; }},
    {"a domain that does not like what is in it",
     {request({0x21, 0x00, 0x21, 1, 2, 0, 0, 0}), request({0x0B, 1, 2, 0, 0, 0, 0, 0})},
     0x06040047,
     [](TestNode& device) { device.bytes.write_verdict = AbortCode::kInternalIncompatibility; }},
    {"a domain that fails to store",
     {request({0x21, 0x00, 0x21, 1, 2, 0, 0, 0}), request({0x0B, 1, 2, 0, 0, 0, 0, 0})},
     0x08000000,
     [](TestNode& device) { device.bytes.commit_verdict = AbortCode::kGeneralError; }},
    {"reading a write-only domain", {request({0xA0, 0x00, 0x21, 3, 10, 0, 0, 0})}, 0x06010001},
    {"writing a read-only domain", {request({0xC0, 0x00, 0x21, 2, 0, 0, 0, 0})}, 0x06010002},
    {"writing the length of an array", {request({0x2F, 0x10, 0x10, 0, 1, 0, 0, 0})}, 0x06010002},
    {"writing the default SDO channel", {request({0x23, 0x00, 0x12, 1, 0, 0, 0, 0x80})}, 0x06010002},
    {"writing the error register with a wrong size",
     {request({0x23, 0x01, 0x10, 0, 1, 0, 0, 0})},
     0x06010002},
    {"asking for node guarding", {request({0x2B, 0x0C, 0x10, 0, 1, 0, 0, 0})}, 0x06020000},
    {"beginning to write what is not there", {request({0x21, 0x00, 0x30, 0, 2, 0, 0, 0})}, 0x06020000},
    {"block upload of what is not there", {request({0xA0, 0x00, 0x30, 0, 10, 0, 0, 0})}, 0x06020000},
    {"mapping a domain",
     {request({0x23, 0x00, 0x14, 1, 0x10, 2, 0, 0x80}), request({0x2F, 0x00, 0x16, 0, 0, 0, 0, 0}),
      request({0x23, 0x00, 0x16, 1, 0, 1, 0x00, 0x21})},
     0x06040041},
    {"a block of more bytes than announced",
     {request({0xC2, 0x00, 0x21, 1, 3, 0, 0, 0}), request({0x81, 1, 2, 3, 4, 5, 6, 7}),
      request({0xC1, 0, 0, 0, 0, 0, 0, 0})},
     0x06070010},
    {"a block of fewer bytes than announced",
     {request({0xC2, 0x00, 0x21, 1, 9, 0, 0, 0}), request({0x81, 1, 2, 3, 4, 5, 6, 7}),
      request({0xC1, 0, 0, 0, 0, 0, 0, 0})},
     0x06070010},
    {"a block of too many bytes for a number",
     {request({0xC0, 0x40, 0x60, 0, 0, 0, 0, 0}), request({0x01, 1, 2, 3, 4, 5, 6, 7}),
      request({0x02, 1, 2, 3, 4, 5, 6, 7})},
     0x06070012},
    {"a sub-index of the SDO server", {request({0x40, 0x01, 0x12, 4, 0, 0, 0, 0})}, 0x06090011},
    {"a reserved transmission type", {request({0x2F, 0x00, 0x18, 2, 0xF1, 0, 0, 0})}, 0x06090030},
    {"a reserved error behaviour", {request({0x2F, 0x29, 0x10, 1, 3, 0, 0, 0})}, 0x06090030},
    {"a counter of one", {request({0x2F, 0x19, 0x10, 0, 1, 0, 0, 0})}, 0x06090030},
    {"an identifier of EMCY while it is in use", {request({0x23, 0x14, 0x10, 0, 0x91, 0, 0, 0})}, 0x06090030},
    {"a domain that is not there now", {request({0x40, 0x00, 0x21, 4, 0, 0, 0, 0})}, 0x060A0023},
    {"storing without the signature", {request({0x23, 0x10, 0x10, 1, 1, 0, 0, 0})}, 0x08000020},
    {"restoring with that of storing", {request({0x23, 0x11, 0x10, 1, 's', 'a', 'v', 'e'})}, 0x08000020},
    {"an owner who is in control himself",
     {request({0x2F, 0x60, 0x60, 0, 1, 0, 0, 0})},
     0x08000021,
     [](TestNode& device) { device.verdict = AbortCode::kLocalControl; }},
    {"a counter while SYNCs are produced",
     {request({0x23, 0x06, 0x10, 0, 0x10, 0x27, 0, 0}), request({0x2F, 0x19, 0x10, 0, 10, 0, 0, 0})},
     0x08000022},
    {"storing what is not stored", {request({0x23, 0x10, 0x10, 2, 's', 'a', 'v', 'e'})}, 0x08000020},
    {"storing when the owner cannot",
     {request({0x23, 0x10, 0x10, 1, 's', 'a', 'v', 'e'})},
     0x08000022,
     [](TestNode& device) { device.verdict = AbortCode::kDeviceState; }},
};

TEST(SdoAbort, NamesEachMisuse) {
  for (const Misuse& misuse : kMisuses) {
    SCOPED_TRACE(misuse.what);
    TestNode device;
    device.make_operational();
    if (misuse.prepare != nullptr) misuse.prepare(device);
    std::vector<hal::CanFrame> answers;
    for (const hal::CanFrame& frame : misuse.requests) {
      for (const hal::CanFrame& answer : answers) EXPECT_NE(answer.data[0], 0x80) << "refused too early";
      answers = device.ask(frame);
    }
    if (misuse.falls_silent) {
      device.node.process(SdoServer::kTimeout_us);
      answers = device.sink.take();
    }
    ASSERT_EQ(answers.size(), 1u);
    EXPECT_EQ(device.bytes.open, 0);
    const hal::CanFrame expected{
        .identifier = 0x590,
        .size = 8,
        .data = sdo::message(sdo::kAbort, sdo::address_of(answers[0].data), misuse.abort_code)};
    EXPECT_EQ(answers[0], expected);
    // In all cases the server is ready for the next transfer.
    EXPECT_EQ(device.ask(request({0x40, 0x02, 0x65, 0, 0, 0, 0, 0})),
              std::vector{can_frame(0x590, {0x43, 0x02, 0x65, 0, 0x80, 0, 0, 0})});
  }
}

TEST(SdoAbort, DefinesEveryCodeOfAServer) {
  std::set<std::uint32_t> missing{0x05030000, 0x05040000, 0x05040001, 0x05040002, 0x05040003, 0x05040004,
                                  0x05040005, 0x06010000, 0x06010001, 0x06010002, 0x06020000, 0x06040041,
                                  0x06040042, 0x06040043, 0x06040047, 0x06070010, 0x06070012, 0x06070013,
                                  0x06090011, 0x06090030, 0x06090031, 0x06090032, 0x060A0023, 0x08000000,
                                  0x08000020, 0x08000021, 0x08000022, 0x08000024};
  for (const Misuse& misuse : kMisuses) missing.erase(misuse.abort_code);
  EXPECT_EQ(missing, std::set<std::uint32_t>{});
}

TEST(SdoAbort, NamesTheObjectOfTheTransfer) {
  TestNode device;
  device.make_operational();
  device.ask(request({0x21, 0x40, 0x60, 0, 2, 0, 0, 0}));
  EXPECT_EQ(device.ask(request({0x1B, 1, 2, 0, 0, 0, 0, 0})),
            std::vector{can_frame(0x590, {0x80, 0x40, 0x60, 0, 0, 0, 3, 5})});
}

}  // namespace
}  // namespace koboshi::canopen

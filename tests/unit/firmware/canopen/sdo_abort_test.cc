#include <gtest/gtest.h>

#include "firmware/canopen/sdo_protocol.h"
#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

// A misuse: requests to node 0x10, of which the last is answered with the abort code.
struct Misuse {
  const char* what;
  std::vector<hal::CanFrame> requests;
  std::uint32_t abort_code;
};

hal::CanFrame request(std::initializer_list<unsigned> bytes) { return can_frame(0x610, bytes); }

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
    {"a TPDO that answers remote frames", {request({0x23, 0x02, 0x18, 1, 0x90, 3, 0, 0})}, 0x06090030},
    {"an identifier that is taken", {request({0x23, 0x02, 0x14, 1, 0x10, 7, 0, 0})}, 0x06090030},
    {"erasing the history with a number", {request({0x2F, 0x03, 0x10, 0, 1, 0, 0, 0})}, 0x06090030},
    {"another SYNC identifier, extended", {request({0x23, 0x05, 0x10, 0, 0x80, 0, 0, 0x20})}, 0x06090030},
    {"a value too high", {request({0x2F, 0x60, 0x60, 0, 11, 0, 0, 0})}, 0x06090031},
    {"a value too low", {request({0x2F, 0x60, 0x60, 0, 0xFE, 0, 0, 0})}, 0x06090032},
    {"an entry of an empty history", {request({0x40, 0x03, 0x10, 1, 0, 0, 0, 0})}, 0x08000024},
};

TEST(SdoAbort, NamesEachMisuse) {
  for (const Misuse& misuse : kMisuses) {
    SCOPED_TRACE(misuse.what);
    TestNode device;
    device.make_operational();
    std::vector<hal::CanFrame> answers;
    for (const hal::CanFrame& frame : misuse.requests) {
      if (!answers.empty()) {
        EXPECT_NE(answers[0].data[0], 0x80) << "refused too early";
      }
      answers = device.ask(frame);
      ASSERT_EQ(answers.size(), 1u);
    }
    const hal::CanFrame expected{
        .identifier = 0x590,
        .size = 8,
        .data = sdo::message(sdo::kAbort, sdo::address_of(answers[0].data), misuse.abort_code)};
    EXPECT_EQ(answers[0], expected);
    // Whatever it was, the server is ready for the next transfer.
    EXPECT_EQ(device.ask(request({0x40, 0x02, 0x65, 0, 0, 0, 0, 0})),
              std::vector{can_frame(0x590, {0x43, 0x02, 0x65, 0, 0x80, 0, 0, 0})});
  }
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

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/emergency.h"
#include "firmware/canopen/frame.h"
#include "firmware/canopen/heartbeat.h"
#include "firmware/canopen/pdo.h"
#include "firmware/canopen/sdo/objects.h"
#include "firmware/canopen/sdo/server.h"
#include "firmware/canopen/slot_map.h"
#include "firmware/canopen/sync.h"
#include "firmware/canopen/transmit_queue.h"

namespace koboshi::canopen {

// What "save" to 0x1010 and "load" to 0x1011 are about, by sub-index (CiA 301, 7.5.2.13).
enum class ParameterGroup : std::uint8_t {
  kAll = 1,
  kCommunication = 2,  // 0x1000 to 0x1FFF
  kApplication = 3,    // 0x6000 to 0x9FFF
  kManufacturer = 4,   // 0x2000 to 0x5FFF
};

// The bits of NodeDescription::stored_groups.
constexpr std::uint8_t group_bit(ParameterGroup group) {
  return static_cast<std::uint8_t>(1u << (static_cast<unsigned>(group) - 1));
}

inline constexpr std::uint8_t kAllGroups =
    group_bit(ParameterGroup::kAll) | group_bit(ParameterGroup::kCommunication) |
    group_bit(ParameterGroup::kApplication) | group_bit(ParameterGroup::kManufacturer);

// What a node tells its owner, from within the node's calls. An owner overrides what it cares for; it may
// call the node back.
class NodeApplication {
 public:
  // An SDO client (or write_object) is about to change a value of the owner's table; kNone lets it pass.
  // `value` is sign-extended if the object is signed. Length, access and limits have been checked already.
  virtual AbortCode on_write(ObjectAddress, std::uint32_t /*value*/) { return AbortCode::kNone; }
  // The bytes behind a DOMAIN row of the owner's table; null: not now, the client sees 060A 0023. They must
  // outlive the node. The node never has two transfers of one domain at a time.
  virtual Domain* domain(ObjectAddress) { return nullptr; }
  // Store the parameters of a group so that they survive a restart, or let those of the factory have effect
  // after the next reset. NodeDescription::stored_groups says which the owner can. While it says kBusy the
  // client waits, and the owner is asked again, until all is done (CiA 301, 7.5.2.13).
  virtual AbortCode on_store(ParameterGroup) { return AbortCode::kCannotTransfer; }
  virtual AbortCode on_restore(ParameterGroup) { return AbortCode::kCannotTransfer; }
  // kResetNode (also at start) or kResetCommunication: communication parameters have their defaults again;
  // now is the time to change them with write_object. On kResetNode the owner's own values go back to theirs.
  virtual void on_reset(NmtCommand /*reset*/) {}
  // Whether the node goes on to operational by itself after a reset, as an NMT master or a self-starting
  // device does (CiA 302-2, object 0x1F80). Asked at its end.
  virtual bool starts_itself() { return false; }
  virtual void on_state(NmtState) {}
  // A SYNC, in pre-operational and operational. Synchronous RPDOs have taken effect; synchronous TPDOs are
  // packed afterwards.
  virtual void on_sync(std::uint64_t /*now_us*/) {}
  // RPDO `number` (from 0) has taken effect.
  virtual void on_rpdo(std::size_t /*number*/) {}
  virtual void on_heartbeat(const HeartbeatEvent&) {}
  // Another node's emergency message.
  virtual void on_emergency(const Emergency&) {}
  // Another node has sent what only this one may: its heartbeat, its emergency message, one of its TPDOs, or
  // SYNC while it is the producer. It has the same id, or is a second master.
  virtual void on_impostor(std::uint16_t /*identifier*/) {}

 protected:
  ~NodeApplication() = default;
};

class Node;
class ObjectValue;

// One write of the sequence that makes a node that was just reset what it is now.
struct ParameterValue {
  ObjectAddress address;
  std::uint8_t size_bytes = 0;
  std::uint32_t value = 0;

  friend bool operator==(const ParameterValue&, const ParameterValue&) = default;
};

// Objects and parameters of services of CiA 301 and CiA 305 that not every node has. A node without them
// carries none of their code. Each call is from within one of the node's.
class NodeServices {
 public:
  // Their objects of the communication profile area. kObjectDoesNotExist for all others.
  virtual AbortCode read(ObjectAddress address, ObjectValue& value) const = 0;
  // Every write of an SDO client: theirs, or else Node::write_own. `size` in bytes; 0: as many as the object
  // has.
  virtual AbortCode write(Node& node, ObjectAddress address, std::uint32_t value, std::size_t size) = 0;
  // The node's communication parameters as writes, in the order in which they are to be made. Those that are
  // as after a reset and depend on the node id are left out. False past the last.
  virtual bool parameter(Node& node, std::size_t number, ParameterValue& parameter) const = 0;
  // One of them comes back from storage.
  virtual void restore(Node& node, const ParameterValue& parameter) = 0;

 protected:
  ~NodeServices() = default;
};

// What a node does to its own state when it loses a heartbeat or goes bus-off (CiA 301, object 0x1029:1).
enum class CommunicationError : std::uint8_t {
  kEnterPreOperational = 0,  // from operational only
  kNoChange = 1,
  kStop = 2,
};

// Objects from here on are the owner's; the stack itself serves those of CiA 301 before.
inline constexpr std::uint16_t kFirstOwnersIndex = 0x1F50;

// What all nodes of a kind share; stands in flash.
struct NodeDescription {
  std::uint32_t device_type = 0;  // 0x1000
  std::uint32_t vendor_id = 0;    // 0x1018
  std::uint32_t product_code = 0;
  std::uint32_t revision_number = 0;
  std::string_view device_name;       // 0x1008
  std::string_view hardware_version;  // 0x1009
  std::string_view software_version;  // 0x100A
  std::uint16_t heartbeat_ms = 0;     // 0x1017 after a reset
  bool sync_producer = false;         // 0x1005 bit 30 after a reset
  std::uint32_t sync_period_us = 0;   // 0x1006 after a reset; 0: no SYNC by itself
  // The owner's cycle is the beat: it calls Node::send_sync once in each `sync_period_us`. 0x1006 takes no
  // other period, and 0, which ends SYNC.
  bool sync_by_owner = false;
  CommunicationError communication_error = CommunicationError::kEnterPreOperational;  // 0x1029:1
  // 0x1010, 0x1011: bit g - 1 for each ParameterGroup g that NodeApplication::on_store and on_restore know.
  std::uint8_t stored_groups = 0;
  bool field_device = false;                // it has DeviceServices: LSS, 0x1012, 0x1020
  SdoChannel second_sdo{};                  // 0x1201
  std::span<const Entry> rows;              // objects from kFirstOwnersIndex on
  std::span<const PdoConfiguration> rpdos;  // PDOs beyond these are invalid after a reset
  std::span<const PdoConfiguration> tpdos;
  // Of so many TPDOs, the first ones, every change of a value is an event; of the others the owner tells
  // (Node::trigger_tpdo).
  std::uint8_t watched_tpdos = 255;
};

// What one node is.
struct NodeInstance {
  std::uint8_t node_id = 0;          // 1..127
  std::uint32_t serial_number = 0;   // 0x1018:4
  std::span<std::byte> values;       // of the description's rows; usually std::as_writable_bytes of a struct
  NodeServices* services = nullptr;  // none, or what must outlive the node
};

// The RAM of a node's services.
struct NodeBuffers {
  std::span<Rpdo> rpdos;
  std::span<SlotMap::Item> rpdo_slots;
  std::span<Tpdo> tpdos;
  std::span<HeartbeatConsumer> consumers;
  std::span<SlotMap::Item> consumer_slots;
  std::span<hal::CanFrame> backlog;
};

template <std::size_t kRpdos, std::size_t kTpdos, std::size_t kConsumers, std::size_t kBacklog>
struct NodeMemory {
  static_assert(kRpdos <= 255 && kTpdos <= 255 && kConsumers <= 127 && kBacklog >= 1);

  std::array<Rpdo, kRpdos> rpdos{};
  std::array<SlotMap::Item, kRpdos> rpdo_slots{};
  std::array<Tpdo, kTpdos> tpdos{};
  std::array<HeartbeatConsumer, kConsumers> consumers{};
  std::array<SlotMap::Item, kConsumers> consumer_slots{};
  std::array<hal::CanFrame, kBacklog> backlog{};

  NodeBuffers buffers() { return {rpdos, rpdo_slots, tpdos, consumers, consumer_slots, backlog}; }
};

// A CANopen node after CiA 301, of any role: NMT slave, heartbeat producer and consumer, SYNC producer and
// consumer, PDOs, two SDO servers, EMCY producer and consumer; no node guarding and no remote frames. It
// holds no time of its own and never waits; everything happens in its calls, in the caller's thread. Besides
// its owner's objects (NodeDescription::rows) it serves 0x1000, 0x1001, 0x1003, 0x1005 to 0x100A, 0x1010,
// 0x1011, 0x1014 to 0x1019, 0x1029, 0x1200, 0x1201 and the records of its PDOs, and what its NodeServices
// have.
class Node final : private ObjectServer {
 public:
  // All arguments must outlive the node. Silent until start().
  Node(const NodeDescription& description, const NodeInstance& instance, NodeBuffers buffers, FrameSink& sink,
       NodeApplication& application);

  // Power-on: reset, boot-up message, pre-operational; and operational if the owner wants that.
  void start(std::uint64_t now_us);
  // A frame from the bus; frames that are not for this node cost a few comparisons.
  void on_frame(const hal::CanFrame& frame, std::uint64_t now_us);
  // Whatever is due by now: backlog, heartbeats, event timers, time-outs. Its period bounds their jitter.
  void process(std::uint64_t now_us);

  // What the CAN controller says of itself, as often as the owner likes: EMCY 0x8110 while frames are lost,
  // 0x8120 while it is error passive, 0x8140 once it has come back from bus-off; bus-off itself is a
  // communication error (0x1029).
  void on_can_status(const hal::CanStatus& status, std::uint64_t now_us);

  // Obeys a command as if the NMT master had sent it.
  void command(NmtCommand command, std::uint64_t now_us);
  NmtState state() const { return state_; }
  // kUnconfiguredNodeId: the node stays in initialising, and is silent.
  std::uint8_t node_id() const { return node_id_; }
  // The node id from the next reset on; of the one that begins, from within on_state(kInitialising).
  void set_node_id(std::uint8_t node_id) { node_id_ = node_id; }
  const NodeDescription& description() const { return description_; }

  // Tells an event of TPDO `number` (from 0): it is sent as its transmission type and inhibit time say, or,
  // outside operational, not at all. Changes of values are events by themselves, see `watched_tpdos`.
  void trigger_tpdo(std::size_t number, std::uint64_t now_us) {
    if (permits_pdo(state_) && number < tpdos_.size()) tpdos_.request(number, now_us);
  }
  // Sends a SYNC, behind everything sent so far, and obeys it. Nothing happens in stopped, and unless 0x1005
  // and 0x1006 make the node a producer.
  void send_sync(std::uint64_t now_us);

  // Reports an error: EMCY message (not in stopped), register, history. Reported again, it does nothing until
  // it is cleared.
  void raise_error(std::uint16_t code, std::uint8_t register_bits,
                   const std::array<std::uint8_t, 5>& manufacturer = {});
  // Reports that the error is gone. Nothing happens if it was not there.
  void clear_error(std::uint16_t code);
  const ErrorLog& errors() const { return errors_; }

  // The whole dictionary as an SDO client sees it, with the same checks and errors. `size` in bytes.
  AbortCode read_object(ObjectAddress address, ObjectValue& value) override;
  AbortCode write_object(ObjectAddress address, std::uint32_t value, std::size_t size) override;
  AbortCode open_domain(ObjectAddress address, Access access, Domain*& domain) override;
  // A PDO's records at once, whatever its state.
  AbortCode configure_rpdo(std::size_t number, const PdoConfiguration& configuration);
  AbortCode configure_tpdo(std::size_t number, const PdoConfiguration& configuration);
  // Entry `number` (from 0) of object 0x1016: monitors a node; a time of 0 ends that.
  AbortCode configure_consumer(std::size_t number, std::uint8_t node_id, std::uint16_t time_ms);

  // The node's parameters as writes, in the order in which they are to be made: those of the owner's rows,
  // then the services' list of communication parameters. False past the last.
  bool parameter(std::size_t number, ParameterValue& parameter);
  // One of them comes back from storage, with the same checks as a client's; the owner is not asked. One that
  // the node does not have is left out.
  void restore(const ParameterValue& parameter);
  // write_object without the services.
  AbortCode write_own(ObjectAddress address, std::uint32_t value, std::size_t size);

  // Monitoring of a node begins anew with its next heartbeat.
  void await_heartbeat(std::uint8_t node_id) { heartbeats_.await(node_id); }

  const HeartbeatMonitor& heartbeats() const { return heartbeats_; }
  // Whoever sends besides this node's services, an SdoClient or an NMT master, does it here: the order of
  // frames is kept.
  FrameSink& sink() { return queue_; }
  // Says nothing more, whatever it is asked, until it is unmuted: what it sends is dropped.
  void mute(bool muted) { queue_.mute(muted); }
  // Frames that found no room in the sink and wait, and those that were lost for good.
  std::size_t backlog() const { return queue_.backlog(); }
  std::uint16_t lost_frames() const { return queue_.lost(); }

 private:
  void enter(NmtState state, std::uint64_t now_us);
  void reset(NmtCommand reset, std::uint64_t now_us);
  void load_defaults();
  // True when the frame was of a service other than SYNC and PDO.
  bool serve(const hal::CanFrame& frame, std::uint64_t now_us);
  bool take_pdo(const hal::CanFrame& frame, std::uint64_t now_us);
  void on_nmt(const hal::CanFrame& frame, std::uint64_t now_us);
  void on_sync(const hal::CanFrame& frame, std::uint64_t now_us);
  void on_heartbeat(const Heartbeat& heartbeat, std::uint64_t now_us);
  void on_rpdo(std::size_t number, const hal::CanFrame& frame, std::uint64_t now_us);
  void take_effect(std::size_t number, Rpdo& pdo, const std::array<std::uint8_t, 8>& data);
  void produce_heartbeat(std::uint64_t now_us);
  void beat(std::uint64_t now_us);

  // Errors that the stack itself sees. `detail` goes into the message's manufacturer field.
  void report(std::uint16_t code, bool present, std::uint8_t detail = 0);
  void note_reception(std::size_t number, Reception reception);
  void watch_own_beats(std::uint64_t now_us);
  void watch_heartbeats(std::uint64_t now_us);
  void on_rpdo_changed(std::size_t number);
  void watch_rpdos(std::uint64_t now_us);
  void on_communication_error(std::uint64_t now_us);
  void send_emergency(std::uint16_t code, const std::array<std::uint8_t, 5>& manufacturer);

  // The communication profile area (node_objects.cc).
  AbortCode read_communication(ObjectAddress address, ObjectValue& value) const;
  AbortCode read_record(ObjectAddress address, ObjectValue& value) const;
  AbortCode read_array(ObjectAddress address, ObjectValue& value) const;
  AbortCode read_variable(std::uint16_t index, ObjectValue& value) const;
  AbortCode read_identity(std::uint8_t subindex, ObjectValue& value) const;
  AbortCode read_sdo_server(std::size_t server, std::uint8_t subindex, ObjectValue& value) const;
  AbortCode write_communication(ObjectAddress address, std::uint32_t value, std::size_t size);
  AbortCode write_record(ObjectAddress address, std::uint32_t value);
  AbortCode write_mapping(PdoRecord& record, std::uint8_t subindex, std::uint32_t value) const;
  AbortCode write_parameter(ObjectAddress address, std::uint32_t value);
  AbortCode write_consumer(std::uint8_t subindex, std::uint32_t value);
  AbortCode write_second_sdo(std::uint8_t subindex, std::uint32_t value);
  AbortCode store_or_restore(ObjectAddress address, std::uint32_t signature);
  bool stores(std::uint8_t group) const { return (description_.stored_groups << 1 >> group & 1) != 0; }

  const NodeDescription& description_;
  std::uint8_t node_id_;
  NmtState state_ = NmtState::kInitialising;
  const std::uint32_t serial_number_;
  Dictionary dictionary_;
  NodeApplication& application_;
  NodeServices* const services_;
  TransmitQueue queue_;
  std::array<SdoServer, 2> servers_;  // of 0x1200 and 0x1201
  HeartbeatMonitor heartbeats_;
  RpdoSet rpdos_;
  bool rpdo_pending_ = false;  // data of one or more wait for the SYNC
  TpdoSet tpdos_;
  Sync sync_;
  ErrorLog errors_;
  EmergencyProducer emergencies_;
  hal::CanStatus can_status_;  // as told last
  CommunicationError communication_error_ = CommunicationError::kEnterPreOperational;
  std::uint8_t second_client_ = 0;  // 0x1201:3
  std::uint16_t heartbeat_ms_ = 0;
  std::uint64_t heartbeat_due_us_ = 0;
  std::uint64_t beat_us_ = 0;       // of the last heartbeat
  std::uint64_t beats_out_us_ = 0;  // when none of its own waited last
};

}  // namespace koboshi::canopen

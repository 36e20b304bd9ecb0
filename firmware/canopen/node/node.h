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

// The parameters that "save" to 0x1010 and "load" to 0x1011 cover, by sub-index (CiA 301, 7.5.2.13).
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

// The callbacks of a node to its owner, made from within the node's functions. The owner overrides those that
// it needs, and may call the node from within them.
class NodeApplication {
 public:
  // Reads a computed object of the owner's table (Entry::kComputed): a number of its type, or a text.
  virtual AbortCode on_read(ObjectAddress, ObjectValue&) { return AbortCode::kNoData; }
  // Asks whether an SDO client (or write_object) may change a value of the owner's table: kNone permits it.
  // `value` is sign-extended if the object is signed. Length, access and limits have been checked.
  virtual AbortCode on_write(ObjectAddress, std::uint32_t /*value*/) { return AbortCode::kNone; }
  // Returns the DOMAIN behind a row of the owner's table, which must outlive the node; null aborts the
  // transfer with 060A 0023. The node never has two transfers of one domain at a time.
  virtual Domain* domain(ObjectAddress) { return nullptr; }
  // Stores the parameters of a group so that they survive a restart; or restores those of the factory with
  // the next reset. Only groups of NodeDescription::stored_groups occur. While the owner returns kBusy it is
  // called again, and the client waits (CiA 301, 7.5.2.13).
  virtual AbortCode on_store(ParameterGroup) { return AbortCode::kCannotTransfer; }
  virtual AbortCode on_restore(ParameterGroup) { return AbortCode::kCannotTransfer; }
  // The configuration after a reset of PDO `number` (from 0), which is beyond those of the description; and
  // of entry `number` (from 0) of 0x1016.
  virtual PdoConfiguration default_pdo(PdoDirection, std::size_t /*number*/) { return {}; }
  virtual std::uint32_t default_consumer(std::size_t /*number*/) { return 0; }
  // A reset, kResetNode (also at start) or kResetCommunication: the communication parameters have their
  // defaults again, and the owner may change them with write_object. On kResetNode the owner also resets its
  // own values.
  virtual void on_reset(NmtCommand /*reset*/) {}
  // Whether the node enters operational by itself at the end of a reset, as an NMT master or a self-starting
  // device does (CiA 302-2, object 0x1F80).
  virtual bool starts_itself() { return false; }
  // The node has entered this state.
  virtual void on_state(NmtState) {}
  // A SYNC, in pre-operational or operational: after synchronous RPDOs have taken effect, before synchronous
  // TPDOs are packed.
  virtual void on_sync(std::uint64_t /*now_us*/) {}
  // RPDO `number` (from 0) has taken effect, but for values that its objects do not take: these are ignored,
  // with EMCY 0x6320 for each of them when it begins, and the object's index and sub-index and the PDO's
  // number (from 1) in its manufacturer field. Returns false if the owner does not take its values, which
  // then have no effect; the node reports all of its objects in this way.
  virtual bool on_rpdo(std::size_t /*number*/) { return true; }
  // RPDO `number` has been silent for longer than its event timer: once, until the timer starts again.
  // Returns whether that is an error, which the node then reports.
  virtual bool on_rpdo_timeout(std::size_t /*number*/) { return true; }
  virtual void on_heartbeat(const HeartbeatEvent&) {}
  // Another node's emergency message.
  virtual void on_emergency(const Emergency&) {}
  // Another node has sent a frame that only this node may send: its heartbeat, its emergency message, one of
  // its TPDOs, or SYNC while this node is the producer. The other has the same node id, or is a second
  // master.
  virtual void on_impostor(std::uint16_t /*identifier*/) {}

 protected:
  ~NodeApplication() = default;
};

class Node;
class ObjectValue;

// One write of the sequence that brings a node from its state after a reset to its present parameters.
struct ParameterValue {
  ObjectAddress address;
  std::uint8_t size_bytes = 0;
  std::uint32_t value = 0;

  friend bool operator==(const ParameterValue&, const ParameterValue&) = default;
};

// Optional services of a node, with their objects; the code of a node without them is not
// linked. The node calls these functions from within its own.
class NodeServices {
 public:
  // A reset has begun; called before the node's defaults are loaded.
  virtual void on_reset(Node& node, NmtCommand reset) = 0;
  // Reads one of the services' objects of the communication profile area; kObjectDoesNotExist for others.
  virtual AbortCode read(ObjectAddress address, ObjectValue& value) const = 0;
  // Receives every write of an SDO client: to one of the services' objects, else by Node::write_own. `size`
  // in bytes; 0: that of the object.
  virtual AbortCode write(Node& node, ObjectAddress address, std::uint32_t value, std::size_t size) = 0;

 protected:
  ~NodeServices() = default;
};

// How a node changes its own NMT state when it loses a heartbeat or goes bus-off (CiA 301, object 0x1029:1).
enum class CommunicationError : std::uint8_t {
  kEnterPreOperational = 0,  // from operational only
  kNoChange = 1,
  kStop = 2,
};

// The first index of the owner's objects; the stack itself serves the objects of CiA 301 before.
inline constexpr std::uint16_t kFirstOwnersIndex = 0x1F50;

// The constants of a kind of node, which are in flash.
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
  std::uint32_t sync_period_us = 0;   // 0x1006 after a reset; 0: the node sends no SYNC by itself
  // The owner calls Node::send_sync in each of its cycles of `sync_period_us`. 0x1006 then accepts only this
  // period, and 0, which ends SYNC.
  bool sync_by_owner = false;
  CommunicationError communication_error = CommunicationError::kEnterPreOperational;  // 0x1029:1
  // 0x1010, 0x1011: group_bit of each group that NodeApplication::on_store and on_restore can handle.
  std::uint8_t stored_groups = 0;
  bool field_device = false;                // has DeviceServices: LSS, 0x1012, 0x1020
  SdoChannel second_sdo{};                  // 0x1201
  std::span<const Entry> rows;              // objects from kFirstOwnersIndex on
  std::span<const PdoConfiguration> rpdos;  // PDOs beyond these are invalid after a reset
  std::span<const PdoConfiguration> tpdos;
  // How many TPDOs, from the first, have every change of a value as an event; events of the others are those
  // that the owner reports (Node::trigger_tpdo).
  std::uint8_t watched_tpdos = 255;
};

// The properties that distinguish one node of a kind from the others.
struct NodeInstance {
  std::uint8_t node_id = 0;          // 1..127
  std::uint32_t serial_number = 0;   // 0x1018:4
  std::span<std::byte> values;       // of the description's rows; usually std::as_writable_bytes of a struct
  NodeServices* services = nullptr;  // null: none; must outlive the node
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

// A CANopen node of any role (CiA 301): NMT slave, heartbeat producer and consumer, SYNC producer and
// consumer, PDOs, two SDO servers, EMCY producer and consumer; no node guarding and no remote frames. It has
// no clock and never waits: it acts only within its functions, in the caller's thread. Besides its owner's
// objects (NodeDescription::rows) it serves 0x1000, 0x1001, 0x1003, 0x1005 to 0x100A, 0x1010, 0x1011, 0x1014
// to 0x1019, 0x1029, 0x1200, 0x1201, the records of its PDOs, and the objects of its NodeServices.
class Node final : private ObjectServer {  // Large: one short function per service of CiA 301
 public:
  // `description`, `sink`, `application`, `instance.services` and all memory behind spans must outlive the
  // node; the structs `instance` and `buffers` are copied. Silent until start().
  Node(const NodeDescription& description, const NodeInstance& instance, NodeBuffers buffers, FrameSink& sink,
       NodeApplication& application);

  // Power-on: reset, boot-up message, pre-operational; then operational if the owner wants it.
  void start(std::uint64_t now_us);
  // Takes a frame from the bus; one that is not for this node costs a few comparisons.
  void on_frame(const hal::CanFrame& frame, std::uint64_t now_us);
  // Does all that is due: backlog, heartbeats, event timers, time-outs. The period of the calls is the jitter
  // of these.
  void process(std::uint64_t now_us);

  // Takes the state of the CAN controller, at any rate: raises EMCY 0x8110 while frames are lost, 0x8120
  // while it is error passive, 0x8140 when it has recovered from bus-off. Bus-off itself is a communication
  // error (0x1029).
  void on_can_status(const hal::CanStatus& status, std::uint64_t now_us) {
    if (can_status_changed_ || status != can_status_) take_can_status(status, now_us);
  }

  // Executes a command as if the NMT master had sent it.
  void command(NmtCommand command, std::uint64_t now_us);
  NmtState state() const { return state_; }
  // 0x1006, communication cycle period; 0: none.
  std::uint32_t sync_period_us() const { return sync_.period_us(); }
  // kUnconfiguredNodeId: the node stays in initialising, and is silent.
  std::uint8_t node_id() const { return node_id_; }
  // Sets the node id from the next reset on; from within on_state(kInitialising) or NodeServices::on_reset,
  // for the present reset.
  void set_node_id(std::uint8_t node_id) { node_id_ = node_id; }
  const NodeDescription& description() const { return description_; }

  // Reports an event of TPDO `number` (from 0), which is sent according to its transmission type and inhibit
  // time; outside operational, not at all. Changes of values are events by themselves, see `watched_tpdos`.
  void trigger_tpdo(std::size_t number, std::uint64_t now_us) {
    if (permits_pdo(state_) && number < tpdos_.size()) tpdos_.request(number, now_us);
  }
  // Sends a SYNC, behind everything sent so far, and acts on it as on one received. Does nothing in stopped,
  // or unless 0x1005 and 0x1006 make the node a producer.
  void send_sync(std::uint64_t now_us);

  // Raises an error: EMCY message (not in stopped), error register, history. Does nothing while the error is
  // raised already.
  void raise_error(std::uint16_t code, std::uint8_t register_bits,
                   const std::array<std::uint8_t, 5>& manufacturer = {});
  // Clears an error. Does nothing if it was not raised.
  void clear_error(std::uint16_t code) {
    if (errors_.clear(code)) send_emergency(error_code::kNoError, {});
  }
  const ErrorLog& errors() const { return errors_; }

  // Calls visit(identifier) for each frame that the node acts on, for the acceptance filter of its CAN
  // controller. Behind such a filter the application hears neither of another node's emergency message
  // (on_emergency) nor of a frame that only this node may send (on_impostor).
  template <typename Visit>
  void for_each_identifier(Visit visit) const {
    visit(kNmtCobId);
    visit(sync_.identifier());
    for (const SdoServer& server : servers_) {
      if (server.request_identifier() <= kCobIdMask) visit(server.request_identifier());
    }
    for (std::size_t i = 0; i < rpdos_.size(); ++i) {
      if (rpdos_[i].record.valid()) visit(rpdos_[i].record.identifier());
    }
    heartbeats_.for_each_node(
        [&](std::uint8_t node_id) { visit(static_cast<std::uint16_t>(kHeartbeatBase + node_id)); });
  }
  // Another value after each reset and each change of the communication profile area: the identifiers may be
  // others then.
  std::uint32_t configuration() const { return configuration_; }

  // Whether RPDO `number` (from 0) writes this object.
  bool receives(std::size_t number, ObjectAddress address) const {
    return number < rpdos_.size() && rpdos_[number].record.maps(address);
  }

  // Access the whole dictionary as an SDO client does, with the same checks and errors. `size` in bytes.
  AbortCode read_object(ObjectAddress address, ObjectValue& value) override;
  AbortCode write_object(ObjectAddress address, std::uint32_t value, std::size_t size) override;
  AbortCode open_domain(ObjectAddress address, Access access, Domain*& domain) override;
  // Set all records of PDO `number` (from 0), whether it is valid or not. kObjectDoesNotExist if there is no
  // such PDO; else as PdoRecord::configure: an error leaves the PDO invalid.
  AbortCode configure_rpdo(std::size_t number, const PdoConfiguration& configuration);
  AbortCode configure_tpdo(std::size_t number, const PdoConfiguration& configuration);
  // Sets entry `number` (from 0) of object 0x1016: monitors the node, and counts it as lost after `time_ms`
  // without a heartbeat; 0 ends the monitoring. Errors as of HeartbeatMonitor::write.
  AbortCode configure_consumer(std::size_t number, std::uint8_t node_id, std::uint16_t time_ms);

  // The next write from `place` on, which is 0 at first and is moved on behind it, of the node's parameters
  // in the order in which they are to be written: those of the owner's rows, then the communication
  // parameters. Leaves out those that depend on the node id or on the owner and are as after a reset. False
  // past the last.
  bool next_parameter(std::size_t& place, ParameterValue& parameter);
  // Restores one of them from storage, with the checks of a client's write; on_write is not called. Ignores
  // one that the node does not have.
  void restore(const ParameterValue& parameter);
  // Writes an object as write_object does, without the services.
  AbortCode write_own(ObjectAddress address, std::uint32_t value, std::size_t size);

  // Starts the event timer of RPDO `number` (from 0) again, as a reception does: its values have arrived by
  // another service.
  void restart_rpdo_timer(std::size_t number, std::uint64_t now_us);

  // Suspends the monitoring of a node until its next heartbeat.
  void await_heartbeat(std::uint8_t node_id) { heartbeats_.await(node_id); }

  const HeartbeatMonitor& heartbeats() const { return heartbeats_; }
  // The queue through which an SdoClient or an NMT master beside this node sends, so that the order of frames
  // is kept.
  FrameSink& sink() { return queue_; }
  // While muted, drops every frame that is sent.
  void mute(bool muted) { queue_.mute(muted); }
  // Frames that wait for room in the sink, and those that were lost; the latter saturates.
  std::size_t backlog() const { return queue_.backlog(); }
  std::uint16_t lost_frames() const { return queue_.lost(); }

 private:
  void enter(NmtState state, std::uint64_t now_us);
  void reset(NmtCommand reset, std::uint64_t now_us);
  void load_defaults();
  // True when the frame belongs to a service other than SYNC and PDO.
  bool serve(const hal::CanFrame& frame, std::uint64_t now_us);
  bool take_pdo(const hal::CanFrame& frame, std::uint64_t now_us);
  void on_nmt(const hal::CanFrame& frame, std::uint64_t now_us);
  void on_sync(const hal::CanFrame& frame, std::uint64_t now_us);
  void on_heartbeat(const Heartbeat& heartbeat, std::uint64_t now_us);
  void on_rpdo(std::size_t number, const hal::CanFrame& frame, std::uint64_t now_us);
  void take_effect(std::size_t number, Rpdo& pdo, const std::array<std::uint8_t, 8>& data);
  void produce_heartbeat(std::uint64_t now_us);
  void beat(std::uint64_t now_us);

  // Errors that the stack itself detects. `detail` goes into the message's manufacturer field.
  void report(std::uint16_t code, bool present, std::uint8_t detail = 0);
  void note_reception(std::size_t number, Reception reception);
  void note_refusal(std::size_t number, std::uint8_t refused);
  void watch_own_beats(std::uint64_t now_us);
  void take_can_status(const hal::CanStatus& status, std::uint64_t now_us);
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
  // The sequence of next_parameter (node_parameters.cc).
  bool row_parameter(const Entry& row, std::size_t step, ParameterValue& parameter) const;
  std::size_t communication_parts() const;
  bool communication_parameter(std::size_t part, std::size_t& step, ParameterValue& parameter);
  bool identifier_parameter(std::size_t& step, ParameterValue& parameter);
  bool consumer_parameter(std::size_t& step, ParameterValue& parameter);
  bool pdo_parameter(std::size_t pdo, bool again, std::size_t& step, ParameterValue& parameter);
  PdoConfiguration default_pdo(PdoDirection direction, std::size_t number) const;
  SdoChannel second_sdo() const;
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
  bool rpdo_pending_ = false;  // data of one or more RPDOs wait for the SYNC
  TpdoSet tpdos_;
  Sync sync_;
  ErrorLog errors_;
  EmergencyProducer emergencies_;
  hal::CanStatus can_status_;        // of the last on_can_status
  bool can_status_changed_ = false;  // in it
  std::uint32_t configuration_ = 0;
  CommunicationError communication_error_ = CommunicationError::kEnterPreOperational;
  std::uint8_t second_client_ = 0;  // 0x1201:3
  std::uint16_t heartbeat_ms_ = 0;
  std::uint64_t heartbeat_due_us_ = 0;
  std::uint64_t beat_us_ = 0;       // of the last heartbeat
  std::uint64_t beats_out_us_ = 0;  // when none of its own was last seen waiting
};

}  // namespace koboshi::canopen

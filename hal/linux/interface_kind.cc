#include "hal/linux/interface_kind.h"

#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "hal/linux/file_descriptor.h"

namespace koboshi::hal {
namespace {

struct LinkRequest {
  nlmsghdr header;
  ifinfomsg link;
};

// Returns the first attribute of this type in the `bytes` bytes from `first` on, or null if there is none.
const rtattr* find(const rtattr* first, std::size_t bytes, unsigned short type) {
  const auto* at = reinterpret_cast<const char*>(first);
  while (bytes >= sizeof(rtattr)) {
    const auto* attribute = reinterpret_cast<const rtattr*>(at);
    if (attribute->rta_len < sizeof(rtattr) || attribute->rta_len > bytes) return nullptr;
    if ((attribute->rta_type & NLA_TYPE_MASK) == type) return attribute;
    const std::size_t length = std::min<std::size_t>(RTA_ALIGN(attribute->rta_len), bytes);
    at += length;
    bytes -= length;
  }
  return nullptr;
}

std::string kind_of(const nlmsghdr* answer) {
  const auto* link = static_cast<const ifinfomsg*>(NLMSG_DATA(answer));
  const auto* info = find(IFLA_RTA(link), IFLA_PAYLOAD(answer), IFLA_LINKINFO);
  if (info == nullptr) return {};
  const auto* kind = find(static_cast<const rtattr*>(RTA_DATA(info)), RTA_PAYLOAD(info), IFLA_INFO_KIND);
  if (kind == nullptr) return {};
  const auto* text = static_cast<const char*>(RTA_DATA(kind));
  return {text, strnlen(text, RTA_PAYLOAD(kind))};
}

}  // namespace

int interface_index(const std::string& interface) {
  const unsigned index = if_nametoindex(interface.c_str());
  if (index == 0) throw std::system_error(errno, std::generic_category(), "the CAN interface " + interface);
  return static_cast<int>(index);
}

std::string interface_kind(const std::string& interface) {
  const int index = interface_index(interface);
  const FileDescriptor socket(
      checked(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE), "rtnetlink"));
  LinkRequest request{};
  request.header.nlmsg_len = NLMSG_LENGTH(sizeof request.link);
  request.header.nlmsg_type = RTM_GETLINK;
  request.header.nlmsg_flags = NLM_F_REQUEST;
  request.link.ifi_family = AF_UNSPEC;
  request.link.ifi_index = index;
  checked(static_cast<int>(::send(socket.number(), &request, request.header.nlmsg_len, 0)), "rtnetlink");
  alignas(nlmsghdr) std::array<char, 16384> answer{};
  const auto length =
      checked(static_cast<int>(::recv(socket.number(), answer.data(), answer.size(), 0)), "rtnetlink");
  const auto* header = reinterpret_cast<const nlmsghdr*>(answer.data());
  if (!NLMSG_OK(header, static_cast<unsigned>(length)) || header->nlmsg_type != RTM_NEWLINK)
    throw std::system_error(EPROTO, std::generic_category(), "what made the interface " + interface);
  return kind_of(header);
}

bool is_virtual_can(const std::string& interface) {
  const std::string kind = interface_kind(interface);
  return kind == "vcan" || kind == "vxcan";
}

}  // namespace koboshi::hal

#pragma once

#include <string_view>

#include "engine/device/drivers/byte_link.hpp"

namespace palpate::engine {

/// Where a device's program listens.
struct UdpAddress {
    std::string host;  ///< a name, or an address; IPv6 without its brackets
    std::string port;  ///< 1 to 65535
};

/// With this a port's name is that of a UDP port.
inline constexpr std::string_view kUdp = "udp:";

/// @param text  "udp:HOST:PORT", as in udp:127.0.0.1:5000 or udp:[::1]:5000
/// @throws std::invalid_argument with the text and how it should look
[[nodiscard]] UdpAddress udp_address(std::string_view text);

/// A UDP port of another program, on this machine or on a wire of its own. A packet is a datagram:
/// it comes whole or not at all, twice, or late. Nothing tells a lost one from one that is still on
/// its way, so that a datagram that the system had no room for counts as sent. The link is lost
/// when the system says that nobody listens there, or that there is no way.
///
/// Only what comes from that address is heard. Who can read the wire can write to it: a wire of its
/// own.
class UdpLink : public DescriptorLink {
public:
    /// Does not open it yet: reopen() does.
    explicit UdpLink(UdpAddress address) : address_(std::move(address)) {}

    [[nodiscard]] bool send(std::span<const std::uint8_t> packet) noexcept override;
    [[nodiscard]] bool reopen() override;
    [[nodiscard]] std::string name() const override;
    [[nodiscard]] bool keeps_packets() const noexcept override { return true; }

private:
    [[nodiscard]] bool is_gone(std::ptrdiff_t got, int error) const noexcept override;

    UdpAddress address_;
};

}  // namespace palpate::engine

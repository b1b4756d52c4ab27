#pragma once

#include "engine/device/drivers/byte_link.hpp"

namespace palpate::engine {

/// A serial port of this machine: raw, 8N1, non-blocking, ours alone (TIOCEXCL, a lock on the file
/// so that another palpate sees it as well, and nobody who had it open before: see port_holder()).
/// The baud rate means nothing to a board on USB of its own. A USB chip that gathers bytes before
/// it passes them on is asked not to.
///
/// A packet is one write(2). Less than the whole packet written means that the board would misread
/// what follows: the link counts as lost.
class SerialLink : public DescriptorLink {
public:
    /// Does not open it yet: reopen() does.
    /// @param megabaud  1,000,000 baud, for an open board
    explicit SerialLink(std::string path, bool megabaud = false)
        : path_(std::move(path)), megabaud_(megabaud) {}
    ~SerialLink() override { SerialLink::close(); }

    [[nodiscard]] bool send(std::span<const std::uint8_t> packet) noexcept override;
    [[nodiscard]] bool reopen() override;
    void close() noexcept override;
    [[nodiscard]] std::string name() const override { return path_; }

private:
    [[nodiscard]] int configure() const noexcept;

    [[nodiscard]] bool is_gone(std::ptrdiff_t got, int error) const noexcept override;

    std::string path_;
    bool megabaud_;
};

/// Why a port could not be opened, as a sentence with the remedy.
/// @param error  errno of the call that failed; EWOULDBLOCK: another program holds it
[[nodiscard]] std::string port_trouble(const std::string& path, int error);

}  // namespace palpate::engine

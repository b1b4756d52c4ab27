#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "engine/base/descriptor.hpp"

namespace palpate::engine {

/// The seam between a driver and the bytes' way to its board: a serial port, or a board in memory
/// on a clock of its own. What is used in the tick is noexcept and allocates nothing.
class ByteLink {
public:
    ByteLink() = default;
    ByteLink(const ByteLink&) = delete;
    ByteLink& operator=(const ByteLink&) = delete;
    virtual ~ByteLink() = default;

    /// Sends a packet in one piece. @return false if it did not go out whole: the link is lost
    [[nodiscard]] virtual bool send(std::span<const std::uint8_t> packet) noexcept = 0;

    /// Waits at most `wait_ns` for the first byte and takes what is there.
    /// @return bytes put into `into`, 0 for none in time, negative: the link is lost
    [[nodiscard]] virtual std::ptrdiff_t receive(std::span<std::uint8_t> into,
                                                 std::int64_t wait_ns) noexcept = 0;

    /// Throws away what has come and was not read.
    virtual void drain() noexcept = 0;
    /// Lets time pass.
    virtual void pause(std::int64_t ns) noexcept = 0;
    /// The link's clock, ns; never goes back.
    [[nodiscard]] virtual std::int64_t now_ns() const noexcept = 0;

    /// Closes the link and opens it anew. @return false while that cannot be done, see trouble()
    [[nodiscard]] virtual bool reopen() = 0;
    virtual void close() noexcept = 0;
    /// What keeps the link from opening, as a sentence with the remedy; empty when it is open.
    [[nodiscard]] virtual std::string trouble() const = 0;
    /// For people: "/dev/ttyACM0".
    [[nodiscard]] virtual std::string name() const = 0;
    /// What is sent in one piece comes in one piece or not at all: nothing has to say where it
    /// ends.
    [[nodiscard]] virtual bool keeps_packets() const noexcept { return false; }
    /// The open port for whoever guards it; -1 if there is none.
    [[nodiscard]] virtual int descriptor() const noexcept { return -1; }
};

/// A link that is a file descriptor of this machine, non-blocking, on the wall's clock.
class DescriptorLink : public ByteLink {
public:
    [[nodiscard]] std::ptrdiff_t receive(std::span<std::uint8_t> into,
                                         std::int64_t wait_ns) noexcept override;
    void drain() noexcept override;
    void pause(std::int64_t ns) noexcept override;
    [[nodiscard]] std::int64_t now_ns() const noexcept override;
    [[nodiscard]] std::string trouble() const override { return trouble_; }
    [[nodiscard]] int descriptor() const noexcept override { return port_.get(); }
    void close() noexcept override { port_ = Descriptor(); }

protected:
    /// read(2) gave nothing: is that for good?
    /// @param got  what it returned, 0 or less   @param error  errno then
    [[nodiscard]] virtual bool is_gone(std::ptrdiff_t got, int error) const noexcept = 0;

    std::string trouble_;
    Descriptor port_{};
};

}  // namespace palpate::engine
